// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Files are written to a draft beside them and then renamed, so that they are whole or not there, whatever ends the
/// program meanwhile. The draft is synced before it is renamed (Pillai et al., "All file systems are not created
/// equal", OSDI 2014). What was there is untouched until then, and keeps its permissions. A symbolic link stays one,
/// and what it leads to is replaced. Standard streams (/dev/stdout, /dev/fd/N), character devices and named pipes are
/// written in place.
#include <memory>
#include <string>
#include <string_view>

#include "lcp/io/file_error.hpp"

namespace perp::lcp {

enum class Sync {
  Yes,  ///< content and name are on the disk when the call returns
  No,   ///< whole or not at all while the machine runs: for files that do not outlive the program
};

/// One file, for several that belong together: all drafts first, then replace() of each. Errors are FileError with the
/// path as it was given and the system's reason.
class OutputFile {
 public:
  /// Writes the draft, or keeps the content where there is none.
  OutputFile(const std::string& path, std::string_view content, Sync sync = Sync::Yes);
  /// Removes a draft that has not replaced anything.
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;

  /// To be called once.
  void replace();

 private:
  struct Draft;
  std::unique_ptr<Draft> draft_;
};

void write_file(const std::string& path, std::string_view content, Sync sync = Sync::Yes);

/// Throws FileError if write_file() would fail as things are: no such folder, a folder, no permission.
void check_writable(const std::string& path);

/// Would writing to `path` replace a file (or make one), rather than go into a stream or device?
bool replaces(const std::string& path);

/// One file, by whatever names: of files that exist by device and inode, of others by folder and name, where links
/// lead.
bool same_file(const std::string& a, const std::string& b);

}  // namespace perp::lcp
