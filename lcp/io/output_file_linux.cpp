// SPDX-License-Identifier: Apache-2.0
#include "lcp/io/output_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

namespace perp::lcp {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw FileError(path, 0, "cannot be written: " + why);
}
[[noreturn]] void refuse(const std::string& path, int error) { refuse(path, std::generic_category().message(error)); }

class Descriptor {
 public:
  explicit Descriptor(int file = -1) : file_(file) {}
  Descriptor(Descriptor&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  operator int() const { return file_; }  // NOLINT(google-explicit-constructor)
  /// The error, or 0. (After EINTR Linux has closed it.)
  int close() { return ::close(std::exchange(file_, -1)) == 0 || errno == EINTR ? 0 : errno; }

 private:
  int file_;
};

struct Parts {
  std::string folder;  // not empty
  std::string name;
};

Parts parts_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return {".", path};
  return {slash == 0 ? "/" : path.substr(0, slash), path.substr(slash + 1)};
}

/// The number of a descriptor of this process, of /dev/fd/1 and /proc/self/fd/1.
std::optional<int> descriptor_of(const Parts& parts) {
  int number = 0;
  const char* last = parts.name.data() + parts.name.size();
  const auto [end, error] = std::from_chars(parts.name.data(), last, number);
  if (parts.name.empty() || error != std::errc{} || end != last || number < 0) return std::nullopt;
  std::error_code ignored;
  const std::string folder = fs::canonical(parts.folder, ignored).string();
  const std::string own = "/proc/" + std::to_string(getpid()) + "/";
  if (!folder.starts_with(own) || !folder.ends_with("/fd")) return std::nullopt;
  return number;
}

/// Where an output goes.
struct Place {
  std::string path;                // where links lead
  std::optional<int> descriptor;   // of this process: written as it is, at the place it has come to
  std::optional<struct stat> was;  // what is there
  bool in_place() const { return descriptor || (was && !S_ISREG(was->st_mode)); }
};

/// Throws what follows no link to its end.
Place place_of(const std::string& path) {
  Place place{.path = path, .descriptor = {}, .was = {}};
  constexpr int most_links = 40;  // the kernel's
  for (int k = 0;; ++k) {
    const Parts parts = parts_of(place.path);
    place.descriptor = descriptor_of(parts);
    if (place.descriptor) return place;
    std::array<char, PATH_MAX> link{};
    const ssize_t length = readlink(place.path.c_str(), link.data(), link.size());
    if (length < 0) break;  // no link
    if (k == most_links) refuse(path, ELOOP);
    const std::string leads_to(link.data(), static_cast<std::size_t>(length));
    place.path = leads_to.starts_with('/') ? leads_to : parts.folder + "/" + leads_to;
  }
  struct stat status {};
  if (stat(place.path.c_str(), &status) == 0)
    place.was = status;
  else if (errno != ENOENT)
    refuse(path, errno);
  return place;
}

