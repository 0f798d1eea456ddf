// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/matrix_market.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>
#include <system_error>
#include <vector>

#include "lcp/io/file_path.hpp"
#include "lcp/io/output_file.hpp"
#include "lcp/memory.hpp"

namespace perp::lcp {
namespace {

constexpr double infinite_bound = 1e20;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// Numbers separated by white space, with the line they are on.
class Scanner {
 public:
  Scanner(const std::string& path, std::string_view text)
      : path_(path), at_(text.data()), end_(text.data() + text.size()) {}

  [[noreturn]] void fail(const std::string& reason) const { throw FileError(path_, line_, reason); }

  /// The rest of the line, without its end.
  std::string_view line() {
    const char* begin = at_;
    while (at_ != end_ && *at_ != '\n') ++at_;
    const char* stop = at_ != begin && at_[-1] == '\r' ? at_ - 1 : at_;
    if (at_ != end_) ++at_;
    ++line_;
    return {begin, static_cast<std::size_t>(stop - begin)};
  }
  /// Past blank lines and lines that begin with %.
  void skip_comments() {
    for (;;) {
      skip_space();
      if (at_ == end_ || *at_ != '%') return;
      line();
    }
  }
  bool done() {
    skip_comments();
    return at_ == end_;
  }
  std::string_view word() {
    skip_space();
    const char* begin = at_;
    while (at_ != end_ && !space(*at_)) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }
  Index index(const char* what) {
    skip_space();
    Index value = 0;
    const auto [end, error] = std::from_chars(at_, end_, value);
    if (error != std::errc{} || !ends(end))
      fail(std::string(what) + " is '" + std::string(word()) + "', not an integer");
    at_ = end;
    return value;
  }
  double number() {
    skip_space();
    const char* begin = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    double value = 0;
    const auto [end, error] = std::from_chars(begin, end_, value);
    if (error == std::errc::result_out_of_range && ends(end)) {  // underflow is 0, overflow infinite
      at_ = begin;
      value = std::strtod(std::string(word()).c_str(), nullptr);
      return value;
    }
    if (error != std::errc{} || !ends(end)) {
      const std::string_view found = word();
      fail(found.empty() ? "the file ends before its last value" : "'" + std::string(found) + "' is not a number");
    }
    at_ = end;
    return value;
  }
  /// Characters left.
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  static bool space(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
  bool ends(const char* at) const { return at == end_ || space(*at); }
  void skip_space() {
    for (; at_ != end_ && space(*at_); ++at_)
      if (*at_ == '\n') ++line_;
  }

  const std::string& path_;
  const char* at_;
  const char* end_;
  long line_ = 1;
};

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return result;
}

struct Header {
  bool coordinate = true;
  bool pattern = false;
  double mirror = 0;  ///< a_ji = mirror a_ij: 1 symmetric, -1 skew-symmetric, 0 general
  Index rows = 0;
  Index columns = 0;
  Index entries = 0;
};

constexpr std::string_view banner = "%%matrixmarket";

Header read_header(Scanner& in) {
  Scanner words = in;
  std::vector<std::string> parts;
  const std::string first = lower(in.line());
  for (std::size_t at = 0; at < first.size();) {
    const std::size_t begin = first.find_first_not_of(" \t", at);
    if (begin == std::string::npos) break;
    at = std::min(first.find_first_of(" \t", begin), first.size());
    parts.push_back(first.substr(begin, at - begin));
  }
  if (parts.empty() || parts[0] != banner) words.fail("a Matrix Market file begins with %%MatrixMarket");
  if (parts.size() != 5) words.fail("the header has " + std::to_string(parts.size()) + " words, not five");
  Header h;
  if (parts[1] != "matrix") words.fail("the object is '" + parts[1] + "', not a matrix");
  if (parts[2] != "coordinate" && parts[2] != "array") words.fail("the format '" + parts[2] + "' is not known");
  h.coordinate = parts[2] == "coordinate";
  if (parts[3] != "real" && parts[3] != "integer" && parts[3] != "double" && parts[3] != "pattern")
    words.fail("values of type '" + parts[3] + "' are not read; real, integer and pattern are");
  h.pattern = parts[3] == "pattern";
  if (h.pattern && !h.coordinate) words.fail("an array has values: its type cannot be pattern");
  if (parts[4] != "general" && parts[4] != "symmetric" && parts[4] != "skew-symmetric")
    words.fail("the symmetry '" + parts[4] + "' is not read; general, symmetric and skew-symmetric are");
  h.mirror = parts[4] == "general" ? 0 : parts[4] == "symmetric" ? 1 : -1;
  in.skip_comments();
  h.rows = in.index("the number of rows");
  h.columns = in.index("the number of columns");
  constexpr Index most = std::numeric_limits<int>::max();
  if (h.rows < 0 || h.columns < 0 || h.rows > most || h.columns > most)
    in.fail("the size " + std::to_string(h.rows) + " x " + std::to_string(h.columns) + " is out of range");
  if (h.mirror != 0 && h.rows != h.columns) in.fail("a matrix with a symmetry must be square");
  if (h.coordinate) {
    h.entries = in.index("the number of entries");
    if (h.entries < 0 || h.entries > most) in.fail(std::to_string(h.entries) + " entries are out of range");
  } else if (h.mirror == 0) {
    h.entries = h.rows * h.columns;
  } else {
    h.entries = h.rows * (h.rows + (h.mirror > 0 ? 1 : -1)) / 2;
  }
  return h;
}

struct Entries {
  std::vector<int> row, column;
  std::vector<double> value;
};

/// As given: of a matrix with a symmetry one triangle.
Entries read_entries(Scanner& in, const Header& h, bool bounds) {
  Entries e;
  // What a short file announces is not believed: an entry takes two characters at least, one with its place four.
  const std::size_t count = std::min(static_cast<std::size_t>(h.entries), in.left() / (h.coordinate ? 4 : 2) + 1);
  require_memory(static_cast<double>(count * (2 * sizeof(int) + sizeof(double))), "the entries");
  e.row.reserve(count);
  e.column.reserve(count);
  e.value.reserve(count);
  Index i = h.mirror < 0 ? 1 : 0;  // of an array: by columns, of a triangle from the diagonal down
  Index j = 0;
  for (Index k = 0; k < h.entries; ++k) {
    if (in.done())
      in.fail("the file ends after " + std::to_string(k) + " of " + std::to_string(h.entries) + " entries");
    if (h.coordinate) {
      i = in.index("the row") - 1;
      j = in.index("the column") - 1;
      if (i < 0 || i >= h.rows || j < 0 || j >= h.columns)
        in.fail("the place (" + std::to_string(i + 1) + ", " + std::to_string(j + 1) + ") is not in a matrix of " +
                std::to_string(h.rows) + " x " + std::to_string(h.columns));
      if (h.mirror != 0 && i < j)
        in.fail("the place (" + std::to_string(i + 1) + ", " + std::to_string(j + 1) +
                ") is above the diagonal: of a matrix with a symmetry the lower triangle is given");
      if (h.mirror < 0 && i == j) in.fail("a skew-symmetric matrix has no entries on the diagonal");
    }
    const double v = h.pattern ? 1 : in.number();
    if (std::isnan(v) || (!bounds && std::isinf(v))) in.fail("the value is " + std::to_string(v));
    e.row.push_back(static_cast<int>(i));
    e.column.push_back(static_cast<int>(j));
    e.value.push_back(v);
    if (!h.coordinate && ++i == h.rows) {
      ++j;
      i = h.mirror == 0 ? 0 : h.mirror > 0 ? j : j + 1;
    }
  }
  if (!in.done()) in.fail("there is more text after the last of " + std::to_string(h.entries) + " entries");
  return e;
}

/// Counting sort by rows, then by columns: two passes, no list of triplets.
SpMat assemble(const Header& h, Entries e) {
  if (h.mirror != 0) {
    const std::size_t given = e.value.size();
    for (std::size_t k = 0; k < given; ++k)
      if (e.row[k] != e.column[k]) {
        e.row.push_back(e.column[k]);
        e.column.push_back(e.row[k]);
        e.value.push_back(h.mirror * e.value[k]);
      }
  }
  if (e.value.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::length_error("more than 2^31 entries");
  // Absent entries are legal, so that a short file may have any size; lists over rows and columns must fit, though.
  const double lists =
      static_cast<double>(sizeof(int)) * (3.0 * static_cast<double>(h.rows) + static_cast<double>(h.columns));
  const double entries = 2.0 * (sizeof(int) + sizeof(double)) * static_cast<double>(e.value.size());
  require_memory(lists + entries,
                 "the lists of a matrix of " + std::to_string(h.rows) + " x " + std::to_string(h.columns));
  Eigen::SparseMatrix<double, Eigen::RowMajor> by_rows(h.rows, h.columns);
  by_rows.resizeNonZeros(static_cast<Index>(e.value.size()));
  int* start = by_rows.outerIndexPtr();
  std::fill_n(start, h.rows + 1, 0);
  for (const int i : e.row) ++start[i + 1];
  for (Index i = 0; i < h.rows; ++i) start[i + 1] += start[i];
  std::vector<int> next(start, start + h.rows);
  for (std::size_t k = 0; k < e.value.size(); ++k) {
    const int at = next[static_cast<std::size_t>(e.row[k])]++;
    by_rows.innerIndexPtr()[at] = e.column[k];
    by_rows.valuePtr()[at] = e.value[k];
  }
  e = {};
  SpMat A = by_rows;  // sorts the rows of every column
  // Add up the entries of one place, which are neighbours now.
  int kept = 0;
  int begin = 0;
  for (Index j = 0; j < A.cols(); ++j) {
    const int end = A.outerIndexPtr()[j + 1];
    const int first = kept;
    for (int k = begin; k < end; ++k) {
      if (kept > first && A.innerIndexPtr()[kept - 1] == A.innerIndexPtr()[k]) {
        A.valuePtr()[kept - 1] += A.valuePtr()[k];
      } else {
        A.innerIndexPtr()[kept] = A.innerIndexPtr()[k];
        A.valuePtr()[kept++] = A.valuePtr()[k];
      }
    }
    begin = end;
    A.outerIndexPtr()[j + 1] = kept;
  }
  A.resizeNonZeros(kept);
  return A;
}

bool has_banner(std::string_view text) { return lower(text.substr(0, banner.size())) == banner; }

double as_bound(double v) { return std::abs(v) >= infinite_bound ? std::copysign(infinity, v) : v; }

/// shortest text that reads back exactly
void append(std::string& text, double v) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), v);
  text.append(digits.data(), end);
}

