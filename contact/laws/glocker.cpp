// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/glocker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "contact/laws/glocker_law.hpp"

namespace perp::contact {
namespace {

const double inv_sqrt3 = 1 / std::sqrt(3.0);

/// Encoding B: with E = (e_1, ..)' of the facets but the last, whose sum is -e_d,
///     r_T = E^-1 (r_N 1 - s),   kappa_i = kappa_d + (E^-T w)_i,   w = -u_T - c r_T kappa_D.
struct Slacks {
  Eigen::Matrix3d impulse;     // r = impulse (r_N, s)
  Eigen::Matrix2d multiplier;  // E^-T
};
const Slacks& slacks(int size) {
  static const Slacks plane{.impulse = (Eigen::Matrix3d() << 1, 0, 0, 1, -1, 0, 0, 0, 0).finished(),
                            .multiplier = (Eigen::Matrix2d() << 1, 0, 0, 0).finished()};
  static const Slacks space{.impulse = (Eigen::Matrix3d() << 1, 0, 0, 0, -inv_sqrt3, inv_sqrt3, 2, -1, -1).finished(),
                            .multiplier = (Eigen::Matrix2d() << inv_sqrt3, 1, -inv_sqrt3, 1).finished()};
  return size == 3 ? space : plane;
}

int unknowns(Encoding encoding, int size) {
  if (size == 1) return 1;
  if (encoding == Encoding::A) return size == 3 ? 7 : 4;
  return size == 3 ? 5 : 3;
}

using Triplets = std::vector<Eigen::Triplet<double>>;

/// One disk of a contact, which is a contact of `size` entries by itself: its places among the contact's entries and
/// unknowns, of which r_N is common.
struct DiskPlaces {
  int size;
  int unknowns;
  std::array<int, 3> entry{};
  std::array<int, 7> unknown{};
};

int unknowns(Encoding encoding, const Scaled::Block& block) {
  return 1 + block.disk_count() * (unknowns(encoding, block.entries() + 1) - 1);
}

DiskPlaces places_of(Encoding encoding, const Scaled::Block& block, int disk) {
  const int size = block.entries() + 1;
  DiskPlaces out{.size = size, .unknowns = unknowns(encoding, size)};
  for (int i = 1; i < size; ++i) out.entry[at(i)] = block.first_of(disk) + i - 1;
  const bool impulses = encoding == Encoding::A;  // those of all disks come first
  const int own = out.unknowns - (impulses ? size : 1);
  for (int k = 1; k < out.unknowns; ++k)
    out.unknown[at(k)] = impulses && k < size ? out.entry[at(k)]
                         : impulses           ? block.size + disk * own + k - size
                                              : 1 + disk * own + k - 1;
  return out;
}

/// r~ = T z and F = L u~ + .. of one contact, in its rows of r~ (from `r`) and of z (from `z`).
void add_contact(Encoding encoding, const Scaled::Block& block, int r, int z, Triplets& T, Triplets& L) {
  T.emplace_back(r, z, 1);
  L.emplace_back(z, r, 1);
  for (int d = 0; d < block.disk_count(); ++d) {
    const DiskPlaces of = places_of(encoding, block, d);
    const auto row = [&](int i) { return r + of.entry[at(i)]; };
    const auto place = [&](int i) { return z + of.unknown[at(i)]; };
    for (int i = 1; i < of.size; ++i) {
      if (encoding == Encoding::A) {
        T.emplace_back(row(i), place(i), 1);
        L.emplace_back(place(i), row(i), 1);
        continue;
      }
      for (int j = 0; j < of.size; ++j)
        if (const double entry = slacks(of.size).impulse(i, j); entry != 0) T.emplace_back(row(i), place(j), entry);
      for (int j = 1; j < of.size; ++j) L.emplace_back(place(i), row(j), -slacks(of.size).multiplier(i - 1, j - 1));
    }
  }
}

using Disk = GlockerDisk;

/// (50): sigma_D = r_N^2 - |r_T|^2, c = 2.
Disk original_disk(double N, double T1, double T2) {
  const double T = T1 * T1 + T2 * T2;
  return {.sigma = N * N - T, .sigma_N = 2 * N, .sigma_T1 = -2 * T1, .sigma_T2 = -2 * T2, .c = 2, .c_N = 0};
}

Disk disk_at(const GlockerOptions& law, double N, double T1, double T2) {
  return law.row == DiskRow::Original ? original_disk(N, T1, T2) : normalised_disk(law.delta, N, T1, T2);
}

}  // namespace

/// The terms of one disk that are not L u~, with their derivatives. z are its own unknowns (DiskPlaces).
struct Glocker::Local {
  Eigen::Matrix<double, 7, 1> F;
  Eigen::Matrix<double, 7, 7> J;

