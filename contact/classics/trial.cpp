// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/trial.hpp"

namespace perp::contact {
namespace {

constexpr int judged = 10;  // so many iterations first, and then each of so many
constexpr int proof_after = 1000;

}  // namespace

bool Trial::step(In r, const TrialStep& step) {
  ++stats.iterations;
  return over() || judge_iterate(r, step);
}

bool Trial::cheap_step(In r, const TrialStep& step) {
  const int k = ++stats.iterations;
  if (over()) return true;
  if ((k <= judged || k % judged == 0) && judge_iterate(r, step)) return true;
  return k == proof_after && no_solution();
}

}  // namespace perp::contact
