// SPDX-License-Identifier: Apache-2.0
/// Promises of the headers about files, streams, signals and threads, of the implementations for other systems than
/// Linux.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>

#include "app/process.hpp"
#include "app/program/signals.hpp"
#include "app/program/thread.hpp"
#include "capi/sigint.hpp"
#include "lcp/io/output_file.hpp"
#include "lcp/memory.hpp"
#include "ncp/ampl/memory_stream.hpp"

namespace perp {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder of the test's own, empty at its start and removed at its end.
class PortableFiles : public testing::Test {
 protected:
  PortableFiles() { fs::create_directories(folder_); }
  ~PortableFiles() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }
  static std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static std::string refusal(const std::string& path) {
    try {
      lcp::write_file(path, "text");
    } catch (const lcp::FileError& error) {
      return error.what();
    }
    return "";
  }

 private:
  fs::path folder_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

// Catches a draft that stays, text that is translated, and a file that is touched before it is replaced.
TEST_F(PortableFiles, WhatWasThereStaysUntilItIsReplaced) {
  const std::string path = in("with a blank \xC3\xA4.txt");
  lcp::write_file(path, "first\n");
  {
    const lcp::OutputFile dropped(path, "dropped");
    EXPECT_EQ(content(path), "first\n");
  }
  EXPECT_EQ(files(), 1);
  lcp::OutputFile second(path, "second\n");
  second.replace();
  EXPECT_EQ(content(path), "second\n");
  EXPECT_EQ(files(), 1);
}

TEST_F(PortableFiles, LinksStayLinks) {
  lcp::write_file(in("file"), "old");
  fs::create_symlink("file", in("link"));
  lcp::write_file(in("link"), "new");
  EXPECT_TRUE(fs::is_symlink(in("link")));
  EXPECT_EQ(content(in("file")), "new");
}

TEST_F(PortableFiles, RefusesWithTheReason) {
  EXPECT_THAT(refusal(in("missing/file")), HasSubstr("cannot be written: there is no folder of that name"));
  EXPECT_THAT(refusal(in("")), HasSubstr("it is a directory"));
  EXPECT_THAT(refusal(""), HasSubstr("it has no name"));
  lcp::write_file(in("kept"), "kept");
  fs::permissions(in("kept"), fs::perms::owner_read);
  EXPECT_THAT(refusal(in("kept")), HasSubstr("cannot be written"));
  EXPECT_EQ(content(in("kept")), "kept");
}

TEST_F(PortableFiles, KnowsOneFileByItsNames) {
  lcp::write_file(in("a"), "a");
  lcp::write_file(in("b"), "b");
  EXPECT_TRUE(lcp::same_file(in("a"), in("../" + fs::path(in("")).parent_path().filename().string() + "/a")));
  EXPECT_FALSE(lcp::same_file(in("a"), in("b")));
  EXPECT_TRUE(lcp::same_file(in("not yet"), in("./not yet")));
  EXPECT_TRUE(lcp::replaces(in("a")));
  EXPECT_TRUE(lcp::replaces(in("not yet")));
#ifndef _WIN32
  EXPECT_FALSE(lcp::replaces("/dev/null"));
  EXPECT_EQ(refusal("/dev/null"), "");
#endif
}

TEST(PortableMemory, IsNotKnown) { EXPECT_GT(lcp::available_memory(), 1e15); }

// Catches a message that is lost after text() has looked at those before it.
TEST(PortableStreams, KeepWhatIsPrintedAndGiveWhatIsRead) {
  const ncp::ampl::Messages messages;
  EXPECT_EQ(messages.text(), "");
  std::fprintf(messages.stream(), "bad line 3\n");
  EXPECT_EQ(messages.text(), "bad line 3");
  std::fprintf(messages.stream(), "of\tfile\n");
  EXPECT_EQ(messages.text(), "bad line 3 of file");
  std::FILE* stream = ncp::ampl::stream_of(std::string_view("a\0\r\nb", 5));
  std::array<char, 8> read{};
  EXPECT_EQ(std::fread(read.data(), 1, read.size(), stream), 5u);
  EXPECT_EQ(std::string_view(read.data(), 5), std::string_view("a\0\r\nb", 5));
  std::fclose(stream);
}

std::atomic<int> handled{0};
extern "C" void perp_test_handler(int) { ++handled; }

// Catches an interpreter's handler that is not called, or not put back.
TEST(PortableSignals, InterruptStopsAndThenDoesWhatItDid) {
  std::atomic<bool> stop{false};
  {
    const capi::StopOnInterrupt ends_the_process(&stop);
    EXPECT_EQ(std::signal(SIGINT, perp_test_handler), SIG_DFL);
  }
  {
    const capi::StopOnInterrupt heeded(&stop);
    std::raise(SIGINT);
    EXPECT_TRUE(stop);
    EXPECT_EQ(handled, 1);
    std::raise(SIGINT);
    EXPECT_EQ(handled, 2);
  }
  EXPECT_EQ(std::signal(SIGINT, SIG_DFL), perp_test_handler);
}

TEST(PortableSignals, TheFirstSetsTheFlagAndTheSecondEnds) {
  static std::atomic<bool> interrupted{false};
  app::wait_for_signals(interrupted);
  EXPECT_FALSE(interrupted);
  std::raise(SIGINT);
  EXPECT_TRUE(interrupted);
  EXPECT_EXIT(std::raise(SIGINT), testing::KilledBySignal(SIGINT), "");
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

TEST(PortableThreads, WorkAndEndTheProcess) {
  std::promise<int> answer;
  EXPECT_TRUE(app::start_thread([&answer] { answer.set_value(7); }));
  EXPECT_EQ(answer.get_future().get(), 7);
  EXPECT_EXIT(app::leave("perp: interrupted\n", 3), testing::ExitedWithCode(3), "perp: interrupted");
  EXPECT_EXIT(app::end_process(4), testing::ExitedWithCode(4), "");
}

}  // namespace
}  // namespace perp
