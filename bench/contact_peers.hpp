#pragma once
/// Solvers of contact problems that contact.cpp is compared with.
#include <string>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::bench {

/// The names of Siconos' solvers that can be run here; empty where there is no Siconos.
std::vector<std::string> contact_peers();

/// Runs one in this process, which it may end: r, and the seconds that its driver took. A problem in 3D.
struct PeerRun {
  contact::Vec r{};
  double seconds = 0;
  int iterations = 0;
};
PeerRun run_contact_peer(const std::string& name, const contact::Problem& problem, double tol);

}  // namespace perp::bench
