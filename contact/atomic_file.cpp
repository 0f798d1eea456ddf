#include "contact/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "lcp/file_error.hpp"

namespace perp::contact {
namespace {

namespace fs = std::filesystem;

/// A file that is removed unless it is renamed.
class Draft {
 public:
  Draft(const fs::path& target, const std::string& told_as) : told_as_(told_as) {
    constexpr int tries = 100;
    for (int k = 0; k < tries && file_ < 0; ++k) {
      path_ = target.string() + "." + std::to_string(getpid()) + "." + std::to_string(k) + ".part";
      file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (file_ < 0 && errno != EEXIST) break;
    }
    if (file_ < 0) refuse();
  }
  ~Draft() {
    if (file_ >= 0) close(file_);
    if (!renamed_) unlink(path_.c_str());
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  void write(std::string_view content) {
    while (!content.empty()) {
      const ssize_t done = ::write(file_, content.data(), content.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) refuse();
      content.remove_prefix(static_cast<std::size_t>(done));
    }
    if (fsync(file_) != 0 && errno != EINVAL && errno != ENOSYS) refuse();
    if (close(std::exchange(file_, -1)) != 0) refuse();
  }

  void become(const fs::path& target) {
    if (std::rename(path_.c_str(), target.c_str()) != 0) refuse();
    renamed_ = true;
  }

 private:
  [[noreturn]] void refuse() const {
    throw lcp::FileError(told_as_, 0, "cannot be written: " + std::generic_category().message(errno));
  }

  const std::string& told_as_;
  std::string path_;
  int file_ = -1;
  bool renamed_ = false;
};

}  // namespace

void write_atomically(const std::string& path, std::string_view content) {
  std::error_code error;
  fs::path target = path;
  // The file a link leads to is replaced, not the link.
  if (fs::is_symlink(fs::symlink_status(target, error))) {
    const fs::path real = fs::weakly_canonical(target, error);
    if (!error) target = real;
  }
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw lcp::FileError(path, 0, "cannot be written: it is there and no regular file");
  Draft draft(target, path);
  draft.write(content);
  draft.become(target);
}

}  // namespace perp::contact
