// SPDX-License-Identifier: Apache-2.0
#include "contact/io/read.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "contact/contact_support.hpp"
#include "contact/io/fclib.hpp"
#include "contact/io/fclib_support.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::contact {
namespace {

using lcp::FileError;
using support::vec;
using testing::HasSubstr;
using testing::ThrowsMessage;

const char* const small_dat = "2\n1\n0\n2\n2\n2 2\n1 2\n3 4\n-5 6\n0.25\n";

void write(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

// By content, whatever the name, unless the name says the contrary.
TEST(ReadProblem, GoesByContent) {
  const Folder folder;
  write(folder / "a.dat", small_dat);
  EXPECT_EQ(read_problem(folder / "a.dat").q, vec({-5, 6}));
  write(folder / "problem", small_dat);
  EXPECT_EQ(read_problem(folder / "problem").mu, vec({0.25}));
  write_fclib(folder / "b.hdf5", {.problem = read_problem(folder / "a.dat")});
  EXPECT_EQ(read_problem(folder / "b.hdf5").q, vec({-5, 6}));
  std::filesystem::copy(folder / "b.hdf5", folder / "bare");
  EXPECT_EQ(read_problem(folder / "bare").q, vec({-5, 6}));
}

TEST(ReadProblem, RefusesWrongNames) {
  const Folder folder;
  write(folder / "text.hdf5", small_dat);
  EXPECT_THAT([&] { read_problem(folder / "text.hdf5"); },
              ThrowsMessage<FileError>(HasSubstr("text.hdf5: not an HDF5 file: it has no HDF5 signature")));
  write_fclib(folder / "b.hdf5", {.problem = parse_small()});
  std::filesystem::rename(folder / "b.hdf5", folder / "b.dat");
  EXPECT_THAT([&] { read_problem(folder / "b.dat"); },
              ThrowsMessage<FileError>(HasSubstr("b.dat: an HDF5 file with the ending of a text file")));
  EXPECT_THAT([&] { read_problem(folder / "none.dat"); }, ThrowsMessage<FileError>(HasSubstr("none.dat")));
  EXPECT_THAT([&] { read_problem(folder / ""); }, ThrowsMessage<FileError>(HasSubstr("directory")));
  write(folder / "empty.hdf5", "");
  EXPECT_THAT([&] { read_problem(folder / "empty.hdf5"); }, ThrowsMessage<FileError>(HasSubstr("no HDF5 signature")));
}

}  // namespace
}  // namespace perp::contact
