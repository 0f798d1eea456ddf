// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/rigid_bodies.hpp"

#include <cmath>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using Triplets = std::vector<Eigen::Triplet<double, int>>;

void add_block(Triplets& entries, Index row, Index column, const Mat3& block) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (block(i, j) != 0) entries.emplace_back(static_cast<int>(row) + i, static_cast<int>(column) + j, block(i, j));
}

SpMat matrix(Index rows, Index columns, const Triplets& entries) {
  SpMat result(rows, columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace

Mat3 contact_frame(const Vec3& n) {
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) < std::abs(n[axis]) - 1e-12) axis = i;
  const Vec3 e = Vec3::Unit(axis);
  Mat3 frame;
  frame.col(0) = n;
  frame.col(1) = (e - e.dot(n) * n).normalized();
  frame.col(2) = n.cross(frame.col(1));
  return frame;
}

Index RigidBodies::add(const Body& body) {
  const bool finite = std::isfinite(body.mass) && body.inertia.allFinite() && body.centre.allFinite() &&
                      body.velocity.allFinite() && body.spin.allFinite();
  if (!finite || !(body.mass > 0))
    refuse_input("rigid bodies: body ", bodies_.size(), " has the mass ", body.mass, ", or a part is not finite");
  if (Eigen::LLT<Mat3>(body.inertia).info() != Eigen::Success)
    refuse_input("rigid bodies: the inertia of body ", bodies_.size(), " is not positive definite");
  bodies_.push_back(body);
  return static_cast<Index>(bodies_.size()) - 1;
}

void RigidBodies::touch(const Contact& contact) {
  const auto known = [this](Index body) { return body >= ground && body < static_cast<Index>(bodies_.size()); };
  if (!known(contact.a) || !known(contact.b) || contact.a == contact.b)
    refuse_input("rigid bodies: contact ", contacts_.size(), " is between bodies ", contact.a, " and ", contact.b,
                 " of ", bodies_.size());
  if (!(std::abs(contact.normal.norm() - 1) < 1e-12) || !contact.point.allFinite())
    refuse_input("rigid bodies: the normal of contact ", contacts_.size(), " has the length ", contact.normal.norm(),
                 ", not 1, or its point is not finite");
  contacts_.push_back(contact);
}

Vec RigidBodies::mu() const {
  Vec mu(static_cast<Index>(contacts_.size()));
  for (Index a = 0; a < mu.size(); ++a) mu[a] = contacts_[static_cast<std::size_t>(a)].mu;
  return mu;
}

Global RigidBodies::global(double h, const Vec3& g) const {
  const Index m = 6 * static_cast<Index>(bodies_.size());
  const Index n = 3 * static_cast<Index>(contacts_.size());
  Triplets M;
  Global global;
  global.f.resize(m);
  for (Index i = 0; i < m; i += 6) {
    const Body& body = bodies_[static_cast<std::size_t>(i / 6)];
    add_block(M, i, i, body.mass * Mat3::Identity());
    add_block(M, i + 3, i + 3, body.inertia);
    global.f.segment<3>(i) = body.mass * (body.velocity + h * g);
    const Vec3 momentum = body.inertia * body.spin;
    global.f.segment<3>(i + 3) = momentum - h * body.spin.cross(momentum);
  }
  Triplets H;
  for (Index j = 0; j < n; j += 3) {
    const Contact& contact = contacts_[static_cast<std::size_t>(j / 3)];
    const Mat3 frame = contact_frame(contact.normal);
    for (const auto& [body, sign] : {std::pair{contact.a, 1.}, {contact.b, -1.}}) {
      if (body == ground) continue;
      const Vec3 arm = contact.point - bodies_[static_cast<std::size_t>(body)].centre;
      Mat3 moments;  // c'(omega x arm) = (arm x c)'omega
      for (int c = 0; c < 3; ++c) moments.col(c) = arm.cross(frame.col(c));
      add_block(H, 6 * body, j, sign * frame);
      add_block(H, 6 * body + 3, j, sign * moments);
    }
  }
  global.M = matrix(m, m, M);
  global.H = matrix(m, n, H);
  global.G = SpMat(m, 0);
  global.w = Vec::Zero(n);
  global.b.resize(0);
  return global;
}

Mat3 RigidBodies::box_inertia(double mass, const Vec3& edges) {
  const Vec3 s = edges.cwiseProduct(edges) * (mass / 12);
  return Vec3(s[1] + s[2], s[0] + s[2], s[0] + s[1]).asDiagonal();
}

Mat3 RigidBodies::sphere_inertia(double mass, double radius) { return 0.4 * mass * radius * radius * Mat3::Identity(); }

}  // namespace perp::contact
