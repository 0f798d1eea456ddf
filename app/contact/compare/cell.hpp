// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One cell of `perp contact --compare`, (variant, problem), and the files that hold them.
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "app/campaign/cell.hpp"
#include "app/campaign/process.hpp"

namespace perp::app::contacts {

using compare::Outcome;

struct Cell {
  std::string variant{};  ///< label
  std::string problem{};  ///< as it was given
  bool exact = true;      ///< is the variant's law Coulomb's?
  Outcome outcome = Outcome::Failed;
  std::string status{};                                       ///< the run's own word
  std::string solved_by{};                                    ///< the step that made the accepted point; "" if none is
  int contacts = -1;                                          ///< -1: not known
  long iterations = -1;                                       ///< of auto: with its sweeps and Newton steps
  double seconds = 0;                                         ///< of the solve; of a killed run, of its process
  double peak_mb = 0;                                         ///< resident, reading included
  double siconos = std::numeric_limits<double>::quiet_NaN();  ///< metrics of Coulomb's law; NaN: no point came back
  double rr9118 = std::numeric_limits<double>::quiet_NaN();
  double scaled = std::numeric_limits<double>::quiet_NaN();
  double own = std::numeric_limits<double>::quiet_NaN();  ///< of the own affine problem; NaN if exact
  std::string message{};
  std::string command{};  ///< that repeats it

  bool solved() const { return outcome == Outcome::Solved; }

  static void fields(auto& f, auto& cell) {
    f("variant", cell.variant);
    f("problem", cell.problem);
    f("exact", cell.exact);
    f.word("outcome", cell.outcome, compare::outcome_names());
    f("status", cell.status);
    f("solved_by", cell.solved_by);
    f.count("contacts", cell.contacts);
    f.count("iterations", cell.iterations);
    f.known("seconds", cell.seconds);
    f.known("peak_mb", cell.peak_mb);
    f.known("siconos", cell.siconos);
    f.known("rr9118", cell.rr9118);
    f.known("scaled", cell.scaled);
    f.known("own_residual", cell.own);
    f("message", cell.message);
    f("command", cell.command);
  }
};
/// A cell's identity: the problem, and the variant.
inline std::pair<std::string, std::string> key(const Cell& cell) { return {cell.problem, cell.variant}; }

/// The cell of a process that has ended and of the JSON it left ("" or torn: none). Outcomes: Solved, Infeasible,
/// Failed, NotApplicable, TimeLimit, MemoryLimit, Crashed.
Cell cell_of(const compare::ProcessEnd& end, const std::string& json, const compare::ProcessLimits& limits);

using compare::cell_line;
using CellsRead = compare::CellsOf<Cell>;
/// Of the text of a cells.jsonl.
inline CellsRead parse_cells(std::string_view text) { return compare::cells_of_lines<Cell>(text); }

/// RFC 4180: header, then one line a cell. Empty: not known.
std::string cells_csv(std::span<const Cell> cells);
std::string cells_json(std::span<const Cell> cells);

}  // namespace perp::app::contacts
