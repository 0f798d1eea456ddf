#include "contact/glocker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "contact/glocker_law.hpp"

namespace perp::contact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

const double inv_sqrt3 = 1 / std::sqrt(3.0);

int unknowns(Encoding encoding, int size) {
  if (size == 1) return 1;
  if (encoding == Encoding::A) return size == 3 ? 7 : 4;
  return size == 3 ? 5 : 3;
}

using Triplets = std::vector<Eigen::Triplet<double>>;

/// Of one contact, in its rows of r~ (from `r`) and of z (from `z`).
void add_impulses(Encoding encoding, int size, int r, int z, Triplets& T) {
  T.emplace_back(r, z, 1);
  if (size == 1) return;
  if (encoding == Encoding::A) {
    for (int k = 1; k < size; ++k) T.emplace_back(r + k, z + k, 1);
  } else if (size == 2) {  // r_T = r_N - s_1
    T.emplace_back(r + 1, z, 1);
    T.emplace_back(r + 1, z + 1, -1);
  } else {
    T.emplace_back(r + 1, z + 1, -inv_sqrt3);
    T.emplace_back(r + 1, z + 2, inv_sqrt3);
    T.emplace_back(r + 2, z, 2);
    T.emplace_back(r + 2, z + 1, -1);
    T.emplace_back(r + 2, z + 2, -1);
  }
}

void add_velocities(Encoding encoding, int size, int r, int z, Triplets& L) {
  L.emplace_back(z, r, 1);
  if (size == 1) return;
  if (encoding == Encoding::A) {
    for (int k = 1; k < size; ++k) L.emplace_back(z + k, r + k, 1);
  } else if (size == 2) {  // kappa_1 = kappa_2 - u_T
    L.emplace_back(z + 1, r + 1, -1);
  } else {
    L.emplace_back(z + 1, r + 1, -inv_sqrt3);
    L.emplace_back(z + 1, r + 2, -1);
    L.emplace_back(z + 2, r + 1, inv_sqrt3);
    L.emplace_back(z + 2, r + 2, -1);
  }
}

/// sigma_D with its derivatives, and c with its derivative by r_N.
struct Disk {
  double sigma, sigma_N, sigma_T1, sigma_T2;
  double c, c_N;
};

Disk disk(DiskRow row, double delta, double N, double T1, double T2) {
  const double T = T1 * T1 + T2 * T2;
  if (row == DiskRow::Original)
    return {.sigma = N * N - T, .sigma_N = 2 * N, .sigma_T1 = -2 * T1, .sigma_T2 = -2 * T2, .c = 2, .c_N = 0};
  const auto [g, slope] = smooth_normal(N, delta);
  return {.sigma = g - T / g,
          .sigma_N = slope * (1 + T / (g * g)),
          .sigma_T1 = -2 * T1 / g,
          .sigma_T2 = -2 * T2 / g,
          .c = 2 / g,
          .c_N = -2 * slope / (g * g)};
}

}  // namespace

/// The terms of one contact that are not L u~, with their derivatives.
struct Glocker::Local {
  Eigen::Matrix<double, 7, 1> F;
  Eigen::Matrix<double, 7, 7> J;
};

std::optional<std::string> invalid(const GlockerOptions& options) {
  std::ostringstream why;
  if (!(options.delta > 0) && options.row == DiskRow::Normalised)
    why << "delta is " << options.delta << "; it must be positive";
  else if (!(options.eps >= 0) || std::isinf(options.eps))
    why << "eps is " << options.eps << "; it must be at least 0 and finite";
  else
    return std::nullopt;
  return why.str();
}

Glocker::Glocker(Scaled problem, const GlockerOptions& options) : problem_(std::move(problem)), options_(options) {
  if (const auto why = invalid(options)) throw std::invalid_argument("Glocker: " + *why);
  Index n = 0;
  Triplets T;
  Triplets L;
  Triplets blocks;
  for (const Scaled::Block& block : problem_.blocks) {
    first_.push_back(n);
    const int m = unknowns(options.encoding, block.size);
    const auto r = static_cast<int>(block.first);
    const auto z = static_cast<int>(n);
    add_impulses(options.encoding, block.size, r, z, T);
    add_velocities(options.encoding, block.size, r, z, L);
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) blocks.emplace_back(z + i, z + j, 0.0);
    if (block.size == 3) ++disks_;
    n += m;
  }
  first_.push_back(n);
  T_ = SpMat(problem_.size(), n);
  T_.setFromTriplets(T.begin(), T.end());
  L_ = SpMat(n, problem_.size());
  L_.setFromTriplets(L.begin(), L.end());
  SpMat whole(n, n);
  whole.setFromTriplets(blocks.begin(), blocks.end());
  const SpMat WT = problem_.W * T_;
  constant_ = SpMat(L_ * WT) + whole;
  constant_.makeCompressed();

  box_ = ncp::Box::nonnegative(n);
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a) {
    const int size = problem_.blocks[a].size;
    if (options.encoding == Encoding::A)
      for (Index k = 1; k < size; ++k) box_.lower[first_[a] + k] = -ncp::infinity;
    for (Index j = first_[a]; j < first_[a + 1]; ++j) {
      const int* begin = constant_.innerIndexPtr() + constant_.outerIndexPtr()[j];
      const int* end = constant_.innerIndexPtr() + constant_.outerIndexPtr()[j + 1];
      const Index place = std::lower_bound(begin, end, static_cast<int>(first_[a])) - constant_.innerIndexPtr();
      block_entries_.push_back(place);
    }
  }
}