  void facets(int size, double eps, In z);
  void disk(const Disk& disk, In z);
  void interval_slacks(double eps, In z);
  void triangle_slacks(const GlockerOptions& law, In z);
};

/// Encoding A, (45) and (49): sigma_i = r_N - e_i.r_T + eps kappa_i, and e_i kappa_i in the rows of u_T.
void Glocker::Local::facets(int size, double eps, In z) {
  for (int f = 0; f < size; ++f) {
    const auto& e = facet_normal(size, at(f));
    const int k = size + f;
    F[k] = z[0] + eps * z[k];
    J(k, 0) = 1;
    J(k, k) = eps;
    for (int i = 1; i < size; ++i) {
      const double e_i = e[at(i - 1)];
      F[k] -= e_i * z[i];
      J(k, i) = -e_i;
      F[i] += e_i * z[k];
      J(i, k) = e_i;
    }
  }
}

/// Encoding A, (49) and (50): sigma_D, and c r_T kappa_D in the rows of u_T.
void Glocker::Local::disk(const Disk& disk, In z) {
  const double kappa_D = z[6];
  F[6] = disk.sigma;
  J.row(6).head(3) << disk.sigma_N, disk.sigma_T1, disk.sigma_T2;
  for (int i = 1; i < 3; ++i) {
    F[i] += disk.c * z[i] * kappa_D;
    J(i, 0) = disk.c_N * z[i] * kappa_D;
    J(i, i) = disk.c * kappa_D;
    J(i, 6) = disk.c * z[i];
  }
}

/// Encoding B in 2D: kappa_1 = kappa_2 - u_T, s_2 = 2 r_N - s_1 + eps kappa_2.
void Glocker::Local::interval_slacks(double eps, In z) {
  F[1] = z[2];
  J(1, 2) = 1;
  F[2] = 2 * z[0] - z[1] + eps * z[2];
  J.row(2).head(3) << 2, -1, eps;
}

/// Encoding B in 3D: kappa_1, kappa_2, s_3 = 3 r_N - s_1 - s_2 + eps kappa_3, sigma_D.
void Glocker::Local::triangle_slacks(const GlockerOptions& law, In z) {
  using Row = Eigen::Matrix<double, 1, 5>;
  const Row dN(1, 0, 0, 0, 0), dD(0, 0, 0, 0, 1);
  const Row dT1(0, -inv_sqrt3, inv_sqrt3, 0, 0), dT2(2, -1, -1, 0, 0);
  const double T1 = (z[2] - z[1]) * inv_sqrt3;
  const double T2 = 2 * z[0] - z[1] - z[2];
  const double kappa_D = z[4];
  const Disk D = disk_at(law, z[0], T1, T2);
  // What kappa_D contributes to w = -u_T - c r_T kappa_D.
  const double w1 = -D.c * T1 * kappa_D;
  const double w2 = -D.c * T2 * kappa_D;
  const Row dw1 = -D.c * (dT1 * kappa_D + T1 * dD) - D.c_N * T1 * kappa_D * dN;
  const Row dw2 = -D.c * (dT2 * kappa_D + T2 * dD) - D.c_N * T2 * kappa_D * dN;
  F[1] = z[3] + w2 + w1 * inv_sqrt3;
  F[2] = z[3] + w2 - w1 * inv_sqrt3;
  F[3] = 3 * z[0] - z[1] - z[2] + law.eps * z[3];
  F[4] = D.sigma;
  J.row(1).head(5) = dw2 + dw1 * inv_sqrt3;
  J.row(2).head(5) = dw2 - dw1 * inv_sqrt3;
  J(1, 3) += 1;
  J(2, 3) += 1;
  J.row(3).head(4) << 3, -1, -1, law.eps;
  J.row(4).head(5) = D.sigma_N * dN + D.sigma_T1 * dT1 + D.sigma_T2 * dT2;
}

void describe(GlockerOptions& options, ncp::Fields& f) {
  f.add("delta", &options.delta, ncp::above(0), "of the normalised disk row");
  f.add("eps", &options.eps, ncp::at_least(0), "regularises the facets' equations");
}

std::optional<std::string> invalid(const GlockerOptions& given) {
  GlockerOptions options = given;
  ncp::Fields fields;
  describe(options, fields);
  return fields.invalid();
}

Glocker::Glocker(Scaled problem, const GlockerOptions& options) : problem_(std::move(problem)), options_(options) {
  if (const auto why = invalid(options)) throw std::invalid_argument("Glocker: " + *why);
  Index n = 0;
  Triplets T;
  Triplets L;
  Triplets blocks;
  for (const Scaled::Block& block : problem_.blocks) {
    first_.push_back(n);
    const int m = unknowns(options.encoding, block);
    const auto r = static_cast<int>(block.first);
    const auto z = static_cast<int>(n);
    add_contact(options.encoding, block, r, z, T, L);
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) blocks.emplace_back(z + i, z + j, 0.0);
    if (block.entries() == 2) disks_ += block.disk_count();
    n += m;
  }
  first_.push_back(n);
  T_ = SpMat(problem_.size(), n);
  T_.setFromTriplets(T.begin(), T.end());
  L_ = SpMat(n, problem_.size());
  L_.setFromTriplets(L.begin(), L.end());
  SpMat whole(n, n);
  whole.setFromTriplets(blocks.begin(), blocks.end());
  const SpMat WT = problem_.W.matrix() * T_;
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

void Glocker::local(int size, In z, Local& out) const {
  out.F.setZero();
  out.J.setZero();
  if (options_.encoding == Encoding::A) {
    out.facets(size, options_.eps, z);
    if (size == 3) out.disk(disk_at(options_, z[0], z[1], z[2]), z);
  } else if (size == 2) {
    out.interval_slacks(options_.eps, z);
  } else {
    out.triangle_slacks(options_, z);
  }
}

/// add(places, terms) of each disk of the contact at x.
template <class Add>
void Glocker::for_terms(std::size_t a, In x, const Add& add) const {
  Local part;
  for (int d = 0; d < problem_.blocks[a].disk_count(); ++d) {
    const DiskPlaces of = places_of(options_.encoding, problem_.blocks[a], d);
    Eigen::Matrix<double, 7, 1> z = Eigen::Matrix<double, 7, 1>::Zero();
    for (int k = 0; k < of.unknowns; ++k) z[k] = x[first_[a] + of.unknown[at(k)]];
    local(of.size, z, part);
    add(of, part);
  }
}

bool Glocker::eval(In x, lcp::Out F) const {
  const Vec r = T_ * x;
  const Vec u = problem_.W * r + problem_.q;
  F = L_ * u;
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a)
    for_terms(a, x, [&](const DiskPlaces& of, const Local& part) {
      for (int k = 0; k < of.unknowns; ++k) F[first_[a] + of.unknown[at(k)]] += part.F[k];
    });
  return F.allFinite();
}

