#pragma once
/// What the Newton methods share beside their linear systems: the reference values of a non-monotone search, the steps
/// that are safe where Newton's is not, and the best point. Private to lcp/.
#include <algorithm>
#include <cstddef>
#include <deque>

#include "lcp/fields.hpp"
#include "lcp/iterative/newton_system.hpp"

namespace perp::lcp {

/// The largest of the last `memory` merits.
class Reference {
 public:
  explicit Reference(int memory) : memory_(static_cast<std::size_t>(std::max(1, memory))) {}
  void push(double merit) {
    last_.push_back(merit);
    if (last_.size() > memory_) last_.pop_front();
  }
  double value() const { return *std::max_element(last_.begin(), last_.end()); }
  void restart(double merit) { last_.assign(1, merit); }

 private:
  std::size_t memory_;
  std::deque<double> last_;
};

/// t in {1, 1/2, ...} with merit(z + t d) <= reference - t decrease; 0 if there is none above `shortest`.
template <class Merit>
double backtrack(const Merit& merit, const Vec& z, const Vec& d, double reference, double decrease, double shortest) {
  for (double t = 1; t >= shortest; t /= 2)
    if (merit(z + t * d) <= reference - t * decrease) return t;
  return 0;
}

/// One step on Psi of Fischer-Burmeister's equations that needs no regularity: Levenberg-Marquardt with growing nu,
/// else the gradient. False at stationary points.
struct SafeStep {
  double armijo;
  double shortest;
  bool operator()(const AffineMcp& problem, NewtonSystem& system, const Equations& at, double reference, Vec& z) const;
};

void describe_steps(double& armijo, double& shortest, Fields& fields);

}  // namespace perp::lcp
