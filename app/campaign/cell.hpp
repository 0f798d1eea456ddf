// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One cell of a comparison, (method, problem, start), and the files of a campaign that hold them.
///
/// DIR/cells.jsonl has one line a finished cell and only ever grows:
///     {"cell":{...},"crc":"xxxxxxxx"}
/// with the CRC-32 (that of zlib, polynomial 0xEDB88320) of the text of the cell object, from its { to its }. A line
/// that is torn, or whose text does not fit its CRC, does not count, wherever it stands. DIR/cells.csv, cells.json and
/// outcomes.csv are made from it.
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/text/json_fields.hpp"

namespace perp::app::compare {

/// How a cell ended, in one word. The judge's word counts: the natural residual of the original problem at the point
/// returned, evaluated outside of the method, is at most the tolerance or not.
enum class Outcome {
  Solved,            ///< claimed, and the judge agrees
  SolvedToRounding,  ///< claimed as far as doubles go, not to the tolerance, and the judge agrees: never added to
                     ///< solved
  Failed,            ///< the method itself says that it has not
  FalseConvergence,  ///< claimed, and the judge disagrees
  Unclaimed,         ///< the judge calls the point a solution, the method did not
  TimeLimit,         ///< its own limit, or killed
  MemoryLimit,
  Crashed,          ///< a signal, which the message names, or an exit nobody expected
  Garbage,          ///< of an external program: no .sol file, an unreadable one, one of other sizes
  NotApplicable,    ///< the method is not for this problem
  Infeasible,       ///< rightly: there is no solution, as is known or as the method has proven, and it says so
  FalseInfeasible,  ///< claims that there is none although one is known
};
/// In the order of the enumeration: "solved", "failed", "false-convergence", ...
std::span<const std::string_view> outcome_names();
std::string_view to_string(Outcome outcome);
/// Throws InputError for a word that is none.
Outcome outcome_of(std::string_view name);

inline constexpr std::size_t longest_curve = 200;

struct Cell {
  std::string method{};   ///< label, as campaign.json has it
  std::string problem{};  ///< label
  int start = 1;          ///< from 1
  Outcome outcome = Outcome::Failed;
  std::string status{};  ///< the solver's own word: "Solved", "NoProgress", ...; of a .sol file "solve_result_num 0"
  bool claimed = false;  ///< does the solver say that it has solved it?
  double natural = std::numeric_limits<double>::quiet_NaN();  ///< judge's residual; NaN where no point came back
  /// Of the run from the start itself, not of those after it; -1 where not known (external programs, killed ones).
  int iterations = -1;
  int F_evals = -1;
  int J_evals = -1;
  int factorizations = -1;
  int krylov_iterations = -1;
  double seconds = 0;  ///< wall clock of the solve; of a killed run, of the process
  double peak_mb = 0;  ///< largest resident memory of the process in MiB (problem included)
  int restarts = 0;    ///< runs from perturbed starts, tried one after another where the first failed
  Outcome outcome_after_restarts = Outcome::Failed;  ///< of the last run; `outcome` where there was no other
  std::string message{};
  std::vector<double> curve{};  ///< natural residual from the start on, thinned evenly to at most longest_curve points

  /// The keys of cells.jsonl and cells.json (app/text/json_fields.hpp).
  static void fields(auto& f, auto& cell) {
    f("method", cell.method);
    f("problem", cell.problem);
    f("start", cell.start);
    f.word("outcome", cell.outcome, outcome_names());
    f("status", cell.status);
    f("claimed", cell.claimed);
    f("natural", cell.natural);
    f.count("iterations", cell.iterations);
    f.count("F_evals", cell.F_evals);
    f.count("J_evals", cell.J_evals);
    f.count("factorizations", cell.factorizations);
    f.count("krylov_iterations", cell.krylov_iterations);
    f("seconds", cell.seconds);
    f("peak_mb", cell.peak_mb);
    f("restarts", cell.restarts);
    f.word("outcome_after_restarts", cell.outcome_after_restarts, outcome_names());
    f("message", cell.message);
    f("curve", cell.curve);
  }
};

/// Is this end what one wants of the problem: solved, or rightly found infeasible?
bool good(Outcome outcome);

/// method, problem, start: a cell's identity. Orders as the derived files are sorted.
struct CellKey {
  std::string method{};
  std::string problem{};
  int start = 1;
  auto operator<=>(const CellKey&) const = default;  // NOLINT(modernize-use-nullptr): of the 0 compared with
};
CellKey key(const Cell& cell);

/// The CRC-32 of zlib: crc32("123456789") = 0xcbf43926.
std::uint32_t crc32(std::string_view text);
/// Of what is in a file, as 8 hex digits.
std::string file_crc(const std::string& path);

/// {"cell":OBJECT,"crc":"8 hex digits"}, with its newline: how a JSON object without line breaks stands in a file of
/// cells.
std::string checked_line(std::string_view object);
/// The object of such a line without its newline. Throws InputError: torn, CRC wrong.
std::string_view checked_object(std::string_view line);
/// What does not count of a file of such lines.
struct LinesRead {
  std::vector<std::string> dropped;  ///< with number and reason
  bool torn = false;                 ///< the last line has no newline: it was being written
};
/// Calls take(object) line by line. Lines that are torn or corrupt, and those where it throws InputError, are dropped.
LinesRead read_checked_lines(std::string_view text, const std::function<void(std::string_view)>& take);

/// A line of cells.jsonl, with its newline: infinities as "inf", NaN as "nan", -1 for counts not known as null.
template <class AnyCell>
std::string cell_line(const AnyCell& cell) {
  return checked_line(line_of(json_of(cell)));
}

/// What a cells.jsonl holds: sorted by key(); of two cells with one key the later.
template <class AnyCell>
struct CellsOf : LinesRead {
  std::vector<AnyCell> cells;
};
template <class AnyCell>
CellsOf<AnyCell> cells_of_lines(std::string_view text) {
  std::map<decltype(key(AnyCell{})), AnyCell> cells;
  CellsOf<AnyCell> read;
  static_cast<LinesRead&>(read) = read_checked_lines(text, [&](std::string_view object) {
    AnyCell cell = row_of<AnyCell>(json_object(object));
    cells.insert_or_assign(key(cell), std::move(cell));
  });
  for (auto& [identity, cell] : cells) read.cells.push_back(std::move(cell));
  return read;
}

using CellsRead = CellsOf<Cell>;
/// Of the text of a cells.jsonl.
CellsRead parse_cells(std::string_view text);
/// Of DIR/cells.jsonl. Throws InputError if it cannot be read.
CellsRead read_cells(const std::string& dir);

/// Columns of cells.csv, and those of outcomes.csv: those that do not depend on time and memory.
std::span<const std::string_view> csv_columns();
std::span<const std::string_view> outcome_columns();
/// RFC 4180: header, then one line a cell; fields with comma, quote or line break in quotes. Empty: not known.
std::string cells_csv(std::span<const Cell> cells);
/// Two runs of one campaign can be compared by it with cmp: where a run was ended by a limit, what it had reached until
/// then is left empty.
std::string outcomes_csv(std::span<const Cell> cells);
/// All that cells.csv has and the curves, as one array.
std::string cells_json(std::span<const Cell> cells);

}  // namespace perp::app::compare
