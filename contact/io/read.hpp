#pragma once
/// A contact problem from a file of either format: FCLIB's HDF5 (fclib.hpp), recognised by its signature, or Siconos'
/// text (dat_file.hpp).
#include <string>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// Throws lcp::FileError with file, place and reason. A file whose content contradicts its ending, text in .hdf5 or
/// .h5 or HDF5 in .dat, is refused as well: somebody has mistaken it for another.
Problem read_problem(const std::string& path);

}  // namespace perp::contact
