#include "ncp/observe.hpp"

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <utility>

namespace perp::ncp {

Observer print_table(std::ostream& out, const Mcp& mcp) {
  return [&out, &mcp, previous = Iteration{}](const Iteration& it) mutable {
    if (it.k == 0) out << "major minor  func  grad   residual    step type   prox  worst equation\n";
    char line[128];
    const int evals = it.k == 0 ? it.F_evals : it.F_evals - previous.F_evals;
    const int gradients = it.k == 0 ? it.J_evals : it.J_evals - previous.J_evals;
    std::snprintf(line, sizeof line, "%5d %5d %5d %5d %10.4e", it.k, it.pivots, evals, gradients, it.residual);
    out << line;
    if (it.k == 0)
      std::snprintf(line, sizeof line, " %7s %4c %6s  ", "", it.kind, "");
    else if (it.prox == 0)
      std::snprintf(line, sizeof line, " %7.1e %4c %6s  ", it.step, it.kind, "");
    else
      std::snprintf(line, sizeof line, " %7.1e %4c %6.0e  ", it.step, it.kind, it.prox);
    out << line;
    if (it.worst >= 0) out << '(' << mcp.equation_name(it.worst) << ')';
    out << '\n';
    previous = it;
    return Next::Continue;
  };
}

Observer record(std::vector<Iteration>& records) {
  return [&records](const Iteration& it) {
    records.push_back(it);
    records.back().x = nullptr;
    records.back().way = nullptr;
    return Next::Continue;
  };
}

Observer stop_when(const std::atomic<bool>& flag) {
  return [&flag](const Iteration&) { return flag ? Next::Stop : Next::Continue; };
}

Observer all(std::vector<Observer> observers) {
  return [observers = std::move(observers)](const Iteration& it) {
    Next next = Next::Continue;
    for (const Observer& observer : observers)
      if (observer && observer(it) == Next::Stop) next = Next::Stop;
    return next;
  };
}

}  // namespace perp::ncp
