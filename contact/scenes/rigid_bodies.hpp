// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Rigid bodies in contact, and the frictional contact problem of one time step of theirs: with v = (velocity of the
/// centre of mass, angular velocity) of body after body in world axes, inertia M = diag(m I, J) and impulses of the
/// step h,
///     M v = M v_k + h (m g, -omega_k x J omega_k) + H r,   u = H'v.
/// Contact a between bodies A and B at the point p, with the normal n from B to A and tangents t1 = a unit vector
/// normal to n, t2 = n x t1, has the relative velocity
///     u = [n t1 t2]' (v_A + omega_A x (p - x_A) - v_B - omega_B x (p - x_B)):
/// r_N >= 0 pushes A and B apart, u_N > 0 parts them. Gaps are not looked at: contacts are where one says so.
#include <Eigen/Dense>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

inline constexpr Index ground = -1;  ///< the body that does not move

class RigidBodies {
 public:
  struct Body {
    double mass = 1;               ///< [kg]
    Mat3 inertia = Mat3::Zero();   ///< J about the centre of mass, world axes [kg m^2]
    Vec3 centre = Vec3::Zero();    ///< x [m]
    Vec3 velocity = Vec3::Zero();  ///< v_k [m/s]
    Vec3 spin = Vec3::Zero();      ///< omega_k [1/s]
  };
  struct Contact {
    Index a = ground;
    Index b = ground;
    Vec3 point = Vec3::Zero();
    Vec3 normal = Vec3::UnitZ();  ///< from b to a, of length 1
    double mu = 0.5;
  };

  /// Returns the body's number. Throws std::invalid_argument unless mass and J are positive (definite), all finite.
  Index add(const Body& body);
  /// Throws std::invalid_argument if a body does not exist, both are the same, or the normal is not of length 1.
  void touch(const Contact& contact);

  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Contact>& contacts() const { return contacts_; }

  Vec mu() const;
  /// For a step of h seconds under the acceleration g [m/s^2].
  Global global(double h, const Vec3& g) const;

  /// J of a box with these edges and mass, axes along the edges.
  static Mat3 box_inertia(double mass, const Vec3& edges);
  static Mat3 sphere_inertia(double mass, double radius);

 private:
  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
};

/// (n, t1, t2): t1 is the projection of the coordinate axis that is farthest from n; of several, the first.
Mat3 contact_frame(const Vec3& n);

}  // namespace perp::contact