void Glocker::set_smoothing(double delta, double eps) {
  GlockerOptions options = options_;
  options.delta = delta;
  options.eps = eps;
  if (const auto why = invalid(options)) throw std::invalid_argument("Glocker: " + *why);
  options_ = options;
}

/// `z` are the contact's own unknowns.
void Glocker::local(const Scaled::Block& block, In z, Local& out) const {
  out.F.setZero();
  out.J.setZero();
  const double eps = options_.eps;
  if (block.size == 1) return;
  if (options_.encoding == Encoding::A) {
    const int d = block.size;
    for (int f = 0; f < d; ++f) {  // d facets
      const auto& e = facet_normal(d, at(f));
      const int k = d + f;
      out.F[k] = z[0] + eps * z[k];
      out.J(k, 0) = 1;
      out.J(k, k) = eps;
      for (int i = 1; i < d; ++i) {
        const double e_i = e[at(i - 1)];
        out.F[k] -= e_i * z[i];
        out.J(k, i) = -e_i;
        out.F[i] += e_i * z[k];
        out.J(i, k) = e_i;
      }
    }
    if (d == 2) return;
    const Disk D = disk(options_.row, options_.delta, z[0], z[1], z[2]);
    out.F[6] = D.sigma;
    out.J(6, 0) = D.sigma_N;
    out.J(6, 1) = D.sigma_T1;
    out.J(6, 2) = D.sigma_T2;
    for (int i = 1; i < 3; ++i) {
      out.F[i] += D.c * z[i] * z[6];
      out.J(i, 0) = D.c_N * z[i] * z[6];
      out.J(i, i) = D.c * z[6];
      out.J(i, 6) = D.c * z[i];
    }
    return;
  }
  if (block.size == 2) {  // kappa_1 = kappa_2 - u_T,  s_2 = 2 r_N - s_1 + eps kappa_2
    out.F[1] = z[2];
    out.J(1, 2) = 1;
    out.F[2] = 2 * z[0] - z[1] + eps * z[2];
    out.J.row(2).head(3) << 2, -1, eps;
    return;
  }
  const double T1 = (z[2] - z[1]) * inv_sqrt3;
  const double T2 = 2 * z[0] - z[1] - z[2];
  const Disk D = disk(options_.row, options_.delta, z[0], T1, T2);
  using Row = Eigen::Matrix<double, 1, 5>;
  Row dN, dT1, dT2, dD;
  dN << 1, 0, 0, 0, 0;
  dT1 << 0, -inv_sqrt3, inv_sqrt3, 0, 0;
  dT2 << 2, -1, -1, 0, 0;
  dD << 0, 0, 0, 0, 1;
  // What kappa_D contributes to w = -u_T - c r_T kappa_D.
  const double w1 = -D.c * T1 * z[4];
  const double w2 = -D.c * T2 * z[4];
  const Row dw1 = -D.c * (dT1 * z[4] + T1 * dD) - D.c_N * T1 * z[4] * dN;
  const Row dw2 = -D.c * (dT2 * z[4] + T2 * dD) - D.c_N * T2 * z[4] * dN;
  out.F[1] = z[3] + w2 + w1 * inv_sqrt3;
  out.F[2] = z[3] + w2 - w1 * inv_sqrt3;
  out.J.row(1).head(5) = dw2 + dw1 * inv_sqrt3;
  out.J.row(2).head(5) = dw2 - dw1 * inv_sqrt3;
  out.J(1, 3) += 1;
  out.J(2, 3) += 1;
  out.F[3] = 3 * z[0] - z[1] - z[2] + eps * z[3];
  out.J.row(3).head(4) << 3, -1, -1, eps;
  out.F[4] = D.sigma;
  out.J.row(4).head(5) = D.sigma_N * dN + D.sigma_T1 * dT1 + D.sigma_T2 * dT2;
}

bool Glocker::eval(In x, lcp::Out F) const {
  const Vec r = T_ * x;
  const Vec u = problem_.W * r + problem_.q;
  F = L_ * u;
  Local part;
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a) {
    const Index m = first_[a + 1] - first_[a];
    local(problem_.blocks[a], x.segment(first_[a], m), part);
    F.segment(first_[a], m) += part.F.head(m);
  }
  return F.allFinite();
}