bool Glocker::jacobian(In x, SpMat& J) const {
  std::copy(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), J.valuePtr());
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a)
    for_terms(a, x, [&](const DiskPlaces& of, const Local& part) {
      for (int j = 0; j < of.unknowns; ++j) {
        const Index column = block_entries_[at(first_[a] + of.unknown[at(j)])];
        for (int i = 0; i < of.unknowns; ++i) J.valuePtr()[column + of.unknown[at(i)]] += part.J(i, j);
      }
    });
  return true;
}

Vec Glocker::start() const {
  Vec z = Vec::Ones(box_.size());
  for (Index i = 0; i < z.size(); ++i)
    if (box_.lower[i] != 0) z[i] = 0;
  return z;
}

Vec Glocker::impulses(In z) const { return T_ * z; }

/// Loaded contacts: the disk carries the slip. Others: the facets do, -u_T = sum e_i kappa_i.
Vec Glocker::start_at(In r) const {
  constexpr double loaded = 1e-6;
  const Vec u = problem_.W * r + problem_.q;
  Vec z = Vec::Zero(box_.size());
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const double r_N = z[first_[a]] = std::max(0.0, r[block.first]);
    for (int d = 0; d < block.disk_count(); ++d) {
      const DiskPlaces of = places_of(options_.encoding, block, d);
      const int size = of.size;
      const auto own = [&](int k) -> double& { return z[first_[a] + of.unknown[at(k)]]; };
      const Vec r_T = r.segment(block.first + block.first_of(d), size - 1);
      const Vec u_T = u.segment(block.first + block.first_of(d), size - 1);
      const bool slides = size == 3 && r_N > loaded;
      const bool normalised = options_.row == DiskRow::Normalised;
      const double kappa_D = !slides ? 0 : u_T.norm() / (normalised ? 2 : 2 * r_N);
      Vec more = Vec::Zero(size - 1);  // of kappa than of the last facet
      if (!slides) more = -slacks(size).multiplier.topLeftCorner(size - 1, size - 1) * u_T;
      const double last = std::max(0.0, -more.minCoeff());
      for (int i = 1; i < size; ++i) {
        if (options_.encoding == Encoding::A) {
          own(i) = r_T[i - 1];
          own(size + i - 1) = more[i - 1] + last;
          continue;
        }
        const auto& e = facet_normal(size, at(i - 1));
        own(i) = std::max(0.0, r_N - e[0] * r_T[0] - (size == 3 ? e[1] * r_T[1] : 0));
      }
      own(options_.encoding == Encoding::A ? 2 * size - 1 : size) = last;
      if (size == 3) own(of.unknowns - 1) = kappa_D;
    }
  }
  return z;
}

