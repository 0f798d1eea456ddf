// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The directory of a campaign while it is at work: the lock, and cells.jsonl, which only grows.
#include <mutex>
#include <string>

#include "app/campaign/cell.hpp"

namespace perp::app::compare {

/// A directory held by one campaign; the lock goes with the process, however that ends.
class DirectoryLock {
 public:
  /// Throws InputError naming who holds it, or why it cannot be locked.
  explicit DirectoryLock(const std::string& dir);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int file_ = -1;
};

/// cells.jsonl, lines as checked_line() makes them, open for appending; several threads may. A line is on the disk when
/// add() returns.
class LineJournal {
 public:
  /// Opens or makes it, and cuts off a torn last line. Throws InputError.
  explicit LineJournal(const std::string& dir);
  ~LineJournal();
  LineJournal(const LineJournal&) = delete;
  LineJournal& operator=(const LineJournal&) = delete;

  const std::string& before() const { return before_; }  ///< what it held, a torn line included
  /// Throws InputError if it cannot be written (a full disk); the line is then cut off again where that is possible.
  void add(const std::string& line);

 private:
  std::string path_;
  std::string before_;
  std::mutex mutex_;
  int file_ = -1;
};

/// The same of a campaign's cells.
template <class AnyCell>
class JournalOf {
 public:
  /// Throws InputError.
  explicit JournalOf(const std::string& dir) : lines_(dir), before_(cells_of_lines<AnyCell>(lines_.before())) {}

  const CellsOf<AnyCell>& before() const { return before_; }  ///< what it held
  /// Throws InputError.
  void add(const AnyCell& cell) { lines_.add(cell_line(cell)); }

 private:
  LineJournal lines_;
  CellsOf<AnyCell> before_;
};
using Journal = JournalOf<Cell>;

/// Makes the directory (and those above it). `fresh`: it is to be new or empty. Throws InputError.
void make_directory(const std::string& dir, bool fresh);

}  // namespace perp::app::compare
