// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the drivers of peers share: somebody else's solver as a program that AMPL, and `perp-compare --external`, can
/// call. `DRIVER [key=value]... STUB -AMPL` reads STUB.nl as an Mcp and writes STUB.sol.
///
/// solve_result_num says what the peer says, not what is true: 0 where it claims a solution, 201 where it claims that
/// there is none, 590 where the problem is not for it, else 400 to 599. Whoever wants the truth judges the point.
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::bench {

/// Of solve_result_num, as perp itself uses it (app/README.md).
enum class End {
  Claimed = 0,              ///< the peer says: solved
  Infeasible = 201,         ///< the peer says: there is no solution
  IterationLimit = 400,     ///< or of evaluations
  TimeLimit = 402,          ///< the peer's own
  Refused = 500,            ///< the driver could not do its work: a wrong option, an exception
  LinearSolveFailed = 501,  ///< a singular matrix
  Undefined = 503,          ///< F or J is not defined where the peer wants it
  Failed = 510,             ///< any other end that the peer does not call solved
  NotTaken = 590,           ///< the peer does not take this shape or size of problem: ncp::ampl::not_applicable
};

struct PeerAnswer {
  End end = End::Failed;
  std::string words{};  ///< the peer's own about its end, and what it took
  ncp::Vec x{};         ///< size() entries; empty: it has no point to show
};

/// An option of a driver. Values are checked before the peer sees them.
struct PeerOption {
  std::string key;
  std::string initial;                ///< its value if it is not given; "own": the peer's
  std::vector<std::string> values{};  ///< the words that it may be; none: a positive number, or `initial`
  std::string help{};
};

class PeerOptions {
 public:
  explicit PeerOptions(std::vector<PeerOption> table);
  /// "key=value". Throws std::invalid_argument naming key and value where there is no such key or value.
  void set(std::string_view assignment);
  const std::string& text(const std::string& key) const { return values_.at(key); }
  double number(const std::string& key) const;  ///< 0 if it is "own"
  const std::vector<PeerOption>& table() const { return table_; }

 private:
  std::vector<PeerOption> table_;
  std::map<std::string, std::string> values_{};
};

struct Peer {
  std::string name;     ///< of the driver; options also come from the environment variable NAME_options
  std::string version;  ///< of what it drives
  std::vector<PeerOption> options;
  /// One solve from x0; what it throws is told as a failure of the driver.
  std::function<PeerAnswer(const ncp::Mcp& mcp, ncp::In x0, const PeerOptions& options)> solve;
};

/// main() of a driver: its exit code, 0 if a .sol file with the peer's own answer was written, else 2.
int run_peer(const Peer& peer, int argc, const char* const* argv);

/// || x - mid(l, x - F(x), u) ||_inf at the projection of x on [l, u]; infinite where F is not defined.
double residual_at_projection(const ncp::Mcp& mcp, ncp::In x);

}  // namespace perp::bench
