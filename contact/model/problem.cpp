// SPDX-License-Identifier: Apache-2.0
#include "contact/model/problem.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "contact/model/checks.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  refuse_input("contact problem: ", parts...);
}

/// "contact 3, component T1 (entry 10)": where entry i of a vector over the contacts stands.
std::string place(Index i, const Problem& p) {
  static constexpr const char* of_disks[] = {"T1", "T2", "R1", "R2"};
  const Index contact = i / p.dimension;
  const Index k = i % p.dimension - 1;
  const Index width = p.disk_width();
  const char* component = k < 0 ? "N" : of_disks[k < width ? k : 2 + k - width];
  return text_of("contact ", contact, ", component ", component, " (entry ", i, ")");
}

void check_size(const char* what, Index size, Index expected, const char* why) {
  if (size != expected) refuse(what, " has ", size, " entries, not ", expected, ": ", why);
}

void check_shape(const char* what, const SpMat& A, Index rows, Index columns, const char* why) {
  if (A.rows() != rows || A.cols() != columns)
    refuse(what, " is ", A.rows(), " x ", A.cols(), ", not ", rows, " x ", columns, ": ", why);
  if (!A.isCompressed()) refuse(what, " is not compressed");
}

void check_finite(const char* what, const SpMat& A) {
  for (Index j = 0; j < A.outerSize(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      if (!std::isfinite(it.value())) refuse(what, "(", it.row(), ", ", j, ") is ", it.value());
}

void check_finite(const char* what, const Vec& v) {
  for (Index i = 0; i < v.size(); ++i)
    if (!std::isfinite(v[i])) refuse(what, "[", i, "] is ", v[i]);
}

/// W_ii of parts: finite M and H may make what is not.
void check_finite_diagonal(const Problem& p) {
  const Vec diagonal = p.W.diagonal();
  for (Index i = 0; i < diagonal.size(); ++i)
    if (!std::isfinite(diagonal[i])) refuse("W is ", diagonal[i], " on its diagonal, at ", place(i, p));
}

}  // namespace

std::vector<ContactGroup> separated(const Problem& problem) {
  if (problem.W.condensed() != nullptr) return {};
  const int d = problem.dimension;
  std::vector<std::vector<Index>> groups = problem.W.groups(d);
  if (groups.size() < 2) return {};
  std::vector<ContactGroup> out;
  for (std::vector<Index>& contacts : groups) {
    std::vector<Index> rows;
    for (const Index a : contacts)
      for (Index k = 0; k < d; ++k) rows.push_back(d * a + k);
    Problem part{.dimension = d, .W = problem.W.part(rows), .q = problem.q(rows), .mu = problem.mu(contacts)};
    part.name = problem.name;
    if (problem.mu_r.size() != 0) part.mu_r = problem.mu_r(contacts);
    if (problem.rounding.q.size() != 0) part.rounding.q = problem.rounding.q(rows);
    if (problem.rounding.W.size() != 0) part.rounding.W = problem.rounding.W(rows);
    out.push_back({.contacts = std::move(contacts), .problem = std::move(part)});
  }
  return out;
}

void check(const Global& g, Index rows) {
  const Index m = g.M.rows();
  check_shape("M", g.M, m, m, "M is square");
  check_shape("H", g.H, m, rows, "a row a velocity of the bodies, a column a velocity of the contacts");
  check_shape("G", g.G, m, g.G.cols(), "a row a velocity of the bodies");
  check_size("f", g.f.size(), m, "one a velocity of the bodies");
  check_size("w", g.w.size(), rows, "one a velocity of the contacts");
  check_size("b", g.b.size(), g.G.cols(), "one a bilateral constraint");
  check_finite("M", g.M);
  check_finite("H", g.H);
  check_finite("G", g.G);
  check_finite("f", g.f);
  check_finite("w", g.w);
  check_finite("b", g.b);
}

namespace {

void check_coefficients(const char* friction, const Vec& mu) {
  for (Index a = 0; a < mu.size(); ++a)
    if (!(std::isfinite(mu[a]) && mu[a] >= 0))
      refuse("the coefficient of ", friction, " of contact ", a, " is ", mu[a], "; it must be finite and not negative");
}

}  // namespace

void check_friction(const Vec& mu) { check_coefficients("friction", mu); }

void check_no_rolling(const char* who, const Problem& problem) {
  if (problem.rolls()) refuse_input(who, ": a problem with rolling friction, which this does not know");
}

std::string contacts_text(const std::vector<Index>& contacts, Index first) {
  constexpr std::size_t most = 6;
  const std::size_t count = contacts.size();
  const std::size_t shown = count <= most ? count : most - 1;
  std::string text = count == 1 ? "contact " : "contacts ";
  for (std::size_t k = 0; k < shown; ++k)
    text += (k == 0 ? "" : k + 1 == count ? " and " : ", ") + std::to_string(contacts[k] + first);
  return shown == count ? text : text_of(text, " and ", count - shown, " more");
}

void check_dimension(int dimension) {
  if (dimension != 2 && dimension != 3) refuse("the dimension is ", dimension, ", neither 2 nor 3");
}

void check_rolling(int dimension, const Vec& mu, const Vec& mu_r) {
  check_friction(mu);
  if (dimension != 5 && mu_r.size() == 0) return check_dimension(dimension);
  if (dimension != 3 && dimension != 5)
    refuse("with rolling friction a contact has ", dimension, " entries, neither 3, in 2D, nor 5, in 3D");
  check_size("mu_r", mu_r.size(), mu.size(), "one a contact");
  check_coefficients("rolling friction", mu_r);
}

void check(const Problem& p) {
  check_rolling(p.dimension, p.mu, p.mu_r);
  const Index n = p.dimension * p.contacts();
  static constexpr const char* square =
      "a row a velocity of the contacts, as many as dimension x coefficients of friction";
  if (p.W.parts() == nullptr)
    check_shape("W", p.W.matrix(), n, n, square);
  else if (p.W.rows() != n)
    refuse("W is ", p.W.rows(), " x ", p.W.cols(), ", not ", n, " x ", n, ": ", square);
  check_size("q", p.q.size(), n, "one a velocity of the contacts");
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(p.q[i])) refuse("q is ", p.q[i], " at ", place(i, p));
  if (p.W.parts() != nullptr) {
    check_finite("M", p.W.parts()->M());
    check_finite("H", p.W.parts()->H());
    check_finite_diagonal(p);
  } else {
    const SpMat& W = p.W.matrix();
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(W, j); it; ++it)
        if (!std::isfinite(it.value()))
          refuse("W(", it.row(), ", ", j, ") is ", it.value(), ", in the column of ", place(j, p));
  }
  if (p.rounding.q.size() != 0) check_size("the rounding of q", p.rounding.q.size(), n, "one an entry of q");
  if (p.rounding.W.size() != 0) check_size("the rounding of W", p.rounding.W.size(), n, "one a row of W");
  if (p.global) check(*p.global, n);
}

}  // namespace perp::contact