std::string heading(const char* format, const std::string& comment) {
  std::string text = std::string("%%MatrixMarket matrix ") + format + " real general\n";
  std::size_t begin = 0;
  while (begin < comment.size()) {
    const std::size_t end = std::min(comment.find('\n', begin), comment.size());
    text += "% " + comment.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return text;
}

}  // namespace

std::string_view without_mark(std::string_view text, const std::string& file) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw FileError(file, 1, "it is text in UTF-16 (its byte order mark says so), not in UTF-8");
  return without_utf8_mark(text);
}

std::string read_file(const std::string& path) {
  const File file(open_file(path));
  if (!file) throw FileError(path, 0, std::strerror(errno));
  std::string text;
  std::error_code no_size;  // a pipe's
  if (const std::uintmax_t size = std::filesystem::file_size(file_path(path), no_size); !no_size) {
    try {
      require_memory(static_cast<double>(size), "the characters of the file");
    } catch (const NotEnoughMemory& error) {
      throw FileError(path, 0, error.what());
    }
    text.reserve(static_cast<std::size_t>(size));
  }
  std::array<char, 1 << 16> buffer{};
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file.get()))
    text.append(buffer.data(), got);
  if (std::ferror(file.get()) != 0) throw FileError(path, 0, std::strerror(errno));
  return text;
}