/// Names of a disk's unknowns, or rows, in the order of these words; R beside those of a second disk.
std::string Glocker::label(Index i, bool equation) const {
  using Names = std::array<const char*, 7>;
  static constexpr std::array<std::array<Names, 2>, 4> names{{
      {{{"r_N", "r_T", "kappa_1", "kappa_2"}, {"u_N", "u_T", "sigma_1", "sigma_2"}}},
      {{{"r_N", "r_T1", "r_T2", "kappa_1", "kappa_2", "kappa_3", "kappa_D"},
        {"u_N", "u_T1", "u_T2", "sigma_1", "sigma_2", "sigma_3", "sigma_D"}}},
      {{{"r_N", "s_1", "kappa_2"}, {"u_N", "kappa_1", "s_2"}}},
      {{{"r_N", "s_1", "s_2", "kappa_3", "kappa_D"}, {"u_N", "kappa_1", "kappa_2", "s_3", "sigma_D"}}},
  }};
  const auto a = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), i) - first_.begin() - 1);
  const Scaled::Block& block = problem_.blocks[a];
  const std::string contact = "[" + std::to_string(a + 1) + "]";
  for (int d = 0; d < block.disk_count(); ++d) {
    const DiskPlaces of = places_of(options_.encoding, block, d);
    const auto k = std::find(of.unknown.begin(), of.unknown.begin() + of.unknowns, static_cast<int>(i - first_[a]));
    if (k == of.unknown.begin() + of.unknowns) continue;
    const std::size_t form = (options_.encoding == Encoding::B ? 2 : 0) + (of.size == 3 ? 1 : 0);
    return names[form][equation ? 1 : 0][static_cast<std::size_t>(k - of.unknown.begin())] +
           std::string(d == 1 ? "^R" : "") + contact;
  }
  return (equation ? "u_N" : "r_N") + contact;
}

std::string Glocker::variable_name(Index i) const { return label(i, false); }
std::string Glocker::equation_name(Index i) const { return label(i, true); }

}  // namespace perp::contact
