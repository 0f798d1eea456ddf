// SPDX-License-Identifier: Apache-2.0
/// Damaged files: cut short anywhere, bytes changed anywhere. They are read or refused by FileError; nothing else may
/// come out, least of all the end of the process (under AddressSanitizer: any access out of bounds).
#include <gmock/gmock.h>

#include <cstring>

#include "contact/contact_support.hpp"
#include "contact/io/dat_file.hpp"
#include "contact/io/fclib_support.hpp"
#include "contact/io/hdf5.hpp"

namespace perp::contact {
namespace {

using lcp::FileError;
using support::Random;

enum class Outcome { Read, Refused };

template <class Parse>
Outcome outcome(Parse parse, const std::string& content) {
  try {
    const auto file = parse(content, "damaged");
    static_cast<void>(file);
    return Outcome::Read;
  } catch (const FileError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("damaged"));
    return Outcome::Refused;
  }
}

Outcome fclib(const std::string& content) {
  return outcome([](const std::string& bytes, const std::string& name) { return parse_fclib(bytes, name); }, content);
}

Outcome dat(const std::string& content) {
  return outcome([](const std::string& bytes, const std::string& name) { return parse_dat(bytes, name); }, content);
}

/// One to three bytes, bits or 8-byte words changed, to what tends to hurt.
std::string damaged(std::string bytes, Random& random) {
  const auto last = static_cast<int>(bytes.size()) - 1;
  for (int k = random.integer(1, 3); k > 0; --k) {
    const auto at = static_cast<std::size_t>(random.integer(0, last));
    char& byte = bytes[at];
    switch (random.integer(0, 4)) {
      case 0:
        byte = static_cast<char>(random.integer(0, 255));
        break;
      case 1:
        byte = static_cast<char>(byte ^ (1 << random.integer(0, 7)));
        break;
      case 2:
        byte = static_cast<char>(0xff);
        break;
      case 3:
        byte = 0;
        break;
      default:
        for (std::size_t j = at; j < std::min(at + 8, bytes.size()); ++j)
          bytes[j] = static_cast<char>(random.chance(0.7) ? 0xff : random.integer(0, 255));
    }
  }
  return bytes;
}

// The superblock says where the file ends.
TEST(Damaged, FclibCutShort) {
  for (const Datasets& datasets : {small_local(), small_global()}) {
    const std::string bytes = bytes_of(datasets);
    ASSERT_EQ(fclib(bytes), Outcome::Read);
    for (std::size_t size = 0; size < bytes.size(); size += size < 2048 ? 1 : 37)
      EXPECT_EQ(fclib(bytes.substr(0, size)), Outcome::Refused) << size;
  }
}

// The message names the part of the file and its place, in unity builds, too: there, another file's function of the
// same name once took the call.
TEST(Damaged, SaysWhichPartIsCutOff) {
  const std::string bytes = bytes_of(small_local());
  const std::string cut = bytes.substr(0, bytes.size() - 1);
  EXPECT_THAT(
      [&] { parse_fclib(cut, "cut.hdf5"); },
      testing::ThrowsMessage<FileError>(testing::HasSubstr("superblock at byte 0: it says that the file ends")));
}

TEST(Damaged, Fclib) {
  Random random(31);
  for (const Datasets& datasets : {small_local(), small_global()}) {
    const std::string bytes = bytes_of(datasets);
    int refused = 0;
    for (int k = 0; k < 1500; ++k) refused += fclib(damaged(bytes, random)) == Outcome::Refused ? 1 : 0;
    EXPECT_GT(refused, 300);
    EXPECT_LT(refused, 1350);
  }
}

// All metadata, byte by byte: each to 0, to 0xff, and one more.
TEST(Damaged, FclibEveryByteOfTheHead) {
  const std::string bytes = bytes_of(small_local());
  for (std::size_t at = 0; at < 800; ++at)
    for (const int change : {0, 0xff, bytes[at] + 1}) {
      std::string other = bytes;
      other[at] = static_cast<char>(change);
      static_cast<void>(fclib(other));
    }
}

// A group that contains itself, names and nodes that point to each other: no loop, no overflow of the stack.
TEST(Damaged, FclibThatContainsItself) {
  const std::string bytes = bytes_of(small_local());
  int loops = 0;
  // Words of the head become in turn the root's object header, its B-tree, its heap.
  for (const std::size_t from : {64U, 80U, 88U})
    for (std::size_t at = 0; at + 8 <= std::min<std::size_t>(bytes.size(), 8000); at += 24) {
      std::string other = bytes;
      std::memcpy(other.data() + at, bytes.data() + from, 8);
      loops += fclib(other) == Outcome::Refused ? 1 : 0;
    }
  EXPECT_GT(loops, 40);
}

TEST(Damaged, Dat) {
  Random random(32);
  const std::string dense = "2 1 0 2 2 2 2 1 2 3 4 -5 6e0 0.25";
  const std::string blocks =
      "2 2 1 4 4 3 2 2 2 4 2 4 3 3 0 2 3 0 1 1 0 1 2 3 4 1 5 6 7 8 2 9 10 0 12 -1 -2 -3 -4 0.5 0.25 0";
  const std::string global = "2 1 0 2 2 2 2 2 0 0 4 0 2 2 2 2 1 2 3 4 2 4 10 20 0.5 1";
  const std::string columns =
      "2 1 2 2 2 2\nCSparse 3\n2-by-2, nzmax: 3 nnz: 3, 1-norm: 4\ncol 0 : locations 0 to 1\n0 : 1\n1 : 2\n"
      "col 1 : locations 2 to 2\n1 : 4\n-5 6e0\n0.25";
  for (const std::string& text : {dense, blocks, global, columns}) {
    int refused = 0;
    for (int k = 0; k < 3000; ++k) refused += dat(damaged(text, random)) == Outcome::Refused ? 1 : 0;
    EXPECT_GT(refused, 300);
    for (int k = 0; k < 1000; ++k) {
      std::string other = text;
      for (int j = random.integer(1, 3); j > 0; --j)
        other[static_cast<std::size_t>(random.integer(0, static_cast<int>(other.size()) - 1))] =
            "0123456789 -.e+"[random.integer(0, 14)];
      static_cast<void>(dat(other));
    }
  }
}

// The smallest files of the record, of which most bytes are data.
TEST(Damaged, RecordedFiles) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  Random random(33);
  for (const char* name : {"Box_Stacks-i0035-31-0.hdf5", "CubeH8.hdf5", "fclib_local_problem_test.hdf5"}) {
    const std::string bytes = lcp::read_file((recorded_folder / name).string());
    for (int k = 0; k < 100; ++k) static_cast<void>(fclib(damaged(bytes, random)));
  }
}

// At 0, or behind a block of the user's, which is refused.
TEST(Hdf5, FindsTheSignature) {
  const std::string bytes = bytes_of(small_local());
  EXPECT_EQ(find_hdf5(bytes), 0U);
  EXPECT_EQ(find_hdf5(std::string(512, ' ') + bytes), 512U);
  EXPECT_EQ(find_hdf5(std::string(100, ' ') + bytes), std::string::npos);
  EXPECT_EQ(find_hdf5("\x89HDF"), std::string::npos);
  EXPECT_EQ(fclib(std::string(512, ' ') + bytes), Outcome::Refused);
}

// They are refused, with the way out.
TEST(Hdf5, RefusesNewerLayouts) {
  const Folder folder;
  const std::string path = folder / "new.hdf5";
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
  RawFile(path, access).write(small_local());
  H5Pclose(access);
  EXPECT_THAT([&] { read_fclib(path); }, testing::ThrowsMessage<FileError>(
                                             testing::HasSubstr("one of the newer layouts (h5repack rewrites them)")));
}

}  // namespace
}  // namespace perp::contact
