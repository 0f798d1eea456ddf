// SPDX-License-Identifier: Apache-2.0
#include "app/compare/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "app/program/files.hpp"
#include "app/program/program.hpp"

namespace perp::app::compare {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, int error) {
  throw input_error("'{}': {}", path, std::strerror(error));  // NOLINT(concurrency-mt-unsafe): glibc's is
}

/// So that a new file's name is on the disk, too.
void sync_directory(const std::string& dir) {
  const int file = open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  fsync(file);
  close(file);
}

}  // namespace

DirectoryLock::DirectoryLock(const std::string& dir) {
  const std::string path = dir + "/lock";
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file_ < 0) refuse(path, errno);
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    close(file_);
    if (error != EWOULDBLOCK) refuse(path, error);
    std::string who = read_text(path);
    while (who.ends_with('\n')) who.pop_back();
    throw input_error("'{}': another campaign is at work there{}", dir,
                      who.empty() ? "" : fmt::format(" (process {})", who));
  }
  const std::string pid = fmt::format("{}\n", getpid());
  if (ftruncate(file_, 0) != 0 || write(file_, pid.data(), pid.size()) < 0) {
    const int error = errno;
    close(file_);
    refuse(path, error);
  }
}

DirectoryLock::~DirectoryLock() { close(file_); }

LineJournal::LineJournal(const std::string& dir) : path_(dir + "/cells.jsonl") {
  file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) refuse(path_, errno);
  before_ = read_text(path_);
  if (!before_.empty() && !before_.ends_with('\n')) {
    const std::size_t whole = before_.rfind('\n') + 1;  // npos + 1 is 0
    if (ftruncate(file_, static_cast<off_t>(whole)) != 0) {
      const int error = errno;
      close(file_);
      refuse(path_, error);
    }
  }
  fsync(file_);
  sync_directory(dir);
}

LineJournal::~LineJournal() { close(file_); }

void LineJournal::add(const std::string& line) {
  const std::scoped_lock lock(mutex_);
  struct stat before {};
  if (fstat(file_, &before) != 0) refuse(path_, errno);
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t n = write(file_, line.data() + done, line.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int error = n < 0 ? errno : EIO;
      if (ftruncate(file_, before.st_size) != 0) refuse(path_, errno);
      refuse(path_, error);
    }
    done += static_cast<std::size_t>(n);
  }
  if (fdatasync(file_) != 0) refuse(path_, errno);
}

void make_directory(const std::string& dir, bool fresh) {
  std::error_code error;
  if (fs::exists(dir, error) && !fs::is_directory(dir, error)) throw input_error("'{}' is a file", dir);
  fs::create_directories(dir, error);
  if (error) throw input_error("'{}' cannot be made: {}", dir, error.message());
  const auto others = [](const fs::directory_entry& entry) { return entry.path().filename() != "lock"; };
  if (fresh && std::any_of(fs::directory_iterator(dir, error), fs::directory_iterator{}, others)) {
    const bool campaign = fs::exists(dir + "/campaign.json", error);
    throw input_error("'{}' {}", dir,
                      campaign ? "holds a campaign: --resume goes on with it, --out DIR begins another"
                               : "is not empty: --out DIR names another");
  }
}

}  // namespace perp::app::compare
