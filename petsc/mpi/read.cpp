// SPDX-License-Identifier: Apache-2.0
#include "petsc/mpi/read.hpp"

#include "petsc/box.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

namespace perp::petsc {
namespace {

bool is_matrix_market(const std::string& path) { return path.ends_with(".mtx"); }

// --- PETSc's binary format -------------------------------------------------------------------------------------------

std::int64_t big_endian(std::ifstream& file) {
  unsigned char bytes[4] = {};
  file.read(reinterpret_cast<char*>(bytes), 4);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(bytes[0]) << 24 |
                                   static_cast<std::uint32_t>(bytes[1]) << 16 |
                                   static_cast<std::uint32_t>(bytes[2]) << 8 | static_cast<std::uint32_t>(bytes[3]));
}

/// Calls wrong(k, number) for `count` numbers until it says something.
template <class Number, class Wrong>
std::string scan(std::ifstream& file, std::int64_t count, Wrong wrong) {
  constexpr std::int64_t at_once = 65536;
  std::vector<char> bytes(static_cast<std::size_t>(at_once) * sizeof(Number));
  std::string said;
  for (std::int64_t k = 0; k < count && said.empty();) {
    const std::int64_t some = std::min(at_once, count - k);
    file.read(bytes.data(), some * static_cast<std::int64_t>(sizeof(Number)));
    for (std::int64_t i = 0; i < some && said.empty(); ++i, ++k) {
      Number number{};
      char* at = bytes.data() + i * static_cast<std::int64_t>(sizeof(Number));
      if constexpr (std::endian::native == std::endian::little) std::reverse(at, at + sizeof(Number));
      std::memcpy(&number, at, sizeof(Number));
      said = wrong(k, number);
    }
  }
  return said;
}

/// PETSc trusts the lengths of the rows and the columns, and ends or hangs where they are wrong.
std::string matrix_fault(const std::string& path, std::ifstream& file, std::int64_t n, std::int64_t entries) {
  std::int64_t sum = 0;
  std::string wrong = scan<std::int32_t>(file, n, [&](std::int64_t k, std::int32_t length) {
    sum += length;
    return length >= 0 ? std::string()
                       : path + ": row " + std::to_string(k + 1) + " has " + std::to_string(length) + " entries";
  });
  if (wrong.empty() && sum != entries)
    wrong = path + ": its rows have " + std::to_string(sum) + " entries, its head announces " + std::to_string(entries);
  if (!wrong.empty()) return wrong;
  wrong = scan<std::int32_t>(file, entries, [&](std::int64_t k, std::int32_t column) {
    return column >= 0 && column < n ? std::string()
                                     : path + ": entry " + std::to_string(k + 1) + " is in column " +
                                           std::to_string(column + 1) + " of " + std::to_string(n);
  });
  if (!wrong.empty()) return wrong;
  return scan<double>(file, entries, [&](std::int64_t k, double value) {
    return std::isfinite(value) ? std::string() : path + ": entry " + std::to_string(k + 1) + " is not finite";
  });
}

/// What is wrong with the file: PETSc itself would stop on one rank and leave the others.
std::string binary_fault(const std::string& path, bool matrix, std::int64_t rows) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return path + ": cannot be read";
  file.seekg(0, std::ios::end);
  const std::int64_t length = file.tellg();
  file.seekg(0);
  const std::int64_t id = big_endian(file);
  const std::int64_t wanted = matrix ? MAT_FILE_CLASSID : VEC_FILE_CLASSID;
  if (!file || id != wanted)
    return path + ": is no " + (matrix ? "matrix" : "vector") +
           " in PETSc's binary format (Matrix Market files end in .mtx)";
  const std::int64_t m = big_endian(file);
  const std::int64_t n = matrix ? big_endian(file) : m;
  const std::int64_t entries = matrix ? big_endian(file) : 0;
  if (m != n) return path + ": is " + std::to_string(m) + " x " + std::to_string(n) + ", not square";
  if (!matrix && m != rows)
    return path + ": has " + std::to_string(m) + " entries, the matrix " + std::to_string(rows) + " rows";
  const std::int64_t expected = matrix ? 16 + 4 * m + 12 * entries : 8 + 8 * m;
  if (!file || m < 0 || entries < 0 || length < expected)
    return path + ": has " + std::to_string(length) + " bytes, its head announces " + std::to_string(expected);
  return matrix ? matrix_fault(path, file, n, entries) : std::string();
}

