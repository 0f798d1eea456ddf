// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Conditions that seem to have each other's variables: a slip that leaves a model square, and that a solver cannot
/// see.
#include <string>

#include "ncp/ampl/pairing.hpp"

namespace perp::ncp::ampl {

/// Says which, by names or by the pattern of J; empty where nothing speaks for it. Names speak for it where most rows
/// cap[i] complement mu[i], row cap[a] does not, mu[a] exists, and the row that has mu[a] breaks a habit, too. The
/// pattern does where it is not symmetric, and would be if two rows had each other's variables: optimality conditions
/// and equilibria of prices and quantities have symmetric patterns.
std::string exchanged(const Pairing& pairing, const JacobianMap& jacobian, const Names& names);

}  // namespace perp::ncp::ampl