SpMat read_matrix(const std::string& path) { return parse_matrix(read_file(path), path); }

SpMat parse_matrix(std::string_view content, const std::string& name) {
  const std::string_view text = without_mark(content, name);
  Scanner in(name, text);
  const Header h = read_header(in);
  const Scanner sizes = in;
  try {
    SpMat A = assemble(h, read_entries(in, h, false));
    if (!A.coeffs().allFinite()) in.fail("entries of one place add up to infinity");
    return A;
  } catch (const std::length_error& error) {
    in.fail(error.what());
  } catch (const NotEnoughMemory& error) {
    sizes.fail(error.what());
  } catch (const std::bad_alloc&) {
    sizes.fail("a matrix of " + std::to_string(h.rows) + " x " + std::to_string(h.columns) + " does not fit in memory");
  }
}

Vec read_vector(const std::string& path, bool bounds) { return parse_vector(read_file(path), path, bounds); }

Vec parse_vector(std::string_view content, const std::string& name, bool bounds) {
  const std::string_view text = without_mark(content, name);
  Scanner in(name, text);
  if (!has_banner(text)) {
    std::vector<double> values;
    while (!in.done()) {
      values.push_back(in.number());
      if (std::isnan(values.back()) || (!bounds && std::isinf(values.back()))) in.fail("the value is not finite");
    }
    Vec v = Eigen::Map<const Vec>(values.data(), static_cast<Index>(values.size()));
    return bounds ? Vec(v.unaryExpr(&as_bound)) : v;
  }
  const Header h = read_header(in);
  if (h.rows != 1 && h.columns != 1)
    in.fail("a vector is n x 1 or 1 x n, this is " + std::to_string(h.rows) + " x " + std::to_string(h.columns));
  const Scanner sizes = in;
  const Index n = h.rows * h.columns;
  try {
    const Entries e = read_entries(in, h, bounds);
    // Absent entries are legal, so that a short file may announce any length.
    require_memory(static_cast<double>(sizeof(double)) * static_cast<double>(n),
                   "the values of a vector of " + std::to_string(n));
    Vec v = Vec::Zero(n);
    for (std::size_t k = 0; k < e.value.size(); ++k) v[std::max(e.row[k], e.column[k])] += e.value[k];
    if (bounds) v = v.unaryExpr(&as_bound);
    return v;
  } catch (const NotEnoughMemory& error) {
    sizes.fail(error.what());
  } catch (const std::bad_alloc&) {
    sizes.fail("a vector of " + std::to_string(n) + " entries does not fit in memory");
  }
}

std::string matrix_text(const SpMat& A, const std::string& comment) {
  std::string text = heading("coordinate", comment);
  text += std::to_string(A.rows()) + " " + std::to_string(A.cols()) + " " + std::to_string(A.nonZeros()) + "\n";
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      text += std::to_string(it.row() + 1) + " " + std::to_string(j + 1) + " ";
      append(text, it.value());
      text += '\n';
    }
  return text;
}

std::string vector_text(In v, const std::string& comment) {
  std::string text = heading("array", comment);
  text += std::to_string(v.size()) + " 1\n";
  for (const double value : v) {
    append(text, value);
    text += '\n';
  }
  return text;
}

void write_matrix(const std::string& path, const SpMat& A, const std::string& comment) {
  write_file(path, matrix_text(A, comment));
}
void write_vector(const std::string& path, In v, const std::string& comment) {
  write_file(path, vector_text(v, comment));
}

}  // namespace perp::lcp
