// SPDX-License-Identifier: Apache-2.0
/// Files written whole or not at all: what POSIX says of rename (IEEE 1003.1, "shall remain visible") and open with
/// O_EXCL, tried with disks that fill up (RLIMIT_FSIZE, /dev/full), links, pipes and names of the greatest length.
#include "lcp/io/output_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <vector>

namespace perp::lcp {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A folder that lives as long as the object.
class Folder {
 public:
  Folder() {
    std::string pattern = testing::TempDir() + "perp-output-XXXXXX";
    path_ = mkdtemp(pattern.data());
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(path_), fs::directory_iterator()); }

 private:
  std::string path_;
};

std::string refusal(const std::string& path, const std::string& content = "text") {
  try {
    write_file(path, content);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

mode_t mode(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
}

// Would catch a draft that stays, a link replaced by a file, permissions lost or widened by the umask.
TEST(OutputFile, ReplacesAndKeepsPermissionsAndLinks) {
  const Folder folder;
  write_file(folder / "a", "one");
  for (const mode_t kept : {0600U, 0666U, 0755U}) {
    ASSERT_EQ(chmod((folder / "a").c_str(), kept), 0);
    write_file(folder / "a", "two");
    EXPECT_EQ(mode(folder / "a"), kept);
  }
  fs::create_symlink("a", folder / "link");
  fs::create_symlink("link", folder / "link to link");
  write_file(folder / "link to link", "three");
  EXPECT_TRUE(fs::is_symlink(folder / "link to link"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_file(folder / "a"), "three");
  EXPECT_EQ(folder.files(), 3);
  fs::create_symlink("nowhere", folder / "dangling");
  write_file(folder / "dangling", "four");
  EXPECT_TRUE(fs::is_symlink(folder / "dangling"));
  EXPECT_EQ(read_file(folder / "nowhere"), "four");
  fs::create_symlink("circle", folder / "circle");
  EXPECT_THAT(refusal(folder / "circle"), HasSubstr("circle: cannot be written: "));
}

// The name of the draft must not be longer than the target's may be, nor known beforehand: a link under the name that
// earlier versions took would have been followed.
TEST(OutputFile, DraftsHaveNamesOfTheirOwn) {
  const Folder folder;
  const std::string longest(255, 'x');
  write_file(folder / longest, "one");
  write_file(folder / longest, "two");
  EXPECT_EQ(read_file(folder / longest), "two");
  EXPECT_THAT(refusal(folder / (longest + "x")), HasSubstr("File name too long"));
  EXPECT_THROW(check_writable(folder / (longest + "x")), FileError);
  write_file(folder / "victim", "kept");
  fs::create_symlink("victim", folder / ("a." + std::to_string(getpid()) + ".tmp"));
  write_file(folder / "a", "one");
  EXPECT_EQ(read_file(folder / "victim"), "kept");
}

// A disk that is full after `room` bytes, in a child.
TEST(OutputFile, DiskThatFillsUp) {
  const Folder folder;
  write_file(folder / "old", "old");
  const std::string content(100'000, 'x');
  for (const rlim_t room : {0U, 1U, 4096U, 99'999U}) {
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{room, room};
      setrlimit(RLIMIT_FSIZE, &limit);
      const std::string why = refusal(folder / "old", content) + refusal(folder / "new", content);
      _exit(why.find("old: cannot be written: File too large") != std::string::npos &&
                    why.find("new: cannot be written: File too large") != std::string::npos
                ? 0
                : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0) << room;
    EXPECT_EQ(read_file(folder / "old"), "old") << room;
    EXPECT_EQ(folder.files(), 1) << room;
  }
}

// All drafts before the first replacement: where the second does not fit, the first is as it was.
TEST(OutputFile, SeveralThatBelongTogether) {
  const Folder folder;
  write_file(folder / "a", "old");
  {
    std::vector<OutputFile> drafts;
    drafts.emplace_back(folder / "a", "new");
    EXPECT_THROW(drafts.emplace_back(folder / "none/b", "new"), FileError);
    EXPECT_EQ(read_file(folder / "a"), "old");
    EXPECT_EQ(folder.files(), 2);  // the draft
  }
  EXPECT_EQ(folder.files(), 1);
  OutputFile a(folder / "a", "new");
  OutputFile b(folder / "b", "new");
  OutputFile c = std::move(b);
  a.replace();
  c.replace();
  EXPECT_EQ(read_file(folder / "a") + read_file(folder / "b"), "newnew");
  EXPECT_EQ(folder.files(), 2);
}

TEST(OutputFile, DevicesAndPipesAreWrittenInPlace) {
  const Folder folder;
  write_file("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(refusal("/dev/full"), AllOf(HasSubstr("/dev/full: cannot be written: No space left")));
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::string content(200'000, 'y');  // more than a pipe holds
  std::string read;
  std::thread reader([&] { read = read_file(folder / "pipe"); });
  write_file(folder / "pipe", content);
  reader.join();
  EXPECT_EQ(read, content);
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
  EXPECT_EQ(folder.files(), 1);
}

// `perp ... --json /dev/stdout > log`: what the log has already stays. A draft would have replaced the file and what
// was printed would have gone with the old one; a second opening would have begun at its first byte.
TEST(OutputFile, AStandardStreamThatIsAFile) {
  const Folder folder;
  const int log = open((folder / "log").c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_GE(log, 0);
  ASSERT_EQ(write(log, "printed\n", 8), 8);
  const std::string name = "/dev/fd/" + std::to_string(log);
  EXPECT_FALSE(replaces(name));
  write_file(name, "written\n");
  ASSERT_EQ(write(log, "printed\n", 8), 8);
  close(log);
  EXPECT_EQ(read_file(folder / "log"), "printed\nwritten\nprinted\n");
  EXPECT_NE(refusal(name), "");  // it is closed
}

TEST(OutputFile, RefusalsNameTheFileAndTheReason) {
  const Folder folder;
  EXPECT_THAT(refusal(folder / ""), HasSubstr(": cannot be written: "));
  EXPECT_THAT(refusal(""), HasSubstr("cannot be written: "));
  EXPECT_THAT(refusal(folder / "none/a"), HasSubstr("none/a: cannot be written: there is no folder of that name"));
  EXPECT_THAT(refusal(fs::path(folder / "x").parent_path()), HasSubstr("it is a directory"));
  for (const std::string& path : {folder / "", folder / "none/a", std::string()})
    EXPECT_THROW(check_writable(path), FileError) << path;
  EXPECT_NO_THROW(check_writable(folder / "a"));
  EXPECT_EQ(folder.files(), 0);
}

TEST(OutputFile, RefusesWithoutPermission) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const Folder folder;
  write_file(folder / "a", "old");
  ASSERT_EQ(chmod((folder / "a").c_str(), 0400), 0);
  EXPECT_THAT(refusal(folder / "a"), HasSubstr("a: cannot be written: Permission denied"));
  EXPECT_THROW(check_writable(folder / "a"), FileError);
  ASSERT_EQ(chmod((folder / "a").c_str(), 0600), 0);
  ASSERT_EQ(chmod((folder / ".").c_str(), 0500), 0);
  EXPECT_THROW(check_writable(folder / "a"), FileError);  // no draft can be made
  EXPECT_THAT(refusal(folder / "a"), HasSubstr("Permission denied"));
  chmod((folder / ".").c_str(), 0700);
  EXPECT_EQ(read_file(folder / "a"), "old");
}

TEST(OutputFile, OneFileByManyNames) {
  const Folder folder;
  write_file(folder / "a", "one");
  write_file(folder / "b", "one");
  fs::create_symlink("a", folder / "link");
  fs::create_hard_link(folder / "a", folder / "hard");
  fs::create_directory(folder / "d");
  fs::create_directory_symlink("d", folder / "e");
  fs::create_symlink("d/new", folder / "dangling");
  for (const char* other : {"a", "link", "hard", "./a", "d/../a"})
    EXPECT_TRUE(same_file(folder / "a", folder / other)) << other;
  EXPECT_FALSE(same_file(folder / "a", folder / "b"));
  EXPECT_FALSE(same_file(folder / "a", folder / "new"));
  for (const char* other : {"d/new", "e/new", "dangling", "d/../e/new"})
    EXPECT_TRUE(same_file(folder / "d/new", folder / other)) << other;
  EXPECT_FALSE(same_file(folder / "d/new", folder / "d/other"));
  EXPECT_FALSE(same_file(folder / "none/new", folder / "absent/new"));
  EXPECT_TRUE(replaces(folder / "a"));
  EXPECT_TRUE(replaces(folder / "new"));
  EXPECT_FALSE(replaces("/dev/null"));
}

}  // namespace
}  // namespace perp::lcp
