// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a client of PATH's library sets once for all of its calls. It belongs to the thread here.
#include <memory>
#include <string>

#include "capi/path/perp_path.h"
#include "capi/perp.h"

namespace perp::path {

/// The options behind a handle.
class OptionSet {
 public:
  OptionSet();
  /// Empty, or why the value is refused.
  std::string set(const std::string& key, const std::string& value);
  std::string get(const std::string& key) const;  ///< "-" where there is none
  void clear();
  perp_solver* solver() const { return solver_.get(); }
  bool on(const std::string& key) const { return get(key) == "yes"; }

 private:
  struct Free {
    void operator()(perp_solver* solver) const { perp_solver_free(solver); }
  };
  std::unique_ptr<perp_solver, Free> solver_;
};

struct ThreadState {
  Output_Interface output{};  ///< print is null: the files
  FILE* log = nullptr;
  FILE* status = nullptr;
  FILE* listing = nullptr;
  Error_Interface error{};
  /// Those touched last, until they are destroyed, which another thread may do.
  std::weak_ptr<OptionSet> options{};

  /// Does anybody hear the log?
  bool heard() const { return output.print != nullptr || log != nullptr; }
};
ThreadState& this_thread();

void tell(int mode, const std::string& text);
/// To the log and to Error_Interface::warning.
void warn(const std::string& text);

}  // namespace perp::path
