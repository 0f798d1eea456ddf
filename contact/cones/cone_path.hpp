// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Central paths of Coulomb's law over the cones, in the coordinates of contact/model/scaling.hpp (mu = 1, K its own
/// dual): with r, y in the interior of K,
///     y = W r + q + s e_N,   r o y = tau e,   tau -> 0,
/// o the product of the cone's Jordan algebra, (r.y, r_N y_T + y_N r_T), and e = e_N. De Saxce's opening s > 0 of a
/// contact is what slip would lift it by; at tau = 0 Coulomb's law has s = |u_T|.
///
/// *s given*, one number a contact: a second-order cone problem. Where W is monotone its path is unique and cannot turn
/// back. s = 0 is the associated law, whose slip lifts off: u_N = |u_T|.
/// *s coupled*: s = -r_T.y_T / r_N besides, which makes r_N u_N = tau, Signorini's own path.
/// This one may turn back: docs/contact/piles.md.
///
/// Nesterov & Todd's scaling, a matrix T of each contact with T y = T^-1 r, leaves
///     (W + diag(T^-2 + e_N g')) dr = rhs,   g = ds/dr - T^-2 ds/dy,
/// g = 0 where s is given (contact/model/contact_system.hpp). Predictor and corrector are those of
/// contact/cones/predictor_corrector.hpp. Acary, Armand, Nguyen & Shpakovych, Second-order cone
/// programming for frictional contact mechanics using interior point algorithm, Optim. Methods Softw. 39 (2024) 634;
/// Alizadeh & Goldfarb, Math. Program. 95 (2003) 3. Private to contact/.
#include <vector>

#include "contact/model/contact_system.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

class ConePath {
 public:
  /// From r = y = 10 e, nothing opened. `problem` and `system` as for AlartCurnier.
  ConePath(const Scaled& problem, ContactSystem& system);
  ~ConePath();
  ConePath(const ConePath&) = delete;
  ConePath& operator=(const ConePath&) = delete;

  struct Point {
    Vec r;
    Vec y;
  };
  const Point& point() const { return at_; }
  /// Goes on from `point` with these openings, one a contact.
  void open(Point point, const Vec& openings);
  /// Near r and u = W r + q, with r_a o y_a = tau e at every contact: r - u - s e_N = r_a - y_a with these openings.
  Point near(const Vec& r, const Vec& openings, double tau) const;
  /// Goes on from `point` with s coupled at all contacts.
  void couple(Point point);

  /// One predictor-corrector step. False: the matrix is singular, or nothing is finite.
  bool step();

  const Vec& r() const { return at_.r; }
  double tau() const { return tau_; }  ///< mean r.y of the contacts
  double last_step() const { return last_step_; }
  Vec openings() const;  ///< s, one a contact; coupled ones of the last matrix
  Vec slip() const;      ///< |y_T|, one a contact

  struct Direction {
    Vec r;
    Vec y;
  };
  // Called by predictor_corrector().
  Direction direction(double target, const Direction* affine);
  double reach(const Direction& d) const;
  double mean_after(const Direction& d, double alpha) const;

 private:
  struct Contact;
  bool assemble();

  const Scaled& problem_;
  std::vector<Contact> contacts_;
  Point at_{};
  ContactSystem& system_;
  double tau_ = 0;
  double last_step_ = 1;
};

}  // namespace perp::contact
