// SPDX-License-Identifier: Apache-2.0
#include "collection/base/build.hpp"

#include <memory>
#include <stdexcept>

namespace perp::ncp::collection {

std::string element(std::string letter, const std::string& place) {
  return letter.append("[").append(place).append("]");
}

Names indexed(const std::string& letter, Index n) {
  Names names;
  for (Index i = 1; i <= n; ++i) names.push_back(element(letter, std::to_string(i)));
  return names;
}

Box free_box(Index n) { return {Vec::Constant(n, -infinity), Vec::Constant(n, infinity)}; }

Names joined(std::initializer_list<Names> parts) {
  Names all;
  for (const Names& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Vec vec(std::initializer_list<double> values) {
  return Eigen::Map<const Vec>(values.begin(), static_cast<Index>(values.size()));
}

Vec joined(std::initializer_list<Vec> parts) {
  Index n = 0;
  for (const Vec& part : parts) n += part.size();
  Vec all(n);
  Index at = 0;
  for (const Vec& part : parts) {
    all.segment(at, part.size()) = part;
    at += part.size();
  }
  return all;
}

Vec shaken(const Vec& x, double fraction) {
  Vec made = x;
  for (Index i = 0; i < x.size(); ++i) made[i] *= 1 + (i % 2 == 0 ? fraction : -fraction);
  return made;
}

std::vector<Vec> eight_starts() {
  return {Vec::Zero(4),      Vec::Ones(4),      Vec::Constant(4, 100), vec({1, 0, 1, 0}),
          vec({1, 0, 0, 0}), vec({0, 1, 1, 0}), vec({0, 1, 0, 1}),     vec({1.25, 0, 0, 0.5})};
}

Functions functions_of(Shape shape) {
  Functions made;
  made.name = std::move(shape.name);
  made.pattern = shape.pattern.size() == 0 ? dense_pattern(shape.box.size()) : shape.pattern;
  made.pattern.makeCompressed();
  made.box = std::move(shape.box);
  made.variable_names = std::move(shape.variables);
  made.equation_names = std::move(shape.equations);
  return made;
}

namespace {

[[noreturn]] void refuse(std::string_view problem, std::string_view argument, Index value, const char* than,
                         Index limit) {
  throw std::invalid_argument(std::string(problem)
                                  .append(": ")
                                  .append(argument)
                                  .append(" is ")
                                  .append(std::to_string(value))
                                  .append("; it must be at ")
                                  .append(than)
                                  .append(std::to_string(limit)));
}

}  // namespace

void require_at_least(std::string_view problem, std::string_view argument, Index value, Index least) {
  if (value < least) refuse(problem, argument, value, "least ", least);
}

void require_between(std::string_view problem, std::string_view argument, Index value, Index least, Index most) {
  require_at_least(problem, argument, value, least);
  if (value > most) refuse(problem, argument, value, "most ", most);
}

bool all_finite(In values) { return values.allFinite(); }

std::unique_ptr<Mcp> make_affine(Shape shape, const SpMat& M, const Vec& q) {
  shape.pattern = M;
  Functions made = functions_of(std::move(shape));
  const auto matrix = std::make_shared<const SpMat>(made.pattern);  // compressed, hence value for value J
  made.affine = true;
  made.F = [matrix, q](In x, Out F) {
    F = q;
    F.noalias() += *matrix * x;
    return all_finite(F);
  };
  made.J = [matrix](In, SpMat& J) {
    std::copy_n(matrix->valuePtr(), matrix->nonZeros(), J.valuePtr());
    return true;
  };
  return make_mcp(std::move(made));
}

}  // namespace perp::ncp::collection
