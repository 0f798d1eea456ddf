// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One attempt of PathSearch, which others may interrupt; private to ncp/.
#include <memory>

#include "ncp/path/path_search.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

class PathAttempt {
 public:
  /// The run outlives it.
  PathAttempt(Run& run, PathSearch method, Point point);
  ~PathAttempt();
  PathAttempt(const PathAttempt&) = delete;
  PathAttempt& operator=(const PathAttempt&) = delete;

  /// Until the run ends, or with NoProgress where the merit has not fallen by 1 % in `patience` iterations. A second
  /// call goes on from there, in the run resumed.
  void go_on(int patience);
  /// Whether it was patience alone that the last call lacked.
  bool stalled() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace perp::ncp
