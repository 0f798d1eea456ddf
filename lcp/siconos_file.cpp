#include "lcp/siconos_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <utility>

namespace perp::lcp {
namespace {

using Dense = Eigen::MatrixXd;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

/// Numbers one after the other, with the line they stand on.
class Numbers {
 public:
  Numbers(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  template <class... Parts>
  [[noreturn]] void refuse(const Parts&... parts) const {
    std::ostringstream why;
    (why << ... << parts);
    throw FileError(name_, line_, why.str());
  }

  Index integer(const char* what, Index least, Index most) {
    const std::string_view token = next(what);
    long long value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error != std::errc() || end != token.data() + token.size()) refuse(what, " is '", token, "', not an integer");
    if (value < least || value > most) refuse(what, " is ", value, ", not within ", least, " and ", most);
    return static_cast<Index>(value);
  }

  double number(const char* what) {
    const std::string_view token = next(what);
    double value = 0;
    if (!parse(token, value)) refuse(what, ": '", token, "' is not a number");
    if (!std::isfinite(value)) refuse(what, " has an entry ", token);
    return value;
  }

  /// What a file of so many more bytes can hold at most: a count above is refused before anything is allocated.
  void expect(const char* what, Index rows, Index columns) const {
    const auto room = static_cast<double>(rest_.size() + 1) / 2;
    if (static_cast<double>(rows) * static_cast<double>(columns) > room)
      refuse(what, " has ", rows, " x ", columns, " entries, more than the rest of the file can hold");
  }

  Vec vector(const char* what, Index n) {
    expect(what, n, 1);
    Vec v(n);
    for (Index i = 0; i < n; ++i) v[i] = number(what);
    return v;
  }

  Dense by_rows(const char* what, Index rows, Index columns) {
    expect(what, rows, columns);
    Dense A(rows, columns);
    for (Index i = 0; i < rows; ++i)
      for (Index j = 0; j < columns; ++j) A(i, j) = number(what);
    return A;
  }

  /// MATRIX of the header comment.
  Dense matrix(const char* what, Index size) {
    const Index storage = integer("the storage type", 0, 100);
    if (storage != 0)
      refuse("the storage type of ", what, " is ", storage, storage == 1 ? " (block-sparse)" : "",
             ", only 0 (dense) is read");
    const Index most = std::numeric_limits<int>::max();
    const Index rows = integer("the number of rows", 0, most);
    const Index columns = integer("the number of columns", 0, most);
    if (integer("the number of rows, again,", 0, most) != rows ||
        integer("the number of columns, again,", 0, most) != columns)
      refuse("the second pair of sizes differs from the first, ", rows, " x ", columns);
    if (rows > columns && columns == size)
      refuse(what, " is ", rows, " x ", columns, ": ", rows - columns, " equations more than unknowns");
    if (rows != size || columns != size) refuse(what, " is ", rows, " x ", columns, ", not ", size, " x ", size);
    expect(what, rows, columns);
    Dense M(rows, columns);
    for (Index j = 0; j < columns; ++j)
      for (Index i = 0; i < rows; ++i) M(i, j) = number(what);
    return M;
  }

  /// The numbers of a known solution, or text; nothing else may be left.
  std::vector<double> end() {
    const long last = line_;
    std::vector<double> known;
    double value = 0;
    for (skip_blanks(); !rest_.empty(); skip_blanks()) {
      if (!parse(token(), value)) {
        if (line_ == last) refuse("'", token(), "' after the last number on its line");
        break;
      }
      known.push_back(value);
      rest_.remove_prefix(token().size());
    }
    return known;
  }

 private:
  static bool parse(std::string_view token, double& value) {
    if (token.starts_with('+')) token.remove_prefix(1);
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(token).c_str(), nullptr);  // 0, inf
    return (error == std::errc() || error == std::errc::result_out_of_range) && end == token.data() + token.size();
  }