/// The place of an output, if it is one that can be written at all.
Place fit_place(const std::string& path) {
  Place place = place_of(path);
  if (place.descriptor) return place;
  if (place.was) {
    const mode_t mode = place.was->st_mode;
    if (S_ISDIR(mode)) refuse(path, "it is a directory");
    if (!S_ISREG(mode) && !S_ISCHR(mode) && !S_ISFIFO(mode))
      refuse(path, "it is no regular file, character device or pipe");
    if (faccessat(AT_FDCWD, place.path.c_str(), W_OK, AT_EACCESS) != 0) refuse(path, errno);
  }
  if (place.in_place()) return place;
  const Parts parts = parts_of(place.path);
  std::error_code ignored;
  if (!fs::is_directory(parts.folder, ignored)) refuse(path, "there is no folder of that name");
  if (parts.name.empty()) refuse(path, ENOENT);
  if (faccessat(AT_FDCWD, parts.folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) refuse(path, errno);
  return place;
}

/// All of it; the error, or 0.
int write_all(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t done = ::write(file, content.data(), content.size());
    if (done > 0) {
      content.remove_prefix(static_cast<std::size_t>(done));
    } else if (done == 0) {
      return EIO;
    } else if (errno == EAGAIN) {  // a pipe that its other end has made so
      pollfd wait{.fd = file, .events = POLLOUT, .revents = 0};
      poll(&wait, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

/// The error, or 0, also where the file system cannot.
int sync_file(int file) {
  if (fsync(file) == 0 || errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP) return 0;
  return errno;
}

/// Short, so that there is room for it where there is room for the target's name, and nobody can guess it.
std::string draft_name(const std::string& told_as) {
  std::uint64_t random = 0;
  while (getrandom(&random, sizeof random, 0) != static_cast<ssize_t>(sizeof random))
    if (errno != EINTR) refuse(told_as, errno);
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), ".perp-%016llx.part", static_cast<unsigned long long>(random));
  return text.data();
}

}  // namespace

struct OutputFile::Draft {
  std::string told_as;
  Place place;
  Sync sync = Sync::Yes;
  std::string content{};  // of what is written in place
  Descriptor folder{};
  std::string name{};  // empty: there is no draft

  ~Draft() {
    if (!name.empty()) unlinkat(folder, name.c_str(), 0);
  }

  void write(std::string_view text) {
    folder = Descriptor(open(parts_of(place.path).folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (folder < 0) refuse(told_as, errno);
    Descriptor file = create();
    if (const int error = write_all(file, text); error != 0) refuse(told_as, error);
    if (place.was && fchmod(file, place.was->st_mode & 07777) != 0) refuse(told_as, errno);
    if (const int error = sync == Sync::Yes ? sync_file(file) : 0; error != 0) refuse(told_as, error);
    if (const int error = file.close(); error != 0) refuse(told_as, error);
  }

  /// Nobody reads in it what may not be read in the file it is to become.
  Descriptor create() {
    constexpr int tries = 100;
    const mode_t mode = place.was ? 0600 : 0666;
    for (int k = 0; k < tries; ++k) {
      name = draft_name(told_as);  // before there is a file that could not be told of for want of memory
      Descriptor file(openat(folder, name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
      if (file >= 0) return file;
      name.clear();
      if (errno != EEXIST) break;
    }
    refuse(told_as, errno);
  }

  void rename() {
    if (renameat(folder, name.c_str(), folder, parts_of(place.path).name.c_str()) != 0) refuse(told_as, errno);
    name.clear();
    if (sync == Sync::No) return;
    // The file is whole whether or not its new name has come to the disk, and there is no way back.
    const Descriptor readable(openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (readable >= 0) sync_file(readable);
  }

  void write_in_place() const {
    Descriptor file(place.descriptor ? fcntl(*place.descriptor, F_DUPFD_CLOEXEC, 0)
                                     : open(place.path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (file < 0) refuse(told_as, errno);
    if (const int error = write_all(file, content); error != 0) refuse(told_as, error);
    if (const int error = file.close(); error != 0) refuse(told_as, error);
  }
};

OutputFile::OutputFile(const std::string& path, std::string_view content, Sync sync)
    : draft_(new Draft{.told_as = path, .place = fit_place(path), .sync = sync}) {
  if (draft_->place.in_place())
    draft_->content = content;
  else
    draft_->write(content);
}

OutputFile::~OutputFile() = default;
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;

void OutputFile::replace() {
  if (draft_->place.in_place())
    draft_->write_in_place();
  else
    draft_->rename();
}

void write_file(const std::string& path, std::string_view content, Sync sync) {
  OutputFile(path, content, sync).replace();
}

void check_writable(const std::string& path) { fit_place(path); }

bool replaces(const std::string& path) {
  try {
    return !place_of(path).in_place();
  } catch (const FileError&) {
    return true;  // refused where it is written
  }
}

bool same_file(const std::string& a, const std::string& b) {
  try {
    const Place first = place_of(a);
    const Place second = place_of(b);
    if (first.descriptor || second.descriptor) return first.descriptor == second.descriptor;
    if (first.was && second.was)
      return first.was->st_dev == second.was->st_dev && first.was->st_ino == second.was->st_ino;
    if (first.was || second.was) return false;
    const Parts one = parts_of(first.path);
    const Parts other = parts_of(second.path);
    std::error_code ignored;
    return one.name == other.name && fs::equivalent(one.folder, other.folder, ignored);
  } catch (const FileError&) {
    return a == b;
  }
}

}  // namespace perp::lcp
