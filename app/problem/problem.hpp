// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problem a command is about: a name of the collection, an .nl file, or files of an affine problem.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/program/files.hpp"
#include "collection/collection.hpp"
#include "ncp/ampl/model.hpp"

namespace perp::app {

struct LoadedProblem {
  std::string label;  ///< the name, or the file as it was given
  std::unique_ptr<ncp::Mcp> mcp;
  ncp::Vec x0;
  int start = 1;   ///< which of the starts x0 is, from 1
  int starts = 1;  ///< how many there are
  std::vector<ncp::collection::KnownSolution> solutions{};
  bool solutions_complete = false;
  std::string no_solution{};                 ///< why there is none, where the collection knows that
  const ncp::ampl::Model* model = nullptr;   ///< mcp, if it came from a file
  std::unique_ptr<ncp::Mcp> without_rows{};  ///< of a variational inequality from matrix files: F, which mcp refers to

  /// Of the variables a user knows: without those added for side inequalities.
  ncp::Index own_variables() const {
    return model != nullptr ? model->n_var() : without_rows ? without_rows->size() : mcp->size();
  }
};

/// The state of a variable that is no unknown (ncp::ampl::Model::computed).
inline constexpr std::string_view computed_state = "computed";

/// What the command line names.
struct ProblemSource {
  std::string problem;         ///< NAME, FILE.nl, FILE.dat (Siconos' LCPs and MLCPs), or M.mtx
  std::string q{};             ///< of M.mtx: q.mtx
  std::string lower{};         ///< of M.mtx: a file or a number; empty: 0
  std::string upper{};         ///< of M.mtx: a file or a number; empty: inf
  std::string rows{};          ///< with M.mtx: A of a variational inequality over b <= A x <= c and the bounds
  std::string row_lower{};     ///< b, a file or a number; empty: -inf
  std::string row_upper{};     ///< c, a file or a number; empty: inf
  std::string start_at{};      ///< a file with the point to start from, in place of the problem's own start
  std::optional<int> start{};  ///< of a collection problem, from 1
};
/// Is it the matrix of an affine problem? (By the file's ending: .mtx, .dat.)
bool is_matrix_file(const std::string& argument);
/// Throws InputError, ncp::ampl::ModelError or lcp::FileError.
LoadedProblem load_problem(const ProblemSource& source);

/// The files that load_problem() reads of it: for check_outputs().
std::vector<FileUse> files_of(const ProblemSource& source);

/// Does the work of a command on `problem`. What is wrong with the input, for the user, where something refuses it:
/// InputError, the readers' errors, std::invalid_argument of the libraries, std::bad_alloc; "" if nothing does.
std::string refusal(const std::string& problem, const std::function<void()>& work);

/// "FILE.nl", "FILE" beside which there is a FILE.nl, NAME, or NAME:SIZE[xSIZE...][:SEED] of a family in any size
/// (collection/sized.hpp); a name of the collection goes before a file of that name without its ".nl". Throws
/// InputError (no such file, name or start; a suggestion where there is one) or ncp::ampl::ModelError.
LoadedProblem load_problem(const std::string& argument, std::optional<int> start = {});

/// The entry of that name. Throws InputError with a suggestion.
const ncp::collection::Entry& find_entry(const std::string& name);

}  // namespace perp::app
