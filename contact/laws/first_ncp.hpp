// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The first NCP for Coulomb friction, by norms (Acary's lecture 3, (42)-(44)), for comparison with Glocker's. Contact
/// by contact, u = W r + q,
///     u_N >= 0  _|_  r_N >= 0
///     kappa r_T + mu r_N u_T = 0                   (r_T free)
///     sigma = mu r_N - |r_T| >= 0  _|_  kappa >= 0,
/// four unknowns (r_N, r_T, kappa); kappa = |u_T| where the contact slips.
///
/// (44) prints |P_N| for mu r_N, without mu, which makes kappa = |u_T| / mu. The system is equivalent to Coulomb's law:
/// r_N > 0 and |r_T| < mu r_N give kappa = 0 and u_T = 0; r_N > 0 and |r_T| = mu r_N give kappa = |u_T| and r_T opposed
/// to u_T; r_N = 0 gives r_T = 0.
///
/// |r_T| has no derivative at r_T = 0, where every method may start; the Jacobian there has 0, an element of Clarke's
/// subdifferential, in its place (an edge of the cone is not seen from its axis). At an open contact both rows of r_T
/// and their columns vanish for kappa = 0: singular, as Glocker's disk row is. Works in the units of
/// contact/model/units.hpp unless told otherwise; a contact with mu = 0 has the unknown r_N alone.
#include <string>
#include <vector>

#include "contact/model/problem.hpp"
#include "contact/model/units.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::contact {

class FirstNcp : public ncp::Mcp {
 public:
  /// Copies what it needs. Throws std::invalid_argument if the problem is malformed (check()).
  explicit FirstNcp(const Problem& problem, bool scale = true);

  const ncp::Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  bool eval(In x, lcp::Out F) const override;
  bool jacobian(In x, SpMat& J) const override;
  std::vector<bool> linear_entries() const override;
  std::string name() const override { return name_; }
  std::string variable_name(Index i) const override;
  std::string equation_name(Index i) const override;

  /// r_N = 1, r_T = 0, kappa = 1 (in the units of contact/model/units.hpp): the start that comparisons use.
  Vec start() const;
  /// Throws std::invalid_argument if x has not size() entries.
  Solution recover(In x) const;

 private:
  bool frictional(Index a) const { return mu_[a] > 0; }
  Index kappa(Index a) const { return first_[static_cast<std::size_t>(a)] + dimension_; }
  /// r~ from x.
  Vec impulses(In x) const;
  std::string label(Index i, const char* normal, const char* tangential, const char* last) const;

  int dimension_;
  SpMat W_;  // in the units of the unknowns
  Vec q_;
  Vec mu_;
  Units units_;
  std::string name_;
  std::vector<Index> first_;    // unknown r_N of each contact; those of r_T and kappa follow
  std::vector<Index> unknown_;  // of each component of r; -1: r_T of a contact without friction
  ncp::Box box_;
  SpMat pattern_;
};

}  // namespace perp::contact