  void skip_blanks() {
    while (!rest_.empty() && is_blank(rest_.front())) {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
  }
  std::string_view token() const {
    const auto end = std::find_if(rest_.begin(), rest_.end(), is_blank);
    return rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
  }
  std::string_view next(const char* what) {
    skip_blanks();
    if (rest_.empty()) refuse("the file ends where ", what, " should be");
    const std::string_view found = token();
    rest_.remove_prefix(found.size());
    return found;
  }

  std::string_view rest_;
  const std::string& name_;
  long line_ = 1;
};

/// The rows of the equations and of the conditions.
void read_blocks(Numbers& in, Index n, Index m, SiconosMlcp& out) {
  std::vector<Index> first{in.integer("the first block's first row", 0, 0)};
  while (first.back() < n + m) first.push_back(in.integer("a block's first row", first.back() + 1, n + m));
  for (std::size_t k = 0; k + 1 < first.size(); ++k) {
    auto& rows = in.integer("a block's type", 0, 1) == 0 ? out.equations : out.conditions;
    for (Index i = first[k]; i < first[k + 1]; ++i) rows.push_back(i);
  }
  if (static_cast<Index>(out.equations.size()) != n)
    in.refuse("the blocks have ", out.equations.size(), " equations for ", n, " free unknowns");
}

SpMat sparse(const Dense& A) { return A.sparseView(0, 0); }

void compare(const Numbers& in, const std::string& name, const Dense& block, const Dense& of_M) {
  for (Index j = 0; j < block.cols(); ++j)
    for (Index i = 0; i < block.rows(); ++i)
      if (std::abs(block(i, j) - of_M(i, j)) > 1e-12 * std::abs(of_M(i, j)))
        in.refuse(name, "(", i + 1, block.cols() > 1 ? ", " + std::to_string(j + 1) : "", ") is ", block(i, j),
                  ", but (M, q) has ", of_M(i, j), " there");
}

}  // namespace

SiconosLcp parse_siconos_lcp(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const Index n = in.integer("n", 0, std::numeric_limits<int>::max());
  const Dense M = in.matrix("M", n);
  SiconosLcp out{.problem = standard_lcp(sparse(M), in.vector("q", n))};
  const std::vector<double> known = in.end();
  if (known.empty()) return out;
  if (static_cast<Index>(known.size()) != 2 * n)
    in.refuse(known.size(), " numbers after the problem, neither none nor a solution of ", 2 * n);
  out.z = Eigen::Map<const Vec>(known.data(), n);
  out.w = Eigen::Map<const Vec>(known.data() + n, n);
  return out;
}

SiconosMlcp parse_siconos_mlcp(std::string_view text, const std::string& name) {
  Numbers in(text, name);
  const bool whole = in.integer("the first storage flag", 0, 1) == 1;
  const bool blocks = in.integer("the second storage flag", 0, 1) == 1;
  if (!whole && !blocks) in.refuse("both storage flags are 0: there is no problem");
  const Index most = std::numeric_limits<int>::max() / 2;
  const Index n = in.integer("n", 0, most);
  const Index m = in.integer("m", 0, most);
  in.expect("the problem", n + m, 1);
  SiconosMlcp out;
  Mlcp& p = out.mlcp;
  Dense A;
  Dense B;
  Dense C;
  Dense D;
  if (whole) {
    read_blocks(in, n, m, out);
    const Dense M = in.matrix("M", n + m);
    const Vec q = in.vector("q", n + m);
    A = M(out.equations, out.equations);
    B = M(out.conditions, out.conditions);
    C = M(out.equations, out.conditions);
    D = M(out.conditions, out.equations);
    p.a = q(out.equations);
    p.b = q(out.conditions);
  } else {
    for (Index i = 0; i < n + m; ++i) (i < n ? out.equations : out.conditions).push_back(i);
  }
  if (blocks) {
    const auto read = [&](const char* what, Index rows, Index columns, Dense& into) {
      const Dense given = in.by_rows(what, rows, columns);
      if (whole)
        compare(in, what, given, into);
      else
        into = given;
    };
    read("A", n, n, A);
    read("B", m, m, B);
    read("C", n, m, C);
    read("D", m, n, D);
    Dense a = p.a;
    Dense b = p.b;
    read("a", n, 1, a);
    read("b", m, 1, b);
    p.a = a;
    p.b = b;
  }
  p.A = sparse(A);
  p.B = sparse(B);
  p.C = sparse(C);
  p.D = sparse(D);
  const std::vector<double> known = in.end();
  if (known.empty()) return out;
  const auto count = static_cast<Index>(known.size());
  if (count != n + 2 * m && count != n + 2 * m - 1)
    in.refuse(count, " numbers after the problem, neither none nor a solution of ", n + 2 * m, " or one less");
  out.v = Eigen::Map<const Vec>(known.data() + count - 2 * m, m);
  out.w = Eigen::Map<const Vec>(known.data() + count - m, m);
  return out;
}

SiconosLcp read_siconos_lcp(const std::string& path) { return parse_siconos_lcp(read_file(path), path); }
SiconosMlcp read_siconos_mlcp(const std::string& path) { return parse_siconos_mlcp(read_file(path), path); }

}  // namespace perp::lcp