PetscErrorCode check_binary(const std::string& path, bool matrix, std::int64_t rows, std::string& wrong) {
  int rank = 0;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) wrong = binary_fault(path, matrix, rows);
  return share(wrong);
}

// --- Matrix Market ---------------------------------------------------------------------------------------------------

struct Market {
  std::ifstream file;
  bool coordinate = true;
  bool pattern = false;
  double mirrored = 0;  ///< the entry (j, i) is so many times (i, j): 1 symmetric, -1 skew-symmetric, 0 general
  long rows = 0, columns = 0, entries = 0;
  std::string line;
  long number = 0;  ///< of the line

  /// The next line that says something; false at the end.
  bool next() {
    while (std::getline(file, line)) {
      ++number;
      const auto first = std::find_if(line.begin(), line.end(), [](unsigned char c) { return std::isspace(c) == 0; });
      if (first != line.end() && *first != '%') return true;
    }
    return false;
  }
};

std::string at_line(const std::string& path, const Market& m, const std::string& what) {
  return path + ", line " + std::to_string(m.number) + ": " + what;
}

std::string open_market(const std::string& path, Market& m) {
  m.file.open(path);
  std::string head;
  if (!m.file || !std::getline(m.file, head)) return path + ": cannot be read";
  m.number = 1;
  std::transform(head.begin(), head.end(), head.begin(), [](unsigned char c) { return std::tolower(c); });
  std::istringstream words(head);
  std::string banner, object, format, field, symmetry;
  words >> banner >> object >> format >> field >> symmetry;
  const bool known = (format == "coordinate" || format == "array") &&
                     (field == "real" || field == "double" || field == "integer" || field == "pattern") &&
                     (symmetry == "general" || symmetry == "symmetric" || symmetry == "skew-symmetric");
  if (banner != "%%matrixmarket" || object != "matrix" || !known)
    return path + ": the first line is no header of a real Matrix Market matrix";
  m.coordinate = format == "coordinate";
  m.pattern = field == "pattern";
  m.mirrored = symmetry == "symmetric" ? 1 : symmetry == "skew-symmetric" ? -1 : 0;
  if (!m.next()) return path + ": has no line of sizes";
  std::istringstream sizes(m.line);
  sizes >> m.rows >> m.columns;
  m.entries = m.rows * m.columns;
  if (m.coordinate) sizes >> m.entries;
  if (!sizes || m.rows < 0 || m.columns < 0 || m.entries < 0) return at_line(path, m, "these are no sizes");
  if (std::max(m.rows, m.columns) > PETSC_MAX_INT) return at_line(path, m, "too large for this PETSc's integers");
  return {};
}

bool nothing_but_blanks(const char* text) {
  while (std::isspace(static_cast<unsigned char>(*text)) != 0) ++text;
  return *text == '\0';
}

