// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Newton's method for nonsmooth equations Phi(r, W r + q) = 0 that are written contact by contact, in the coordinates
/// of contact/model/scaling.hpp (lecture, (51), (55), (59)-(60), (74)):
///     (A + B W) d = -Phi(r),   A, B an element of the generalised Jacobian,   r + t d,   psi = |Phi|^2 / 2.
#include <cmath>
#include <functional>
#include <type_traits>
#include <vector>

#include "contact/model/contact_system.hpp"
#include "contact/model/scaling.hpp"
#include "lcp/fields.hpp"

namespace perp::contact {

class Trial;

/// The rows of one contact at (r, u): A dr + B du = c for the step to the equation's zero, c = -Phi.
template <int Size>
struct NewtonRowsOfSize : RowsOfSize<Size> {
  ContactVector<Size> c = ContactVector<Size>::Zero();
};
using NewtonRows = NewtonRowsOfSize<3>;
/// The rows of contact a.
template <int Size>
using RowsOfContacts =
    std::function<NewtonRowsOfSize<Size>(std::size_t a, const ContactVector<Size>& r, const ContactVector<Size>& u)>;
using RowsOf = RowsOfContacts<3>;

/// The equation at r, with u = W r + q.
template <int Size>
struct NewtonSystemOf {
  std::vector<RowsOfSize<Size>> rows;
  Vec c;  ///< of all contacts: -Phi
  double merit() const { return c.squaredNorm() / 2; }
};
using NewtonSystem = NewtonSystemOf<3>;
template <int Size = 3>
NewtonSystemOf<Size> newton_system(const Scaled& problem, const std::type_identity_t<RowsOfContacts<Size>>& rows_of,
                                   In r, In u);

/// d of (A + B (W + alpha I)) d = c, by factors of contact/model/contact_system.hpp. No entry of a W by its parts is
/// formed; where contacts stick A is zero, so alpha > 0. False: the matrix has no factors, or d leaves a residual.
template <int Size = 3>
bool newton_direction(const Scaled& problem, ContactSystemOf<Size>& matrix, const NewtonSystemOf<Size>& system,
                      double alpha, Vec& d);

/// 1 / W_NN and 1 / mean(W_TT), one a contact; R: of its second disk.
struct NewtonWeights {
  Vec N;
  Vec T;
  Vec R;
  explicit NewtonWeights(const Scaled& problem);
};

enum class ContactLineSearch {
  None,            ///< full steps
  Armijo,          ///< the first t of 1, 1/2, .. with psi(t) <= (1 - 2 sigma t) psi(0): (60)
  GoldsteinPrice,  ///< that, and psi(t) >= psi(0) - 2 (1 - sigma) t psi(0): Siconos' search of NSN_AC
};

/// Options of the Newton methods.
struct NewtonOptions {
  ContactLineSearch line_search = ContactLineSearch::GoldsteinPrice;
  double sigma = 0.01;       ///< of the line search; Siconos' 0.01
  int max_halvings = 40;     ///< of a step. Where they find none the full step is taken, as in Siconos
  int max_iterations = 200;  ///< Siconos' limit
  bool scaling = true;       ///< of contact/model/scaling.hpp
};
void describe(NewtonOptions& options, Fields& fields);

/// Newton's method from r, judged after each step. W + alpha I takes the place of W, with the first alpha of 1e-10,
/// 1e-8, .., 1e-2 that gives a direction. Ends where none does.
template <int Size>
void newton(Trial& trial, const Scaled& problem, const NewtonOptions& options, const RowsOfContacts<Size>& rows_of,
            Vec r);

}  // namespace perp::contact
