#pragma once
/// One cell of `perp contact --compare`, (variant, problem), and the files that hold them.
#include <limits>
#include <span>
#include <string>
#include <vector>

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
};

/// The cell of a process that has ended and of the JSON it left ("" or torn: none). Outcomes: Solved, Infeasible,
/// Failed, NotApplicable, TimeLimit, MemoryLimit, Crashed.
Cell cell_of(const compare::ProcessEnd& end, const std::string& json, const compare::ProcessLimits& limits);

/// A line of cells.jsonl, with its newline (app/campaign/cell.hpp).
std::string cell_line(const Cell& cell);
/// The cells of such a file, of two with the same variant and problem the later; and what does not count of it.
struct CellsRead {
  std::vector<Cell> cells;
  std::vector<std::string> dropped;  ///< lines, with number and reason
};
CellsRead parse_cells(const std::string& text);

/// RFC 4180: header, then one line a cell. Empty: not known.
std::string cells_csv(std::span<const Cell> cells);
std::string cells_json(std::span<const Cell> cells);

}  // namespace perp::app::contacts
