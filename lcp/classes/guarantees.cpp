// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>

#include "lcp/classes/classify_parts.hpp"

namespace perp::lcp {

std::array<std::pair<std::string_view, const Property*>, 13> Diagnosis::all() const {
  return {{{"symmetric", &symmetric},
           {"strictly diagonally dominant", &strictly_dominant},
           {"diagonally dominant", &dominant},
           {"Z", &z},
           {"H with positive diagonal", &h_plus},
           {"nonsingular M-matrix", &m},
           {"positive definite", &positive_definite},
           {"positive semidefinite", &positive_semidefinite},
           {"P", &p},
           {"P0", &p0},
           {"copositive", &copositive},
           {"strictly copositive", &strictly_copositive},
           {"copositive-plus", &copositive_plus}}};
}

std::vector<Guarantee> Diagnosis::guarantees() const {
  std::vector<Guarantee> list;
  // What follows from classes that hold to rounding holds to rounding.
  const auto add = [&](std::initializer_list<const Property*> classes, bool also, const char* statement,
                       const char* source) {
    if (!also || !std::ranges::all_of(classes, &Property::yes)) return;
    const bool rounded = std::ranges::any_of(classes, &Property::to_rounding);
    list.push_back({(rounded ? std::string(to_rounding) : std::string()) + statement, source});
  };
  add({}, bounded, "a solution exists for every q",
      "Hartman & Stampacchia 1966 (a continuous map on a compact convex set)");
  add({&p}, true, "exactly one solution for every q", "CPS, theorem 3.3.7; Samelson, Thrall & Wesler 1958");
  add({&p}, cone, "Lemke's method, principal pivoting and the least-index method end at the solution",
      "CPS, sections 4.2-4.4");
  add({}, p.no() && cone, "for some q there is no solution or more than one", "CPS, theorem 3.3.7");
  add({&m}, cone, "the solution is the least feasible point; it grows as q falls", "CPS, section 3.11");
  add({&z}, cone, "if there is a feasible point there is a least one, and it is a solution", "CPS, section 3.11");
  add({&z}, cone && !m.yes(), "Chandrasekaran's pivoting (n pivots at most) solves or shows infeasible",
      "CPS, section 4.7; Chandrasekaran 1970");
  add({&positive_semidefinite}, true, "the solutions form a convex polyhedron, on which (M + M')z and q'z are constant",
      "CPS, theorem 3.1.7");
  add({&positive_semidefinite}, cone, "if there is a feasible point there is a solution", "CPS, theorem 3.1.2");
  add({&positive_semidefinite}, true, "interior points converge to a solution if there is one",
      "Wright 1997, chapter 8");
  add({&positive_semidefinite, &symmetric}, true, "the solutions are the minima of z'Mz/2 + q'z over the box",
      "CPS, section 1.4");
  add({&positive_semidefinite, &symmetric}, h_plus.answer != Answer::Yes,
      "projected SOR converges to a solution for 0 < omega < 2 if the diagonal is positive and the minimum is attained",
      "Luo & Tseng 1992; Cryer 1971");
  add({&h_plus}, true, "projected Gauss-Seidel converges to the solution from any start", "CPS, section 5.3; Ahn 1981");
  add({&copositive_plus}, cone, "Lemke's method solves the problem or its ray proves it infeasible",
      "CPS, theorem 4.4.13");
  add({&strictly_copositive}, cone, "a solution exists for every q, and Lemke's method finds one",
      "CPS, theorems 3.8.5 and 4.4.13");
  add({&copositive}, !copositive_plus.yes() && cone,
      "a solution exists if v'q >= 0 for all v >= 0 with Mv >= 0, v'Mv = 0", "CPS, theorem 3.8.6");
  add({&p0}, !p.yes(),
      "M + eps D is P for every eps > 0 and positive diagonal D: a regularised problem has one "
      "solution",
      "CPS, theorem 3.4.2");
  return list;
}

}  // namespace perp::lcp