/// Calls use(row, column, value), from 0, for all entries.
template <class Use>
std::string each_entry(const std::string& path, bool infinities, Use use) {
  Market m;
  std::string wrong = open_market(path, m);
  if (!wrong.empty()) return wrong;
  for (long k = 0; k < m.entries; ++k) {
    if (!m.next()) return path + ": ends after " + std::to_string(k) + " of " + std::to_string(m.entries) + " entries";
    const char* at = m.line.c_str();
    char* end = nullptr;
    long i = m.coordinate ? std::strtol(at, &end, 10) : k % m.rows + 1;
    if (m.coordinate) at = end;
    const long j = m.coordinate ? std::strtol(at, &end, 10) : k / m.rows + 1;
    if (m.coordinate) at = end;
    const double value = m.pattern ? 1 : std::strtod(at, &end);
    if (end == at && !m.pattern) return at_line(path, m, "an entry is missing");
    if (!nothing_but_blanks(m.pattern ? at : end)) return at_line(path, m, "there is text behind the entry");
    if (std::isnan(value)) return at_line(path, m, "an entry is not a number");
    if (!infinities && std::isinf(value)) return at_line(path, m, "an entry is not finite");
    if (i < 1 || i > m.rows || j < 1 || j > m.columns) return at_line(path, m, "there is no such place");
    use(i - 1, j - 1, value);
    if (m.mirrored != 0 && i != j) use(j - 1, i - 1, m.mirrored * value);
  }
  if (m.next()) return at_line(path, m, "there is text after the last entry");
  return {};
}

PetscErrorCode read_market_matrix(const std::string& path, OwnMat& M, std::string& wrong) {
  Market head;
  wrong = open_market(path, head);
  if (wrong.empty() && head.rows != head.columns)
    wrong = path + ": is " + std::to_string(head.rows) + " x " + std::to_string(head.columns) + ", not square";
  if (wrong.empty() && !head.coordinate) wrong = path + ": a matrix as an array; write it as coordinate";
  PetscCall(share(wrong));
  if (!wrong.empty()) return ok;
  const auto n = static_cast<PetscInt>(head.rows);
  PetscInt size = n;
  PetscInt local = PETSC_DECIDE;
  PetscInt end = 0;
  PetscCall(PetscSplitOwnership(PETSC_COMM_WORLD, &local, &size));
  PetscCallMPI(MPI_Scan(&local, &end, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  const PetscInt begin = end - local;
  PetscCall(MatCreate(PETSC_COMM_WORLD, M.out()));
  PetscCall(MatSetSizes(M, local, local, n, n));
  PetscCall(MatSetType(M, MATAIJ));
  const auto mine = [&](long i) { return i >= begin && i < end; };
  std::vector<PetscInt> own(static_cast<std::size_t>(end - begin), 1);  // the diagonal
  std::vector<PetscInt> others(own.size(), 0);
  wrong = each_entry(path, false, [&](long i, long j, double) {
    if (mine(i) && i != j) ++(mine(j) ? own : others)[static_cast<std::size_t>(i - begin)];
  });
  PetscCall(share(wrong));
  if (!wrong.empty()) return ok;
  PetscCall(MatXAIJSetPreallocation(M, 1, own.data(), others.data(), nullptr, nullptr));
  PetscErrorCode code = ok;
  for (PetscInt i = begin; i < end && code == ok; ++i) code = MatSetValue(M, i, i, 0, ADD_VALUES);
  wrong = each_entry(path, false, [&](long i, long j, double value) {
    if (mine(i) && code == ok)
      code = MatSetValue(M, static_cast<PetscInt>(i), static_cast<PetscInt>(j), value, ADD_VALUES);
  });
  PetscCall(code);
  PetscCall(MatAssemblyBegin(M, MAT_FINAL_ASSEMBLY));
  return MatAssemblyEnd(M, MAT_FINAL_ASSEMBLY);
}

std::string read_market_vector(const std::string& path, std::int64_t rows, Vec v) {
  Market head;
  std::string wrong = open_market(path, head);
  if (!wrong.empty()) return wrong;
  const bool lying = head.rows == 1 && head.columns != 1;
  if (std::min(head.rows, head.columns) > 1 || std::max(head.rows, head.columns) != rows)
    return path + ": is " + std::to_string(head.rows) + " x " + std::to_string(head.columns) + ", the matrix has " +
           std::to_string(rows) + " rows";
  PetscInt begin = 0;
  PetscInt end = 0;
  VecGetOwnershipRange(v, &begin, &end);
  Values values(v);
  return each_entry(path, true, [&](long i, long j, double value) {
    const long k = lying ? j : i;
    if (k >= begin && k < end) values[static_cast<PetscInt>(k) - begin] += value;
  });
}

/// Infinite bounds as PETSc writes them; what is not finite is wrong elsewhere.
std::string settle_infinities(const std::string& path, bool bounds, Vec v) {
  PetscInt n = 0;
  PetscInt begin = 0;
  VecGetLocalSize(v, &n);
  VecGetOwnershipRange(v, &begin, nullptr);
  Values values(v);
  for (PetscInt i = 0; i < n; ++i) {
    if (bounds && std::abs(values[i]) >= infinite) values[i] = values[i] > 0 ? PETSC_INFINITY : PETSC_NINFINITY;
    if (!std::isfinite(values[i])) return path + ": entry " + std::to_string(begin + i + 1) + " is not finite";
  }
  return {};
}

/// Zeros on the diagonal where the file has no entries: the solver needs their places.
PetscErrorCode complete_diagonal(Mat M) {
  PetscBool gap = PETSC_FALSE;
  PetscInt n = 0;
  PetscInt begin = 0;
  PetscInt end = 0;
  OwnMat zeros;
  PetscCall(MatMissingDiagonal(M, &gap, nullptr));
  int gaps = gap == PETSC_TRUE ? 1 : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &gaps, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD));
  if (gaps == 0) return ok;
  PetscCall(MatGetLocalSize(M, &n, nullptr));
  PetscCall(MatGetOwnershipRange(M, &begin, &end));
  PetscCall(
      MatCreateAIJ(PETSC_COMM_WORLD, n, n, PETSC_DETERMINE, PETSC_DETERMINE, 1, nullptr, 0, nullptr, zeros.out()));
  for (PetscInt i = begin; i < end; ++i) PetscCall(MatSetValue(zeros, i, i, 0, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(zeros, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(zeros, MAT_FINAL_ASSEMBLY));
  return MatAXPY(M, 1, zeros, DIFFERENT_NONZERO_PATTERN);
}

}  // namespace

PetscErrorCode share(std::string& text) {
  int rank = 0;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  int first = text.empty() ? INT32_MAX : rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD));
  if (first == INT32_MAX) return ok;
  int length = static_cast<int>(text.size());
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_INT, first, PETSC_COMM_WORLD));
  text.resize(static_cast<std::size_t>(length));
  PetscCallMPI(MPI_Bcast(text.data(), length, MPI_CHAR, first, PETSC_COMM_WORLD));
  return ok;
}

