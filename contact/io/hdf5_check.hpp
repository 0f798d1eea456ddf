// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A damaged file can make HDF5's library (1.10.8) read and write outside of its memory: of 200,000 small files with up
/// to three random bytes or words changed, eleven ended the process. Hence this look beforehand, which follows
/// everything the library will follow and checks every address, count, size and offset on the way. Private to contact/.
///
/// What it knows is the classic layout, the library's default: superblock 0 or 1, object headers 1, groups as B-trees
/// with local heaps, datasets in one piece (HDF5 File Format Specification 3.0, sections II.A, III.A.1, III.B - D,
/// IV.A). All else is refused. Newer layouts have checksums, but the library leaks what it opened where one is wrong.
#include <string_view>

namespace perp::contact {

/// Throws std::invalid_argument, "object header at byte 800: ..".
void check_hdf5(std::string_view file);

/// Where the signature of HDF5 is: 0, or behind a block of the user's of 512, 1024, 2048, .. bytes; npos: nowhere.
std::size_t find_hdf5(std::string_view file);

}  // namespace perp::contact
