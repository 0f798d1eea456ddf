// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What bench_path_peer and others run on, and with: (problem, start) pairs, and methods by name.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/strategy/solve.hpp"

namespace perp::bench {

struct Case {
  std::string problem;
  std::string start;  ///< "1", "2", ... of the collection; "model" of an .nl file; "random 1", "near 1", ...
  std::shared_ptr<const ncp::Mcp> mcp;
  ncp::Vec x0;
  bool solvable = true;  ///< false: the collection says that there is no solution
  bool random = false;
};

/// Every published start of every problem of the collection whose name contains `only`.
std::vector<Case> collection_cases(std::string_view only);
/// `count` random starts of one problem: x_i uniform in [a_i - r_i, b_i + r_i] and the problem's box, where a_i and b_i
/// are the least and greatest published start and r_i = max(1, b_i - a_i). Throws std::invalid_argument if there is no
/// such problem.
std::vector<Case> random_cases(std::string_view problem, int count, std::uint64_t seed = 1);
/// KKT systems of random sparse quadratic programs  min 1/2 x'Hx + c'x, 0 <= x <= 1, A x = b or A x >= b,  with n + m
/// variables, at most 300 of them: H = D + V V' with a tenth of its rank in V, three entries of A a column, b from a
/// point inside the box. From x = 0.
std::vector<Case> random_programs(int count, std::uint64_t seed = 1);
/// An .nl file at its own start.
Case model_case(const std::string& path);
/// `count` other starts of a model, in turn near its own, far from it, with other sizes, and with half of the variables
/// at bounds.
std::vector<Case> starts_of(const Case& model, int count, std::uint64_t seed = 1);

/// The method called `name`, with its default options; throws std::invalid_argument with the known names.
ncp::Method method_called(std::string_view name);

}  // namespace perp::bench
