#pragma once
/// One attempt of PathSearch, from one start with one set of options; private to ncp/. The list of attempts is in
/// restarts.cpp.
#include "ncp/merit.hpp"

namespace perp::ncp {

/// Iterates from `point` until the run ends: with a verdict that stuck() says something about, or a final one. `kind`
/// is that of the first record: I start, R restart. Fills `basis` with the cells of the last linearised problem that
/// was solved.
void path_search(Run& run, const PathSearch& method, Point point, char kind, std::vector<lcp::Cell>& basis);

}  // namespace perp::ncp
