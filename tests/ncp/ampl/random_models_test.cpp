// SPDX-License-Identifier: Apache-2.0
// Random models with defined variables of every kind, read as text and as binary: F against an evaluation of the same
// trees here, J against differences of F. Would catch a file that the checker lets through but AMPL's library
// differentiates wrongly (see NlModel::segments), and mistakes in the layout of J.
#include <algorithm>
#include <cmath>
#include <random>

#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

struct Tree {
  char kind = 'n';  // n number, v variable, o operator
  int code = 0;     // its index or opcode
  double value = 0;
  std::vector<Tree> operands{};

  void write(std::string& s) const {
    if (kind == 'n') {
      s.append("n").append(std::to_string(value)).append("\n");
      return;
    }
    s.append(1, kind).append(std::to_string(code)).append("\n");
    if (kind == 'o' && (code == 54 || code == 11 || code == 12)) s.append(std::to_string(operands.size())).append("\n");
    for (const Tree& t : operands) t.write(s);
  }

  // x holds the variables and then the defined ones.
  double at(const std::vector<double>& x) const {
    if (kind == 'n') return std::stod(std::to_string(value));
    if (kind == 'v') return x[static_cast<std::size_t>(code)];
    std::vector<double> a;
    for (const Tree& t : operands) a.push_back(t.at(x));
    switch (code) {
      case 0:
        return a[0] + a[1];
      case 1:
        return a[0] - a[1];
      case 2:
        return a[0] * a[1];
      case 5:
        return std::pow(a[0], a[1]);
      case 11:
        return *std::min_element(a.begin(), a.end());
      case 12:
        return *std::max_element(a.begin(), a.end());
      case 16:
        return -a[0];
      case 22:
        return a[0] < a[1] ? 1 : 0;
      case 35:
        return a[0] != 0 ? a[1] : a[2];
      case 37:
        return std::tanh(a[0]);
      case 41:
        return std::sin(a[0]);
      case 46:
        return std::cos(a[0]);
      case 49:
        return std::atan(a[0]);
      case 54: {
        double sum = 0;
        for (double v : a) sum += v;
        return sum;
      }
      default:
        return NAN;
    }
  }
};

