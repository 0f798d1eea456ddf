// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/certificate.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ncp/problem/linear_part.hpp"

namespace perp::ncp {
namespace {

/// The shortest decimal number that is read back as the same double, d.ddde+xx.
std::string decimal(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific);
  return {buffer.data(), end.ptr};
}

/// CRC-32 (ISO 3309, as in zlib) of all numbers, as decimal() writes them, and of all names, in the order of the text.
class Checksum {
 public:
  void add(double value) { add(std::isinf(value) ? std::string("null") : decimal(value)); }
  void add(std::string_view name) {
    for (const char c : name) byte(static_cast<unsigned char>(c));
  }
  std::uint32_t value() const { return ~crc_; }

 private:
  void byte(unsigned char b) {
    crc_ ^= b;
    for (int k = 0; k < 8; ++k) crc_ = (crc_ >> 1U) ^ (0xEDB88320U & (0U - (crc_ & 1U)));
  }
  std::uint32_t crc_ = 0xFFFFFFFFU;
};

/// Writes JSON and sums up what it writes.
class Writer {
 public:
  std::string text{};

  void literal(std::string_view part) { text += part; }
  /// null: infinite.
  void number(double value) {
    value = std::isfinite(value) ? value + 0.0 : infinity;  // no -0
    sum_.add(value);
    if (value == infinity) return literal("null");
    literal(decimal(value));
  }
  void number(Index value) { number(static_cast<double>(value)); }
  void name(std::string_view value) {
    sum_.add(value);
    text += '"';
    for (const char c : value) {
      const auto code = static_cast<unsigned char>(c);
      if (c == '"' || c == '\\') text += '\\';
      if (code >= 0x20) {
        text += c;
      } else {
        constexpr std::string_view digits = "0123456789abcdef";
        text += "\\u00";
        text += digits[code >> 4U];
        text += digits[code & 15U];
      }
    }
    text += '"';
  }
  void truth(bool value) {
    sum_.add(value ? 1.0 : 0.0);
    literal(value ? "true" : "false");
  }
  template <class Items, class Write>
  void list(const Items& items, Write write) {
    literal("[");
    for (std::size_t k = 0; k < items.size(); ++k) {
      if (k > 0) literal(",");
      write(items[k]);
    }
    literal("]");
    sum_.add(static_cast<double>(items.size()));
  }
  std::uint32_t checksum() const { return sum_.value(); }

 private:
  Checksum sum_{};
};

void write(Writer& w, const lcp::Refutation::Proof& proof) {
  w.literal("{\"assumptions\":");
  w.list(proof.assumptions, [&](const lcp::Refutation::Assumption& a) {
    w.literal("{\"variable\":");
    w.number(a.variable);
    w.literal(",\"above\":");
    w.truth(a.above);
    w.literal(",\"value\":");
    w.number(std::isnan(a.value) ? infinity : a.value);
    w.literal(",\"refuted\":");
    write(w, a.refuted);
    w.literal("}");
  });
  w.literal(",\"multipliers\":");
  w.list(proof.y, [&](const lcp::Multiplier& m) {
    w.literal("[");
    w.number(m.row);
    w.literal(",");
    w.number(m.high);
    w.literal(",");
    w.number(m.low);
    w.literal("]");
  });
  w.literal("}");
}

void add_variables(const lcp::Refutation::Proof& proof, std::vector<Index>& variables) {
  for (const auto& a : proof.assumptions) {
    variables.push_back(a.variable);
    add_variables(a.refuted, variables);
  }
}

}  // namespace

std::string certificate_json(const Mcp& mcp, In x, const Infeasibility& proof) {
  if (!proof.certificate) return "null";
  const std::optional<LinearPart> part = proof.sums ? LinearPart{*proof.sums} : linear_part(mcp, x);
  if (!part) return "null";
  const lcp::AffineMcp& problem = part->problem;
  const lcp::Refutation& refutation = *proof.certificate;
  const std::vector<Index> rows = rows_of(refutation);
  const SpMat by_row = problem.M.transpose();
  std::vector<Index> variables = rows;
  add_variables(refutation.proof, variables);
  for (const Index i : rows)
    for (SpMat::InnerIterator it(by_row, i); it; ++it) variables.push_back(it.row());
  std::ranges::sort(variables);
  const auto rest = std::ranges::unique(variables);
  variables.erase(rest.begin(), rest.end());

  Writer w;
  w.literal("{\"format\":\"perp certificate 1\",\"tolerance\":");
  w.number(refutation.tolerance);
  w.literal(",\"radius\":");
  w.number(refutation.radius);
  if (proof.sums) w.literal(",\"terms_from\":" + std::to_string(mcp.size()));
  w.literal(",\"variables\":");
  w.list(variables, [&](Index j) {
    w.literal("{\"index\":");
    w.number(j);
    w.literal(",\"name\":");
    w.name(j < mcp.size() ? mcp.variable_name(j) : "term " + std::to_string(j - mcp.size() + 1));
    w.literal(",\"lower\":");
    w.number(problem.box.lower[j]);
    w.literal(",\"upper\":");
    w.number(problem.box.upper[j]);
    w.literal("}");
  });
  w.literal(",\"rows\":");
  w.list(rows, [&](Index i) {
    w.literal("{\"index\":");
    w.number(i);
    w.literal(",\"name\":");
    w.name(mcp.equation_name(i));
    w.literal(",\"constant\":");
    w.number(problem.q[i]);
    w.literal(",\"entries\":");
    std::vector<std::pair<Index, double>> entries;
    for (SpMat::InnerIterator it(by_row, i); it; ++it) entries.emplace_back(it.row(), it.value());
    w.list(entries, [&](const std::pair<Index, double>& e) {
      w.literal("[");
      w.number(e.first);
      w.literal(",");
      w.number(e.second);
      w.literal("]");
    });
    w.literal("}");
  });
  w.literal(",\"proof\":");
  write(w, refutation.proof);
  w.literal(",\"checksum\":" + std::to_string(w.checksum()) + "}");
  return std::move(w.text);
}

std::string rows_in_words(const Mcp& mcp, const Infeasibility& proof, std::size_t most) {
  if (!proof.certificate) return {};
  const std::vector<Index> rows = rows_of(*proof.certificate);
  std::string words = rows.size() == 1 ? "row " : "rows ";
  const std::size_t named = rows.size() <= most + 1 ? rows.size() : most;
  for (std::size_t k = 0; k < named; ++k)
    words += (k == 0 ? "" : k + 1 == rows.size() ? " and " : ", ") + mcp.equation_name(rows[k]);
  if (rows.size() == 1) words += " and the bounds";
  if (named < rows.size()) words += " and " + std::to_string(rows.size() - named) + " others";
  return words;
}

bool uses_terms(const Mcp& mcp, const Infeasibility& proof) {
  if (!proof.certificate || !proof.sums) return false;
  const std::vector<Index> rows = rows_of(*proof.certificate);
  for (Index j = mcp.size(); j < proof.sums->size(); ++j)
    for (SpMat::InnerIterator it(proof.sums->M, j); it; ++it)
      if (std::ranges::binary_search(rows, Index{it.row()})) return true;
  return false;
}

}  // namespace perp::ncp
