// SPDX-License-Identifier: Apache-2.0
#include "contact/io/read.hpp"

#include "contact/io/dat_file.hpp"
#include "contact/io/fclib.hpp"
#include "contact/io/hdf5.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::contact {
Problem read_problem(const std::string& path) {
  const std::string content = lcp::read_file(path);
  if (find_hdf5(content) != std::string::npos) {
    if (path.ends_with(".dat"))
      throw lcp::FileError(path, 0, "an HDF5 file with the ending of a text file; rename it to .hdf5");
    return parse_fclib(content, path).problem;
  }
  if (path.ends_with(".hdf5") || path.ends_with(".h5"))
    throw lcp::FileError(path, 0, "not an HDF5 file: it has no HDF5 signature");
  return parse_dat(content, path);
}

}  // namespace perp::contact
