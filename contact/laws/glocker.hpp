// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Glocker's law of friction as a differentiable MCP (Glocker 1999; Acary & Brogliato 2008, 13.4.3; lecture,
/// (45)-(50)), in the coordinates of contact/model/scaling.hpp (mu = 1). The disk |r_T| <= r_N is the intersection of
/// itself with a triangle around it, whose facets e_1, e_2, e_3 give unique multipliers where r_N = 0 and the disk has
/// no gradient:
///     0 <= r_N _|_ u_N >= 0,   u_T + sum e_i kappa_i + c r_T kappa_D = 0,
///     0 <= kappa_i _|_ sigma_i = r_N - e_i.r_T + eps kappa_i >= 0,   0 <= kappa_D _|_ sigma_D >= 0.
///
/// DiskRow::Original     sigma_D = r_N^2 - |r_T|^2,   c = 2:   Glocker's own. At open contacts (r = 0) the gradient of
///     sigma_D vanishes, and with it kappa_D's row and column of the Jacobian.
/// DiskRow::Normalised   sigma_D = g - |r_T|^2 / g,   c = 2 / g,   g = (r_N + sqrt(r_N^2 + 4 delta^2)) / 2:
///     divided by g, which is r_N for delta = 0; kappa_D here is g times the other, |u_T| / 2 where the contact slips.
///     sigma_D = delta at r = 0, so kappa_D = 0 there, and nothing vanishes. delta -> 0 gives the law exactly.
/// eps > 0 makes kappa unique, which is else free to change by a common constant where r = 0.
///
/// Encoding::A, an MCP: (r_N, r_T1, r_T2, kappa_1..3, kappa_D), r_T free.
/// Encoding::B, an NCP: z = (r_N, s_1, s_2, kappa_3, kappa_D) >= 0, F = (u_N, kappa_1, kappa_2, s_3, sigma_D) with
///     r_T = ((s_2 - s_1) / sqrt 3, 2 r_N - s_1 - s_2),   s_3 = 3 r_N - s_1 - s_2 + eps kappa_3,
///     kappa_1 = kappa_3 + w_2 + w_1 / sqrt 3,   kappa_2 = kappa_3 + w_2 - w_1 / sqrt 3,   w = -u_T - c r_T kappa_D.
/// In 2D the disk is an interval and two facets are exact: (r_N, r_T, kappa_1, kappa_2) and (r_N, s_1, kappa_2),
/// affine. Frictionless contacts have r_N alone. With rolling friction each disk has facets, a row and multipliers of
/// its own, and r_N is common: 13 unknowns in A, 9 in B (docs/contact/rolling.md).
#include <optional>
#include <string>
#include <vector>

#include "contact/model/scaling.hpp"
#include "ncp/problem/fields.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::contact {

enum class Encoding { A, B };
enum class DiskRow { Original, Normalised };

struct GlockerOptions {
  Encoding encoding = Encoding::B;
  DiskRow row = DiskRow::Normalised;
  double delta = 1e-9;  ///< in scaled units; > 0
  double eps = 0;       ///< >= 0
};
void describe(GlockerOptions& options, ncp::Fields& fields);
std::optional<std::string> invalid(const GlockerOptions& options);

class Glocker final : public ncp::Mcp {
 public:
  /// The scaled problem is copied.
  Glocker(Scaled problem, const GlockerOptions& options);

  const ncp::Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return constant_; }
  bool eval(In x, lcp::Out F) const override;
  bool jacobian(In x, SpMat& J) const override;
  bool is_affine() const override { return disks_ == 0; }
  std::string name() const override { return "glocker"; }
  std::string variable_name(Index i) const override;
  std::string equation_name(Index i) const override;

  /// Changes F: for continuations, and for ncp::InteriorPoint::follow.
  void set_smoothing(double delta, double eps);

  const Scaled& problem() const { return problem_; }
  /// Ones; r_T = 0 in encoding A.
  Vec start() const;
  /// Near the impulses r~, with multipliers of the velocities u~ there.
  Vec start_at(In r) const;
  /// r~ = T z.
  Vec impulses(In z) const;
  /// Impulses and velocities of the problem that was scaled: r, and u = W r + q to be computed by who has W.
  Vec recover(In z) const { return problem_.expand(impulses(z)); }

  Index first(Index contact) const { return first_[static_cast<std::size_t>(contact)]; }  ///< its r_N

 private:
  struct Local;
  void local(int size, In z, Local& out) const;
  template <class Add>
  void for_terms(std::size_t a, In x, const Add& add) const;
  std::string label(Index i, bool equation) const;

  Scaled problem_;
  GlockerOptions options_;
  ncp::Box box_;
  std::vector<Index> first_;  // one more than there are contacts
  Index disks_ = 0;
  SpMat T_;                           // r~ = T z
  SpMat L_;                           // F = L u~ + local terms
  SpMat constant_;                    // L W~ T, in a pattern with whole blocks of each contact
  std::vector<Index> block_entries_;  // places of the diagonal blocks in it, column by column
};

}  // namespace perp::contact
