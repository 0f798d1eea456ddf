// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sparse problems of any size from a model that walks over its Jacobian. Private to the collection.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "collection/base/build.hpp"

namespace perp::ncp::collection {

/// The problem of a model, which has
///     template <class Z, class Y> void excess(const Z& z, Y&& F) const   F := F(z), on vectors of double and
///     Expression;
///                                                               of affine models on those of double alone
///     template <class Visit> void slopes(In z, Visit) const     visit(i, j, dF_i/dz_j, constant) for every entry that
///                                                               can be nonzero, column by column and downwards in
///                                                               each; constant: see Mcp::linear_entries
///     std::string variable(Index) const, equation(Index) const  made when they are asked for: there may be millions
///     static constexpr bool affine
/// `slopes` visits the same places at every z: the same walk makes the pattern and the values. Values that are not
/// finite count as "not defined here".
template <class Model>
class ModelMcp final : public Mcp {
 public:
  ModelMcp(std::string name, Box box, Model model)
      : name_(std::move(name)), box_(std::move(box)), model_(std::move(model)), pattern_(pattern()) {}

  const Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  bool is_affine() const override { return Model::affine; }
  std::string name() const override { return name_; }
  std::string variable_name(Index i) const override { return model_.variable(i); }
  std::string equation_name(Index i) const override { return model_.equation(i); }

  std::optional<Expressions> expressions() const override {
    if constexpr (Model::affine)
      return std::nullopt;
    else
      return written_down(on_vectors(size(), [&](const auto& z, auto& F) { model_.excess(z, F); }),
                          static_cast<int>(size()));
  }
  bool eval(In z, Out F) const override {
    model_.excess(z, F);
    return all_finite(F);
  }
  bool jacobian(In z, SpMat& J) const override {
    double* next = J.valuePtr();
    model_.slopes(z, [&](Index, Index, double value, bool) { *next++ = value; });
    return all_finite(Eigen::Map<const Vec>(J.valuePtr(), J.nonZeros()));
  }
  std::vector<bool> linear_entries() const override {
    std::vector<bool> linear;
    linear.reserve(static_cast<std::size_t>(pattern_.nonZeros()));
    model_.slopes(Vec::Zero(size()), [&](Index, Index, double, bool constant) { linear.push_back(constant); });
    return linear;
  }

 private:
  SpMat pattern() const {
    const Vec anywhere = Vec::Zero(size());
    Index count = 0;
    model_.slopes(anywhere, [&](Index, Index, double, bool) { ++count; });
    SpMat made(size(), size());
    made.resizeNonZeros(count);
    std::fill_n(made.outerIndexPtr(), size() + 1, 0);
    int* row = made.innerIndexPtr();
    double* value = made.valuePtr();
    model_.slopes(anywhere, [&](Index i, Index j, double slope, bool) {
      *row++ = static_cast<int>(i);
      *value++ = slope;
      ++made.outerIndexPtr()[j + 1];
    });
    for (Index j = 0; j < size(); ++j) made.outerIndexPtr()[j + 1] += made.outerIndexPtr()[j];
    return made;
  }

  std::string name_;
  Box box_;
  Model model_;
  SpMat pattern_;
};

template <class Model>
std::unique_ptr<Mcp> make_model(std::string name, Box box, Model model) {
  return std::make_unique<ModelMcp<Model>>(std::move(name), std::move(box), std::move(model));
}

}  // namespace perp::ncp::collection
