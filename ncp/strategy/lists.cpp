// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/lists.hpp"

#include <algorithm>
#include <utility>

namespace perp::ncp {
namespace {

/// Iterations without 1 % less merit after which an attempt of the path search is given up: with another form of the
/// problem at hand, and of the restarts.
constexpr int first_patience = 10;
constexpr int restart_patience = 15;
constexpr int trial_patience = 6;  // of the tries from the points that an escape visits

constexpr int escape_rounds = 10;

/// Pivots of the path search on large problems, which needs few of them or very many. On nonlinear ones interior
/// points, which come next, take some ten factorizations, each as much as some tens of pivots.
constexpr int few_pivots_affine = 3000;
constexpr int few_pivots_nonlinear = 50;

using If = Condition;

/// One attempt without crash.
PathSearch restarted(PathSearch kernel) {
  kernel.crash.on = false;
  kernel.patience = std::min(kernel.patience, restart_patience);
  return kernel;
}

/// One attempt from a point that an escape visits.
PathSearch tried(PathSearch kernel) {
  kernel.patience = std::min(kernel.patience, trial_patience);
  return kernel;
}

template <class F>
PathSearch with(PathSearch kernel, F change) {
  change(kernel);
  return kernel;
}

/// Neither the user's units nor those of the scaled problem are always the better ones: each attempt is given up soon
/// where the other is at hand, and the first is gone on with where both are stuck.
Method in_turns(const PathSearch& kernel) {
  const PathSearch soon = with(kernel, [](PathSearch& m) { m.patience = std::min(m.patience, first_patience); });
  // Gradient steps that the scaled problem needs seldom succeed.
  const PathSearch scaled = with(soon, [](PathSearch& m) { m.gradient_step_limit = 0; });
  PathSearch again = kernel;
  again.crash.on = false;
  return First{.entries = {{.method = soon, .title = "the options given"},
                           {.method = on(Form::Scaled, scaled),
                            .title = "rows and columns scaled",
                            .when = {If::Scalable},
                            .reason = "units in which the entries of J are near 1"},
                           {.method = again,
                            .title = "on with the options given",
                            .from = From::Best,
                            .reason = "with more patience"}},
               .turns = true,
               .name = "path"};
}

/// Attempts on one block, where a restart costs little.
Method on_blocks(const PathSearch& kernel) {
  const PathSearch again = restarted(kernel);
  return on(Form::Blocks, First{.entries = {{.method = again},
                                            {.method = with(again, [](PathSearch& m) { m.proximal_perturbation = 1; }),
                                             .title = "proximal perturbation 1"},
                                            {.method = again, .from = From::UnitBox},
                                            {.method = SemismoothNewton{}},
                                            {.method = escaping(tried(again), {.rounds = escape_rounds})}},
                                .name = "path"});
}

}  // namespace

Method path(const PathSearch& kernel, int restart_limit) {
  PathSearch once = kernel;
  once.only_newton_if_affine = true;
  const PathSearch again = restarted(once);
  const Smoothing smoothing{.function = smoothed_fischer_burmeister(), .restarts = 1};
  First list{.entries = {{.method = in_turns(once)},
                         {.method = on_blocks(once),
                          .title = "block by block",
                          .when = {If::Triangular},
                          .reason = "recursions: a block knows what the blocks before it are",
                          .worth = "logistic chains of 16 to 400 periods"},
                         {.method = Affine{},
                          .title = "the best of the linear methods",
                          .when = {If::Affine},
                          .reason = "methods that use that M is constant, and proofs"},
                         {.method = with(again, [](PathSearch& m) { m.proximal_perturbation = 1; }),
                          .title = "proximal perturbation 1",
                          .reason = "a path where the first basis is singular",
                          .worth = "2 of 342 first-order systems end there"},
                         {.method = again,
                          .from = From::Origin,
                          .reason = "another start",
                          .worth = "without it 11 of 267 hard runs are lost"},
                         {.method = again,
                          .from = From::UnitBox,
                          .reason = "a start in general position",
                          .worth = "without it 4 of 267 hard runs are lost"},
                         {.method = on(Form::Rescaled, again),
                          .title = "rows and columns scaled as at the best point",
                          .when = {If::Rescalable},
                          .reason = "units in which the entries of J are near 1 there",
                          .worth = "2 of 342 first-order systems end there"},
                         {.method = with(again, [](PathSearch& m) { m.start = PathStart::Always; }),
                          .title = "Newton points from rays",
                          .reason = "solutions of the linearised problem that no regular path reaches",
                          .worth = "1 of 342 first-order systems ends there"},
                         {.method = escaping(tried(again), {.rounds = escape_rounds}),
                          .title = "little patience, then proximal escapes",
                          .from = From::Best,
                          .reason = "leaves local minima of the merit",
                          .worth = "as the only escape it solves 13 of 267 hard runs"},
                         {.method = smoothing,
                          .title = "smoothing",
                          .reason = "another way through what is not smooth",
                          .worth = "without it 9 of 267 hard runs are lost"},
                         {.method = on(Form::Rescaled, smoothing),
                          .title = "smoothing, rows and columns scaled",
                          .when = {If::Rescalable},
                          .reason = "the same in other units",
                          .worth = "without it 4 of 267 hard runs are lost"},
                         {.method = escaping(SemismoothNewton{}, {.rounds = escape_rounds}),
                          .title = "semismooth Newton, then proximal escapes",
                          .from = From::Best,
                          .reason = "leaves local minima of another merit",
                          .worth = "as the only escape it solves 14 of 267 hard runs"}},
             .restart_limit = restart_limit,
             .name = "path"};
  return On{.stop = kernel.stop, .form = Form::Presolved, .method = Method(std::move(list)), .name = "path"};
}

Method path_documented(const PathSearch& kernel, int restarts) {
  PathSearch once = kernel;
  once.crash.on = false;
  once.nms.initial_reference_factor = 2;
  PathSearch second = once;
  second.nms.mstep_frequency = 1;
  second.nms.initial_reference_factor = 10;
  second.nms.memory = 2;
  PathSearch third = once;
  third.crash.on = true;
  third.crash.nbchange_limit = 10;
  third.search = Searchtype::Arc;
  PathSearch perturbed = once;
  perturbed.proximal_to_residual = 0.01;
  First list{.entries = {{.method = kernel},
                         {.method = perturbed, .title = "PATH's first restart: perturbed by 0.01 times the residual"},
                         {.method = second, .title = "PATH's second restart: a test in each iteration"},
                         {.method = third, .title = "PATH's third restart: searches along arcs"}},
             .restart_limit = restarts,
             .name = "path"};
  return On{.stop = kernel.stop, .form = Form::Presolved, .method = Method(std::move(list)), .name = "path"};
}

Method automatic(const Stop& stop) {
  const SemismoothNewton penalised{.cfunction = penalised_fischer_burmeister()};
  return First{
      .stop = stop,
      .entries = {{.method = path({}, 0),
                   .title = "path with few pivots",
                   .when = {If::Affine, If::Cold, If::Large, If::Unsymmetric, If::NotMonotone},
                   .pivots = few_pivots_affine,
                   .reason = "large problems take few pivots or very many"},
                  {.method = Affine{},
                   .title = "the linear methods",
                   .when = {If::Affine, If::Cold},
                   .reason = "methods that use that M is constant, and proofs"},
                  {.method = InteriorPoint{},
                   .title = "interior points",
                   .when = {If::Nonlinear, If::Cold, If::Large, If::Unsymmetric, If::QuasiDefinite},
                   .reason = "some twenty factorizations that take little fill, whatever the active set"},
                  {.method = path({}, 0),
                   .title = "path with few pivots",
                   .when = {If::Nonlinear, If::Cold, If::Large, If::Unsymmetric},
                   .pivots = few_pivots_nonlinear,
                   .reason = "large problems take few pivots or very many"},
                  {.method = InteriorPoint{},
                   .title = "interior points",
                   .when = {If::Cold, If::Large, If::Unsymmetric},
                   .reason = "some ten factorizations, whatever the active set"},
                  {.method = NewtonJosephy{.subproblem = Subproblem::Qp},
                   .when = {If::Nonlinear, If::Cold, If::Large, If::Symmetric},
                   .reason = "quadratic programs by multigrid"},
                  {.method = path(), .reason = "the most robust one"},
                  {.method = SemismoothNewton{},
                   .when = {If::UniformP},
                   .reason = "every stationary point of its merit is the solution, its level sets are bounded: "
                             "Facchinei & Pang (2003), section 9.1"},
                  {.method = Smoothing{.function = smoothed_fischer_burmeister(), .restarts = 1},
                   .title = "smoothing",
                   .when = {If::Nonlinear}},
                  {.method = InteriorPoint{.restarts = 0}, .title = "interior points", .when = {If::Nonlinear}},
                  {.method = penalised, .title = "semismooth on the penalised function"},
                  {.method = escaping(SemismoothNewton{}), .title = "semismooth with proximal escapes"}},
      .tells = true,
      .name = "auto"};
}

Method with_rescalings(Method method, std::string name) {
  const Stop limits = stop(method);
  std::vector<Entry> entries{{.method = method},
                             {.method = on(Form::Rescaled, method), .when = {If::Rescalable}},
                             {.method = on(Form::Scaled, method), .when = {If::Scalable}}};
  return First{.stop = limits, .entries = std::move(entries), .name = std::move(name)};
}

Method with_escapes(Method method, std::string name) {
  const Stop limits = stop(method);
  const Method escapes = escaping(method);
  std::vector<Entry> entries{{.method = method},
                             {.method = on(Form::Rescaled, escapes), .when = {If::Rescalable}},
                             {.method = on(Form::Scaled, escapes), .when = {If::Scalable}},
                             {.method = escapes, .from = From::Best}};
  return First{.stop = limits, .entries = std::move(entries), .name = std::move(name)};
}

}  // namespace perp::ncp
