#include "contact/read.hpp"

#include <string_view>

#include "contact/dat_file.hpp"
#include "contact/fclib.hpp"
#include "lcp/file_error.hpp"

namespace perp::contact {
namespace {

constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);

/// At 0, or behind a block of the user's of 512, 1024, 2048, .. bytes (HDF5 File Format Specification 3.0, II.A).
bool is_hdf5(std::string_view content) {
  if (content.starts_with(signature)) return true;
  for (std::size_t at = 512; at < content.size(); at *= 2)
    if (content.substr(at).starts_with(signature)) return true;
  return false;
}

}  // namespace

Problem read_problem(const std::string& path) {
  const std::string content = lcp::read_file(path);
  if (is_hdf5(content)) {
    if (path.ends_with(".dat"))
      throw lcp::FileError(path, 0, "an HDF5 file with the ending of a text file; rename it to .hdf5");
    return parse_fclib(content, path).problem;
  }
  if (path.ends_with(".hdf5") || path.ends_with(".h5"))
    throw lcp::FileError(path, 0, "not an HDF5 file: it has no HDF5 signature");
  return parse_dat(content, path);
}

}  // namespace perp::contact
