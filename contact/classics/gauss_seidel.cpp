// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/gauss_seidel.hpp"

#include <cmath>

#include "contact/model/unit_cone.hpp"

namespace perp::contact {

template <int Size>
std::vector<LocalProblem<Size>> local_problems(const Scaled& problem) {
  std::vector<LocalProblem<Size>> contacts;
  for (const Scaled::Block& block : problem.blocks) {
    ContactMatrix<Size> W = ContactMatrix<Size>::Zero();
    for (int j = 0; j < block.size; ++j)
      for (int i = 0; i < block.size; ++i) W(i, j) = problem.W.near(block.first + i, block.first + j);
    contacts.emplace_back(block, W);
  }
  return contacts;
}

template std::vector<LocalProblem<3>> local_problems<3>(const Scaled&);

MovingImpulses::MovingImpulses(const Scaled& problem, Vec& r, Vec& u)
    : problem_(problem), parts_(problem.W.parts()), r_(r), u_(u) {
  if (parts_ == nullptr) return;
  H_ = parts_->root() != nullptr ? parts_->root() : &parts_->H();
  v_ = *H_ * r;
  if (parts_->root() == nullptr) v_ = parts_->inverse(v_);
}

template <int Size>
ContactVector<Size> MovingImpulses::velocity(const Scaled::Block& block) const {
  if (parts_ == nullptr) return block.of<Size>(u_);
  ContactVector<Size> u = block.of<Size>(problem_.q) + problem_.W.shift() * block.of<Size>(r_);
  for (int k = 0; k < block.size; ++k) u[k] += H_->col(block.first + k).dot(v_);
  return u;
}

template <int Size>
double MovingImpulses::set(const Scaled::Block& block, const ContactVector<Size>& after) {
  const ContactVector<Size> d = after - block.of<Size>(r_);
  if (d.isZero(0)) return 0;
  r_.segment(block.first, block.size) = after.head(block.size);
  if (parts_ != nullptr && parts_->root() == nullptr) {
    v_ += parts_->inverse(Vec(H_->middleCols(block.first, block.size) * d.head(block.size)));
    return d.squaredNorm();
  }
  const SpMat& columns = parts_ != nullptr ? *H_ : problem_.W.matrix();
  Vec& moved = parts_ != nullptr ? v_ : u_;
  for (int k = 0; k < block.size; ++k)
    if (d[k] != 0)
      for (SpMat::InnerIterator it(columns, block.first + k); it; ++it) moved[it.row()] += it.value() * d[k];
  return d.squaredNorm();
}

template ContactVector<3> MovingImpulses::velocity<3>(const Scaled::Block&) const;
template double MovingImpulses::set<3>(const Scaled::Block&, const ContactVector<3>&);

void MovingImpulses::finish() {
  if (parts_ != nullptr) u_ = problem_.W * r_ + problem_.q;
}

GaussSeidel::GaussSeidel(const Scaled& problem, LocalSolver local, double omega)
    : problem_(problem), local_(local), omega_(omega) {
  with_size(problem, [&]<int Size>() { contacts_ = local_problems<Size>(problem); });
}

template <int Size>
double GaussSeidel::sweep(const Contacts<Size>& contacts, Vec& r, Vec& u) const {
  MovingImpulses moving(problem_, r, u);
  double change = 0;
  for (std::size_t a = 0; a < contacts.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const ContactVector<Size> before = block.of<Size>(r);
    const ContactVector<Size> velocity = moving.velocity<Size>(block);
    ContactVector<Size> after = contacts[a].solve(local_, velocity - contacts[a].W() * before, before);
    if (omega_ != 1) after = project_onto_unit_cone<Size>(before + omega_ * (after - before), block.width);
    change += moving.set<Size>(block, after);
  }
  moving.finish();
  return std::sqrt(change);
}

double GaussSeidel::sweep(Vec& r, Vec& u) const {
  return std::visit([&](const auto& contacts) { return sweep(contacts, r, u); }, contacts_);
}

}  // namespace perp::contact
