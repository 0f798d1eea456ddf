#pragma once
/// The problem a command is about: a name of the collection or an .nl file.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ncp/ampl/model.hpp"
#include "ncp/collection/collection.hpp"

namespace perp::app {

struct LoadedProblem {
  std::string label;  ///< the name, or the file as it was given
  std::unique_ptr<ncp::Mcp> mcp;
  ncp::Vec x0;
  int start = 1;   ///< which of the starts x0 is, from 1
  int starts = 1;  ///< how many there are
  std::vector<ncp::collection::KnownSolution> solutions{};
  bool solutions_complete = false;
  const ncp::ampl::Model* model = nullptr;  ///< mcp, if it came from a file

  /// Of the variables a user knows: without those added for side inequalities.
  ncp::Index own_variables() const { return model != nullptr ? model->n_var() : mcp->size(); }
};

/// "FILE.nl", "FILE" beside which there is a FILE.nl, or NAME; a name of the collection goes before a file of that name
/// without its ".nl". Throws InputError (no such file, name or start; a suggestion where there is one) or
/// ncp::ampl::ModelError.
LoadedProblem load_problem(const std::string& argument, std::optional<int> start = {});

/// The entry of that name. Throws InputError with a suggestion.
const ncp::collection::Entry& find_entry(const std::string& name);

}  // namespace perp::app
