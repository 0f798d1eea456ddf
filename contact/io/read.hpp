// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A contact problem from a file of either format: FCLIB's HDF5 (fclib.hpp), recognised by its signature, or Siconos'
/// text (dat_file.hpp).
#include <string>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// Reads the problem. Throws lcp::FileError with file, place and reason. A file whose content contradicts its ending
/// (text in .hdf5 or .h5, HDF5 in .dat) is refused, too, because it is probably the wrong file.
Problem read_problem(const std::string& path);

}  // namespace perp::contact
