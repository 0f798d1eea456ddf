#pragma once
/// The directory of a campaign while it is at work: the lock, and cells.jsonl, which only grows.
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "app/compare/cell.hpp"

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

/// cells.jsonl, open for appending; several threads may. A cell is on the disk when add() returns.
class Journal {
 public:
  /// Opens or makes it, and cuts off a torn last line. Throws InputError.
  explicit Journal(const std::string& dir);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const CellsRead& before() const { return before_; }  ///< what it held
  /// Throws InputError if it cannot be written (a full disk); the line is then cut off again where that is possible.
  void add(const Cell& cell);

 private:
  std::string path_;
  CellsRead before_;
  std::mutex mutex_;
  int file_ = -1;
};

/// Makes the directory (and those above it). `fresh`: it is to be new or empty. Throws InputError.
void make_directory(const std::string& dir, bool fresh);

}  // namespace perp::app::compare
