// SPDX-License-Identifier: Apache-2.0
/// Matrix Market matrices and vectors (lcp/io/matrix_market.hpp): what is read is compressed, in order and finite, the
/// judge takes it, and what is written of it reads back the same.
#include <sstream>

#include "fuzz/support.hpp"
#include "lcp/io/matrix_market.hpp"
#include "lcp/judge/judge.hpp"

namespace {

using perp::fuzz::require;
using perp::lcp::Index;
using perp::lcp::SpMat;
using perp::lcp::Vec;

const perp::fuzz::Scratch& scratch() {
  static const perp::fuzz::Scratch folder;
  return folder;
}

/// Of the sizes, the first three words that are in no comment, one from 1e3 to 1e8: such a matrix takes the time of
/// hundreds of small ones. Larger ones do not fit into what a fuzzer may allocate, and are read.
bool slow(std::string_view text) {
  std::istringstream lines{std::string(text)};
  std::string line;
  std::string word;
  int words = 0;
  while (words < 3 && std::getline(lines, line)) {
    if (line.starts_with('%')) continue;
    std::istringstream in(line);
    for (; words < 3 && in >> word; ++words)
      if (word.size() > 3 && word.size() <= 8) return true;
  }
  return false;
}

bool same(const SpMat& A, const SpMat& B) {
  return A.rows() == B.rows() && A.cols() == B.cols() && A.nonZeros() == B.nonZeros() &&
         (A.nonZeros() == 0 || (A.coeffs() == B.coeffs()).all());
}

void use(const SpMat& A, bool write) {
  require(A.isCompressed(), "a matrix is compressed");
  for (Index j = 0; j < A.cols(); ++j)
    for (Index k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k) {
      const int row = A.innerIndexPtr()[k];
      require(row >= 0 && row < A.rows() && (k == A.outerIndexPtr()[j] || A.innerIndexPtr()[k - 1] < row),
              "the rows of a column ascend");
      require(std::isfinite(A.valuePtr()[k]), "entries are finite");
    }
  constexpr Index few = 64;
  if (A.rows() == A.cols() && A.rows() <= few) {
    const perp::lcp::AffineMcp problem = perp::lcp::standard_lcp(A, Vec::Constant(A.rows(), -1));
    require(!problem.invalid(), "a square matrix makes an LCP");
    perp::lcp::judge(problem, Vec::Ones(A.rows()));
  }
  if (!write || A.rows() + A.cols() > few) return;
  const std::string path = scratch().path("m.mtx");
  perp::lcp::write_matrix(path, A, "of the fuzzer\n%");
  require(same(A, perp::lcp::read_matrix(path)), "a matrix reads back as it was");
}

void use(const Vec& v, bool bounds, bool write) {
  constexpr Index few = 1000;
  if (v.size() > few) return;
  for (const double value : v) require(bounds ? !std::isnan(value) : std::isfinite(value), "entries are numbers");
  if (!write) return;
  const std::string path = scratch().path("v.mtx");
  perp::lcp::write_vector(path, v);
  require(perp::lcp::read_vector(path, bounds) == v, "a vector reads back as it was");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = perp::fuzz::view(data, size);
  const std::string name = "input.mtx";
  const bool write = perp::fuzz::one_in(32, text);
  if (!slow(text)) perp::fuzz::accepted<perp::lcp::FileError>([&] { use(perp::lcp::parse_matrix(text, name), write); });
  for (const bool bounds : {false, true})
    perp::fuzz::accepted<perp::lcp::FileError>(
        [&] { use(perp::lcp::parse_vector(text, name, bounds), bounds, write); });
  return 0;
}
