#pragma once
/// What the Newton methods search with. Private to ncp/.
#include <vector>

#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// The reference values of a non-monotone line search.
class Memory {
 public:
  explicit Memory(int size) : size_(static_cast<std::size_t>(size)) {}
  void push(double merit);
  void reset(double merit);
  double reference() const;

 private:
  std::size_t size_;
  std::vector<double> last_;
};

/// Tells a run that gets nowhere: the best merit has not come down to `factor` of what it was within `window`
/// iterations.
class Stall {
 public:
  explicit Stall(int window = 60, double factor = 0.99) : window_(window), factor_(factor) {}
  bool stalled(double merit);

 private:
  int window_;
  double factor_;
  double best_ = infinity;
  double mark_ = infinity;  // best_ at the begin of the window
  int since_ = 0;
};

/// t with  psi(x + t d) <= reference + sigma t slope,  F and J defined there, over t = 1, beta, beta^2, ...; the point
/// found replaces `point`. x + t d is projected onto `box` if `projected`.
struct SearchOutcome {
  bool found = false;
  double t = 0;
  double merit = 0;
  int backtracks = 0;
  int undefined = 0;  ///< trial points at which F or J was not defined
};
SearchOutcome line_search(Run& run, const CFunction& c, const Armijo& rule, In d, double slope, double reference,
                          bool projected, Point& point);

}  // namespace perp::ncp
