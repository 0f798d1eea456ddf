#pragma once
/// The methods' loops, within a run. Private to ncp/.
#include "ncp/run/run.hpp"

namespace perp::ncp {

struct SemismoothNewton;
struct MinNewton;
struct Smoothing;
struct InteriorPoint;
struct NewtonJosephy;
struct NewtonRobinson;
struct Multiroot;
struct PathSearch;
struct Affine;

// The loops: from `point`, F and J known there, until the run ends.
void semismooth_newton(Run& run, const SemismoothNewton& method, Point point);
void min_newton(Run& run, const MinNewton& method, Point point);
void smoothing(Run& run, const Smoothing& method, Point point);
void interior_point(Run& run, const InteriorPoint& method, Point point);
void newton_josephy(Run& run, const NewtonJosephy& method, Point point);
void newton_robinson(Run& run, const NewtonRobinson& method, Point point);
void multiroot(Run& run, const Multiroot& method, Point point);
/// One attempt, from one start with one set of options. Leaves the cells of the last linearised problem that was
/// solved.
void path_search(Run& run, const PathSearch& method, Point point);

/// Affine problems, by lcp/: one iteration.
void affine(Run& run, In x0, const Affine& method);

}  // namespace perp::ncp
