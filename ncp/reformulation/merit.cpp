// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/merit.hpp"

#include <algorithm>
#include <cmath>

namespace perp::ncp {

void assemble(In Da, In Db, const SpMat& J, SpMat& H) {
  SpMat diagonal(J.rows(), J.cols());
  diagonal.reserve(Eigen::VectorXi::Ones(J.cols()));
  for (Index i = 0; i < J.rows(); ++i) diagonal.insert(i, i) = Da[i];
  H = Db.asDiagonal() * J;
  H += diagonal;
  H.makeCompressed();
}

Vec generic(Index n, int k) {
  Vec h(n);
  double fraction = std::fmod(0.7548776662466927 * k, 1);
  for (Index i = 0; i < n; ++i) {
    fraction += 0.6180339887498949;
    if (fraction >= 1) fraction -= 1;
    h[i] = fraction;
  }
  return h;
}

void elements(const CFunction& c, const Box& box, const Point& point, Reformulation& out) {
  const Vec h = (1 + 0.1 * generic(point.x.size()).array()).matrix();
  const Vec Jh = point.J * h;
  reformulate(c, box, point.x, point.F, h, Jh, out);
}

void linearise(const CFunction& c, const Box& box, const Point& point, Linearisation& out, bool with_H) {
  elements(c, box, point, out.at);
  if (with_H) {
    assemble(out.at.Da, out.at.Db, point.J, out.H);
    out.gradient = out.H.transpose() * out.at.Phi;
  } else {
    out.H = SpMat();
    out.gradient = out.at.Da.cwiseProduct(out.at.Phi) + point.J.transpose() * out.at.Db.cwiseProduct(out.at.Phi);
  }
  out.merit = 0.5 * out.at.Phi.squaredNorm();
  Vec terms = out.at.Da.cwiseProduct(out.at.Phi).cwiseAbs();
  for (Index j = 0; j < point.J.cols(); ++j)
    for (SpMat::InnerIterator it(point.J, j); it; ++it)
      terms[j] += std::abs(out.at.Db[it.row()] * it.value() * out.at.Phi[it.row()]);
  out.stationarity = stationarity(out.gradient, terms);
}

double stationarity(const Vec& gradient, const Vec& terms) {
  if (!gradient.allFinite() || !terms.allFinite()) return 1;
  double largest = 0;
  for (Index j = 0; j < gradient.size(); ++j)
    if (terms[j] > 0) largest = std::max(largest, std::abs(gradient[j]) / terms[j]);
  return largest;
}

Vec Linearisation::cauchy_step() const {
  const double curvature = (H * gradient).squaredNorm();
  const double length = curvature > 0 ? gradient.squaredNorm() / curvature : 1;
  return -(std::isfinite(length) ? length : 1) * gradient;
}

const CFunction& fischer_merit() {
  static const CFunction phi = fischer_burmeister();
  return phi;
}

double merit(const CFunction& c, const Box& box, In x, In F) {
  Vec Phi(x.size());
  reformulate(c, box, x, F, Phi);
  return 0.5 * Phi.squaredNorm();
}

}  // namespace perp::ncp
