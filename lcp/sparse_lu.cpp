#include "lcp/sparse_lu.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "lcp/lu_backend.hpp"

namespace perp::lcp {
namespace {

std::unique_ptr<LuLibrary> make(LuBackend backend) {
  switch (backend) {
    case LuBackend::Klu:
      return make_klu();
    case LuBackend::Eigen:
      return make_eigen();
    case LuBackend::Umfpack:
      break;
  }
  return make_umfpack();
}

bool same_pattern(const SpMat& A, const SpMat& B) {
  return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

double norm1(const SpMat& A) {
  double worst = 0;
  for (Index j = 0; j < A.cols(); ++j) worst = std::max(worst, A.col(j).cwiseAbs().sum());
  return worst;
}

}  // namespace

std::string_view to_string(LuBackend backend) {
  switch (backend) {
    case LuBackend::Umfpack:
      return "umfpack";
    case LuBackend::Klu:
      return "klu";
    case LuBackend::Eigen:
      return "eigen";
  }
  return "?";
}

std::string_view to_string(LuStatus status) {
  switch (status) {
    case LuStatus::Ok:
      return "ok";
    case LuStatus::Singular:
      return "singular";
    case LuStatus::NotFinite:
      return "not finite";
    case LuStatus::OutOfMemory:
      return "out of memory";
  }
  return "?";
}

struct SparseLu::Impl {
  explicit Impl(LuBackend backend) : library(make(backend)) {}
  std::unique_ptr<LuLibrary> library;
  SpMat A;
  bool analyzed = false;
  int analyses = 0;
  LuStatus status = LuStatus::Singular;

  void require_factors() const {
    if (status != LuStatus::Ok) throw std::logic_error("SparseLu: solve without a successful factor()");
  }
};

SparseLu::SparseLu(LuBackend backend) : impl_(std::make_unique<Impl>(backend)) {}
SparseLu::~SparseLu() = default;
SparseLu::SparseLu(SparseLu&&) noexcept = default;
SparseLu& SparseLu::operator=(SparseLu&&) noexcept = default;

Index SparseLu::size() const { return impl_->A.rows(); }
int SparseLu::analyses() const { return impl_->analyses; }

LuStatus SparseLu::factor(const SpMat& A) {
  if (A.rows() != A.cols()) {
    std::ostringstream what;
    what << "SparseLu: the matrix is " << A.rows() << " x " << A.cols() << ", not square";
    throw std::invalid_argument(what.str());
  }
  Impl& s = *impl_;
  if (!A.isCompressed()) {
    SpMat compressed = A;
    compressed.makeCompressed();
    return factor(compressed);
  }
  s.status = LuStatus::NotFinite;
  const double* values = A.valuePtr();
  if (!std::all_of(values, values + A.nonZeros(), [](double v) { return std::isfinite(v); })) return s.status;
  const bool known = s.analyzed && same_pattern(A, s.A);
  s.A = A;
  if (A.rows() == 0) return s.status = LuStatus::Ok;
  if (!known) {
    s.status = s.library->analyze(A);
    s.analyzed = s.status == LuStatus::Ok;
    ++s.analyses;
    if (!s.analyzed) return s.status;
  }
  return s.status = s.library->factor(A);
}

void SparseLu::solve(In b, Out x) const {
  impl_->require_factors();
  if (size() > 0) impl_->library->solve(impl_->A, b, x, false);
}

void SparseLu::solve_transposed(In b, Out x) const {
  impl_->require_factors();
  if (size() > 0) impl_->library->solve(impl_->A, b, x, true);
}

void SparseLu::solve_refined(In b, Out x, int steps) const {
  solve(b, x);
  Vec r = b - impl_->A * x;
  double norm = r.lpNorm<::Eigen::Infinity>();
  Vec dx(b.size());
  for (int k = 0; k < steps && norm > 0; ++k) {
    solve(r, dx);
    const Vec better = x + dx;
    const Vec r_better = b - impl_->A * better;
    const double norm_better = r_better.lpNorm<::Eigen::Infinity>();
    if (!(norm_better < norm)) return;
    x = better;
    r = r_better;
    norm = norm_better;
  }
}

double SparseLu::rcond() const {
  if (impl_->status != LuStatus::Ok) return 0;
  const Index n = size();
  if (n == 0) return 1;
  // Higham 1988, algorithm 4.1: maximise ||A^-1 v||_1 over the unit ball by its vertices e_j.
  Vec v = Vec::Constant(n, 1.0 / static_cast<double>(n));
  Vec y(n);
  Vec z(n);
  solve(v, y);
  double estimate = y.lpNorm<1>();
  Vec signs = y.unaryExpr([](double a) { return a < 0 ? -1.0 : 1.0; });
  solve_transposed(signs, z);
  for (int k = 0; k < 4; ++k) {
    Index j = 0;
    const double largest = z.cwiseAbs().maxCoeff(&j);
    if (k > 0 && !(largest > z.dot(v))) break;
    v = Vec::Unit(n, j);
    solve(v, y);
    const double previous = estimate;
    estimate = std::max(previous, y.lpNorm<1>());
    const Vec new_signs = y.unaryExpr([](double a) { return a < 0 ? -1.0 : 1.0; });
    if (new_signs == signs || !(estimate > previous)) break;
    signs = new_signs;
    solve_transposed(signs, z);
  }
  // The alternating vector guards against the estimate's known worst cases.
  for (Index i = 0; i < n; ++i)
    v[i] = (i % 2 ? -1.0 : 1.0) * (1.0 + static_cast<double>(i) / static_cast<double>(std::max<Index>(n - 1, 1)));
  solve(v, y);
  estimate = std::max(estimate, 2 * y.lpNorm<1>() / (3 * static_cast<double>(n)));
  const double condition = norm1(impl_->A) * estimate;
  return std::isfinite(condition) && condition > 0 ? std::min(1.0, 1 / condition) : 0;
}

}  // namespace perp::lcp
