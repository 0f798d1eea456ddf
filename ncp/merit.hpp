#pragma once
/// Psi(x) = 1/2 ||Phi(x)||^2 of a reformulation, an element H of the B-subdifferential of Phi, and grad Psi = H' Phi.
/// Private to ncp/.
#include "ncp/cfunction.hpp"
#include "ncp/run.hpp"
#include "ncp/solve.hpp"

namespace perp::ncp {

/// Phi, H = Da + Db J and H'Phi at a point.
struct Linearisation {
  Reformulation at;
  SpMat H;  ///< empty if it was not asked for
  Vec gradient;
  double merit = 0;
  /// max_j |gradient_j| / sum_i (|Da_j| [i = j] + |Db_i J_ij|) |Phi_i|: 0 at stationary points, 1 without cancellation.
  double stationarity = 0;
  /// The minimiser of ||Phi + H d|| along d = -gradient.
  Vec cauchy_step() const;
};
/// Fractions of multiples of the golden ratio: in (0, 1), no two alike; another sequence for every k.
Vec generic(Index n, int k = 0);

/// Phi, Da, Db. At kinks the element of the B-subdifferential is the one along a generic h > 0: x + s h meets no kink
/// for small s > 0 (De Luca, Facchinei & Kanzow 1996, section 7, with h_i = 1 at degenerate indices).
void elements(const CFunction& c, const Box& box, const Point& point, Reformulation& out);
void linearise(const CFunction& c, const Box& box, const Point& point, Linearisation& out, bool with_H = true);
/// Da + Db J in the pattern of J with its diagonal.
void assemble(In Da, In Db, const SpMat& J, SpMat& H);

/// max_j |gradient_j| / terms_j, terms_j the sum of the sizes of what gradient_j is the sum of; 1 where that overflows.
double stationarity(const Vec& gradient, const Vec& terms);

double merit(const CFunction& c, const Box& box, In x, In F);

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
