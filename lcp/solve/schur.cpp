// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/schur.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

void TwoPartSums::add_product(const SpMat& A, In x, double factor) {
  for (Index j = 0; j < A.cols(); ++j) {
    if (x[j] == 0) continue;
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      sum.add_product(it.row(), it.value(), factor * x[j]);
      terms[it.row()] += std::abs(it.value() * x[j]);
    }
  }
}

SchurImage schur_image(const RefinedLu& K, const SpMat& B, const TwoPartSums& b, const TwoPartSums& w) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  constexpr double roundings = 64;
  const Vec nothing = Vec::Constant(w.terms.size(), std::numeric_limits<double>::quiet_NaN());
  if (K.status() != LuStatus::Ok) return {.value = nothing, .doubt = nothing, .terms = nothing};
  const std::optional<TwoPartVector> y = K.refined(b.sum);
  if (!y) return {.value = nothing, .doubt = nothing, .terms = nothing};
  TwoPartVector s = w.sum;
  s.add_transposed_product(B, *y);
  const SpMat size = B.cwiseAbs();
  SchurImage out{.value = s.value + s.rest, .doubt = {}, .terms = size.transpose() * y->value.cwiseAbs() + w.terms};
  out.doubt = size.transpose() * K.doubt(*y, b.terms) + roundings * eps * eps * out.terms;
  return out;
}

SchurProduct::SchurProduct(std::shared_ptr<const RefinedLu> K, SpMat B, double sign, SpMat W_0)
    : K_(std::move(K)), B_(std::move(B)), sign_(sign), W_0_(std::move(W_0)) {
  const Index n = W_0_.rows();
  if (B_.rows() != K_->size() || n != W_0_.cols() || (n > 0 && n != B_.cols()))
    refuse_input("schur: K is ", K_->size(), " x ", K_->size(), ", B ", B_.rows(), " x ", B_.cols(), ", W_0 ", n, " x ",
                 W_0_.cols());
  symmetric_ = K_->symmetric() && lcp::symmetric(W_0_, 0);
}

SchurImage SchurProduct::operator()(In r, In w) const {
  TwoPartSums b(Vec::Zero(K_->size()));
  b.add_product(B_, r, sign_);
  TwoPartSums rest{Vec(w)};
  if (W_0_.rows() > 0) rest.add_product(W_0_, r);
  return schur_image(*K_, B_, b, rest);
}

Vec SchurProduct::offset(In f, In w) const {
  SchurImage image = schur_image(*K_, B_, TwoPartSums(sign_ * f), TwoPartSums(w));
  for (Index i = 0; i < image.value.size(); ++i)
    if (std::abs(image.value[i]) <= K_->rcond() * image.doubt[i]) image.value[i] = 0;
  return image.value;
}

std::optional<SpMat> SchurProduct::matrix(double drop) const {
  std::optional<SpMat> S = K_->schur(B_, W_0_.rows() > 0 ? 0 : drop);
  if (!S) return S;
  *S *= sign_;
  if (W_0_.rows() > 0) *S = SpMat(*S + W_0_);
  if (symmetric_) *S = 0.5 * (*S + SpMat(S->transpose()));
  return S;
}

Schur schur(const SpMat& K, const SpMat& B, In f, double drop) {
  if (K.rows() != K.cols() || B.rows() != K.rows() || f.size() != K.rows())
    refuse_input("schur: K is ", K.rows(), " x ", K.cols(), ", B ", B.rows(), " x ", B.cols(), ", f has ", f.size(),
                 " entries");
  Schur out{.K = std::make_shared<const RefinedLu>(K)};
  if (!out.K->regular()) return out;
  std::optional<TwoPartVector> x = out.K->refined(TwoPartVector(Vec(f)), 1e-14);
  std::optional<SpMat> S;
  if (x) S = out.K->schur(B, drop);
  out.converged = S.has_value();
  if (!S) return out;
  out.x = x->value;
  out.S = std::move(*S);
  return out;
}

}  // namespace perp::lcp
