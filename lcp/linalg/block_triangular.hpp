// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Solves reducible affine MCPs component by component. Row i of F = M z + q depends on z_j where M_ij != 0. The
/// strongly connected components of that graph can be ordered so that M is block lower triangular. Component k is then
/// the affine MCP of M_kk with
///     q_k + sum_{j < k} M_kj z_j,   z_j the solutions found before.
/// This is correct for every M: a point put together from solutions of all components solves the problem. It is
/// complete if every component has one solution at most (P-matrices on the diagonal). Otherwise another solution of an
/// earlier component could make a later one solvable, so that its failure proves nothing. The rows of fixed variables
/// ask for nothing and are no dependence. Reference: Tarjan, SIAM J. Comput. 1 (1972) 146.
#include <functional>
#include <vector>

#include "lcp/judge/result.hpp"

namespace perp::lcp {

/// The indices of component k are order[first[k]] .. order[first[k + 1] - 1]; a component depends on itself and
/// those before it.
struct Components {
  std::vector<Index> order;
  std::vector<Index> first{0};
  Index count() const { return static_cast<Index>(first.size()) - 1; }
};
/// Time and memory proportional to n and the entries of M. Entries that are zero are no dependence.
Components strong_components(const AffineMcp& problem);

/// A method for one component: (problem, start, limits) -> Result.
using ComponentSolver = std::function<Result(const AffineMcp&, In, const Limits&)>;

/// Solves component after component; those of one variable with M_ii > 0 or a fixed variable in closed form, the
/// others by `solver` with the start's entries. iterations and factorizations are the solver's, added up. A component
/// that is not solved ends the run with its status and its number in the message, z as far as it came; Infeasible is
/// passed on only where it is one of the whole problem (the components it depends on have one solution by their form,
/// or the certificate, zero elsewhere, proves it) and is Stalled otherwise. Throws what check_input() throws.
Result solve_by_components(const AffineMcp& problem, In start, const ComponentSolver& solver,
                           const Limits& limits = {});

}  // namespace perp::lcp
