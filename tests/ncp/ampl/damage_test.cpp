// SPDX-License-Identifier: Apache-2.0
// Damaged files: cut at every byte, and with bytes, lines and numbers changed at random. Each is refused with a
// ModelError or loads and evaluates; nothing crashes or ends the process (run it under the sanitizers).
#include <array>
#include <random>

#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  for (const std::string& s : rich_models()) {
    all.push_back(s);
    all.push_back(binary_twin(s));
  }
  for (const std::string& path : samples()) all.push_back(read_bytes(path));
  return all;
}

struct Outcome {
  int loaded = 0, refused = 0;
};

class Damage : public testing::Test {
 protected:
  void attempt(const std::string& content, Outcome& outcome) {
    const std::string path = folder_.write("m.nl", content);
    try {
      const auto m = read_model(path);
      ++outcome.loaded;
      Vec F(m->size());
      SpMat J = m->jacobian_pattern();
      for (const Vec& x : std::array<Vec, 3>{m->start(), m->start().array() + 0.37, Vec::Constant(m->size(), -1e3)}) {
        m->eval(x, F);
        m->jacobian(x, J);
      }
      m->variable_name(m->size() - 1);
      m->equation_name(m->size() - 1);
    } catch (const ModelError& e) {
      ++outcome.refused;
      ASSERT_NE(std::string(e.what()), "");
    }
  }
  TempFolder folder_;
};

TEST_F(Damage, CutAtEveryByte) {
  Outcome outcome;
  for (const std::string& seed : seeds()) {
    if (seed.size() > 1500) continue;
    for (std::size_t n = 0; n < seed.size(); ++n) attempt(seed.substr(0, n), outcome);
  }
  EXPECT_EQ(outcome.loaded, 0);  // every seed ends with a segment that is needed
  EXPECT_GT(outcome.refused, 2000);
}

// One to four changes of a kind that damage and bad writers make.
std::string damaged(std::string s, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  static const std::array<const char*, 14> numbers = {
      "0", "1", "-1", "2", "3", "5", "9", "54", "-0", "1e9", "2147483647", "-2147483648", "4294967296", "1e308"};
  for (std::size_t change = 1 + below(4); change > 0 && s.size() > 1; --change) {
    const std::size_t at = below(s.size());
    switch (below(7)) {
      case 0:
        s[at] = static_cast<char>(below(256));
        break;
      case 1:
        s[at] = static_cast<char>(s[at] ^ (1 << below(8)));
        break;
      case 2:
        s.erase(at, 1 + below(8));
        break;
      case 3:
        s.insert(at, s.substr(below(s.size()), 1 + below(24)));
        break;
      case 4: {  // a number
        const std::size_t begin = s.find_first_of("0123456789", at);
        if (begin == std::string::npos) break;
        const std::size_t end = s.find_first_not_of("0123456789", begin);
        s.replace(begin, end == std::string::npos ? 1 : end - begin, numbers[below(numbers.size())]);
        break;
      }
      case 5: {  // a line
        const std::size_t begin = s.find('\n', at), end = begin == std::string::npos ? begin : s.find('\n', begin + 1);
        if (end == std::string::npos) break;
        const std::string line = s.substr(begin, end - begin);
        if (below(2) == 0) s.erase(begin, line.size());
        s.insert(std::min(s.size(), s.find('\n', below(s.size()))), line);
        break;
      }
      default:  // four bytes, as an integer of a binary file
        for (std::size_t i = at; i < std::min(at + 4, s.size()); ++i)
          s[i] = static_cast<char>(below(4) == 0 ? 0xff : 0);
    }
  }
  return s;
}

TEST_F(Damage, ChangedAtRandom) {
  std::mt19937 random(20240611);
  Outcome outcome;
  const std::vector<std::string> all = seeds();
  for (int k = 0; k < 6000; ++k) attempt(damaged(all[static_cast<std::size_t>(k) % all.size()], random), outcome);
  EXPECT_GT(outcome.loaded, 100);
  EXPECT_GT(outcome.refused, 1000);
}

}  // namespace
}  // namespace perp::ncp::ampl