bool Glocker::jacobian(In x, SpMat& J) const {
  std::copy(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), J.valuePtr());
  Local part;
  std::size_t k = 0;
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a) {
    const Index m = first_[a + 1] - first_[a];
    local(problem_.blocks[a], x.segment(first_[a], m), part);
    for (Index j = 0; j < m; ++j, ++k)
      for (Index i = 0; i < m; ++i) J.valuePtr()[block_entries_[k] + i] += part.J(i, j);
  }
  return true;
}

Vec Glocker::start() const {
  Vec z = Vec::Ones(box_.size());
  for (Index i = 0; i < z.size(); ++i)
    if (box_.lower[i] != 0) z[i] = 0;
  return z;
}

Vec Glocker::impulses(In z) const { return T_ * z; }

Vec Glocker::start_at(In r) const {
  const Vec u = problem_.W * r + problem_.q;
  Vec z = Vec::Zero(box_.size());
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Index i = first_[a];
    const double N = std::max(0.0, r[block.first]);
    z[i] = N;
    if (block.size == 1) continue;
    const double T1 = r[block.first + 1];
    const double u1 = u[block.first + 1];
    if (block.size == 2) {
      const double kappa_2 = std::max(0.0, u1);  // kappa_1 - kappa_2 = -u_T
      if (options_.encoding == Encoding::A)
        z.segment(i + 1, 3) << T1, std::max(0.0, -u1), kappa_2;
      else
        z.segment(i + 1, 2) << std::max(0.0, N - T1), kappa_2;
      continue;
    }
    const double T2 = r[block.first + 2];
    const double u2 = u[block.first + 2];
    // Loaded contacts: the disk carries the slip. Others: the triangle does, -u_T = sum e_i kappa_i.
    const double speed = std::hypot(u1, u2);
    const bool loaded = N > 1e-6;
    const double kappa_D = !loaded ? 0 : options_.row == DiskRow::Normalised ? speed / 2 : speed / (2 * N);
    const double w1 = loaded ? 0 : -u1;
    const double w2 = loaded ? 0 : -u2;
    const double kappa_3 = std::max(0.0, -std::min(w2 + w1 * inv_sqrt3, w2 - w1 * inv_sqrt3));
    if (options_.encoding == Encoding::A) {
      z.segment(i + 1, 6) << T1, T2, kappa_3 + w2 + w1 * inv_sqrt3, kappa_3 + w2 - w1 * inv_sqrt3, kappa_3, kappa_D;
    } else {
      const auto slack = [&](std::size_t f) {
        const auto& e = facet_normal(3, f);
        return std::max(0.0, N - e[0] * T1 - e[1] * T2);
      };
      z.segment(i + 1, 4) << slack(0), slack(1), kappa_3, kappa_D;
    }
  }
  return z;
}

std::string Glocker::label(Index i, bool equation) const {
  const auto a = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), i) - first_.begin() - 1);
  static constexpr std::array<const char*, 7> A3{"r_N", "r_T1", "r_T2", "kappa_1", "kappa_2", "kappa_3", "kappa_D"};
  static constexpr std::array<const char*, 7> A3_rows{"u_N",     "u_T1",    "u_T2",   "sigma_1",
                                                      "sigma_2", "sigma_3", "sigma_D"};
  static constexpr std::array<const char*, 4> A2{"r_N", "r_T", "kappa_1", "kappa_2"};
  static constexpr std::array<const char*, 4> A2_rows{"u_N", "u_T", "sigma_1", "sigma_2"};
  static constexpr std::array<const char*, 5> B3{"r_N", "s_1", "s_2", "kappa_3", "kappa_D"};
  static constexpr std::array<const char*, 5> B3_rows{"u_N", "kappa_1", "kappa_2", "s_3", "sigma_D"};
  static constexpr std::array<const char*, 3> B2{"r_N", "s_1", "kappa_2"};
  static constexpr std::array<const char*, 3> B2_rows{"u_N", "kappa_1", "s_2"};
  const std::size_t k = at(i - first_[a]);
  const bool three = problem_.blocks[a].size == 3;
  const char* what = nullptr;
  if (options_.encoding == Encoding::A)
    what = three ? (equation ? A3_rows : A3)[k] : (equation ? A2_rows : A2)[k];
  else
    what = three ? (equation ? B3_rows : B3)[k] : (equation ? B2_rows : B2)[k];
  return std::string(what) + "[" + std::to_string(a + 1) + "]";
}

std::string Glocker::variable_name(Index i) const { return label(i, false); }
std::string Glocker::equation_name(Index i) const { return label(i, true); }

}  // namespace perp::contact