struct Definition {
  std::vector<double> linear;  // coefficients of the variables, 0 for none
  Tree tree;
  int owner = 0;  // row + 1, or 0 if shared
};

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  void make() {
    n_ = 1 + below(4);
    const int shared = below(5);
    both_ = below(shared + 1);
    std::vector<int> visible;  // defined variables
    for (int k = 0; k < shared; ++k) {
      // Those for objectives too may use only each other.
      define(visible, 0);
      visible.push_back(n_ + k);
    }
    for (int row = 0; row < n_; ++row) {
      std::vector<int> mine = visible;
      for (int k = below(3); k > 0; --k) {
        define(mine, row + 1);
        mine.push_back(n_ + static_cast<int>(definitions_.size()) - 1);
      }
      rows_.push_back(tree(mine, below(5)));
      coefficients_.emplace_back();
      for (int j = 0; j < n_; ++j) coefficients_.back().push_back(below(3) == 0 ? uniform() : 0.0);
    }
    objective_ = both_ > 0 ? tree({visible.begin(), visible.begin() + both_}, 3) : tree({}, 3);
  }

  std::string write() const {
    const int shared = count(0);
    Header h{.vars = n_, .cons = n_, .objs = 1, .cc = n_, .nonzeros = n_ * n_};
    h.both = both_, h.con = shared - both_;
    h.con1 = static_cast<int>(definitions_.size()) - shared;
    std::string s = text(h);
    definitions_of(0, s);
    for (int i = 0; i < n_; ++i) {
      definitions_of(i + 1, s);
      s.append("C").append(std::to_string(i)).append("\n");
      rows_[static_cast<std::size_t>(i)].write(s);
    }
    s += "O0 0\n";
    objective_.write(s);
    s += "r\n";
    for (int i = 1; i <= n_; ++i) s.append("5 0 ").append(std::to_string(i)).append("\n");
    s += "b\n";
    for (int i = 0; i < n_; ++i) s += "3\n";
    s.append("k").append(std::to_string(n_ - 1)).append("\n");
    for (int i = 1; i < n_; ++i) s.append(std::to_string(n_ * i)).append("\n");
    for (int i = 0; i < n_; ++i) {
      s.append("J").append(std::to_string(i)).append(" ").append(std::to_string(n_)).append("\n");
      for (int j = 0; j < n_; ++j) term(s, j, coefficients_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
    }
    return s;
  }

  Vec F(const Vec& x) const {
    std::vector<double> all(x.begin(), x.end());
    all.resize(static_cast<std::size_t>(n_) + definitions_.size());
    for (std::size_t d = 0; d < definitions_.size(); ++d) {
      double value = definitions_[d].tree.at(all);
      for (Index j = 0; j < n_; ++j) value += rounded(definitions_[d].linear[static_cast<std::size_t>(j)]) * x[j];
      all[static_cast<std::size_t>(n_) + d] = value;
    }
    Vec result(n_);
    for (Index i = 0; i < n_; ++i) {
      result[i] = rows_[static_cast<std::size_t>(i)].at(all);
      for (Index j = 0; j < n_; ++j)
        result[i] += rounded(coefficients_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]) * x[j];
    }
    return result;
  }

  Vec point() {
    Vec x(n_);
    for (double& v : x) v = uniform();
    return x;
  }

 private:
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  double uniform() { return std::uniform_real_distribution<double>(-1.5, 1.5)(random_); }
  static double rounded(double v) { return std::stod(std::to_string(v)); }
  static void term(std::string& s, int j, double c) {
    s.append(std::to_string(j)).append(" ").append(std::to_string(c)).append("\n");
  }
  int count(int owner) const {
    int n = 0;
    for (const Definition& d : definitions_) n += d.owner == owner ? 1 : 0;
    return n;
  }
  void definitions_of(int owner, std::string& s) const {
    for (std::size_t d = 0; d < definitions_.size(); ++d) {
      if (definitions_[d].owner != owner) continue;
      int terms = 0;
      for (double c : definitions_[d].linear) terms += c != 0 ? 1 : 0;
      s.append("V").append(std::to_string(n_ + static_cast<int>(d))).append(" ").append(std::to_string(terms));
      s.append(" ").append(std::to_string(owner)).append("\n");
      for (int j = 0; j < n_; ++j)
        if (const double c = definitions_[d].linear[static_cast<std::size_t>(j)]; c != 0) term(s, j, c);
      definitions_[d].tree.write(s);
    }
  }
  void define(const std::vector<int>& visible, int owner) {
    Definition d;
    d.owner = owner;
    for (int j = 0; j < n_; ++j) d.linear.push_back(below(4) == 0 ? uniform() : 0.0);
    d.tree = tree(visible, below(5));
    definitions_.push_back(d);
  }
  Tree tree(const std::vector<int>& visible, int depth) {
    if (depth == 0) {
      const int total = n_ + 2 * static_cast<int>(visible.size());
      const int k = below(total + 1);
      if (k == total) return {'n', 0, uniform()};
      return {'v', k < n_ ? k : visible[static_cast<std::size_t>(k - n_) / 2]};
    }
    const auto sub = [&] { return tree(visible, below(depth)); };
    static const int operators[] = {0, 0, 1, 2, 2, 2, 5, 11, 12, 16, 35, 37, 41, 46, 49, 54};
    const int op = operators[below(16)];
    switch (op) {
      case 5:
        return {'o', 5, 0, {sub(), {'n', 0, static_cast<double>(2 + below(2))}}};
      case 16:
      case 37:
      case 41:
      case 46:
      case 49:
        return {'o', op, 0, {sub()}};
      case 35:
        return {'o', 35, 0, {{'o', 22, 0, {sub(), sub()}}, sub(), sub()}};
      case 11:
      case 12:
      case 54:
        return {'o', op, 0, {sub(), sub(), sub()}};
      default:
        return {'o', op, 0, {sub(), sub()}};
    }
  }

  std::mt19937 random_;
  int n_ = 1;
  int both_ = 0;
  std::vector<Definition> definitions_;
  std::vector<Tree> rows_;
  std::vector<std::vector<double>> coefficients_;
  Tree objective_;
};

TEST(RandomModels, ValuesAndDerivatives) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) {
    Generator g(seed);
    g.make();
    const std::string content = g.write();
    const auto m = read_text(content);
    const auto twin = read_text(binary_twin(content));
    for (int k = 0; k < 3; ++k) {
      const Vec x = g.point();
      const Vec expected = g.F(x);
      if (expected.lpNorm<Eigen::Infinity>() > 1e3) continue;  // no differences of it
      const Vec F = values(*m, x);
      ASSERT_LE((F - expected).lpNorm<Eigen::Infinity>(), 1e-12 * (1 + expected.lpNorm<Eigen::Infinity>())) << content;
      ASSERT_EQ(describe(*m, check_jacobian(*m, x), 1e-4), "") << "seed " << seed << "\n" << content;
      ASSERT_EQ(values(*twin, x), F);
      ASSERT_EQ(jacobian(*twin, x), jacobian(*m, x));
      ++compared;
    }
  }
  EXPECT_GT(compared, 1600);
}

}  // namespace
}  // namespace perp::ncp::ampl