PetscErrorCode read_matrix(const std::string& path, OwnMat& M, std::string& wrong) {
  if (is_matrix_market(path)) return read_market_matrix(path, M, wrong);
  PetscCall(check_binary(path, true, 0, wrong));
  if (!wrong.empty()) return ok;
  PetscViewer viewer = nullptr;
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, path.c_str(), FILE_MODE_READ, &viewer));
  PetscCall(MatCreate(PETSC_COMM_WORLD, M.out()));
  PetscCall(MatSetType(M, MATAIJ));
  PetscCall(MatLoad(M, viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  return complete_diagonal(M);
}

PetscErrorCode read_vector(const std::string& path, Mat M, bool bounds, OwnVec& v, std::string& wrong) {
  PetscInt rows = 0;
  PetscCall(MatGetSize(M, &rows, nullptr));
  PetscCall(MatCreateVecs(M, nullptr, v.out()));
  PetscCall(VecSet(v, 0));
  if (is_matrix_market(path)) {
    wrong = read_market_vector(path, rows, v);
    PetscCall(share(wrong));
    if (!wrong.empty()) return ok;
  } else {
    PetscCall(check_binary(path, false, rows, wrong));
    if (!wrong.empty()) return ok;
    PetscViewer viewer = nullptr;
    PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, path.c_str(), FILE_MODE_READ, &viewer));
    PetscCall(VecLoad(v, viewer));
    PetscCall(PetscViewerDestroy(&viewer));
  }
  wrong = settle_infinities(path, bounds, v);
  return share(wrong);
}

}  // namespace perp::petsc
