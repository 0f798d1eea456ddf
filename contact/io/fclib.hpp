// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Files of the Frictional Contact Library, FCLIB (Acary, Bremond, Koziara & Perignon, 2014; HDF5). Of the two problems
///     /fclib_local     u = W r + V lambda + q,   0 = V' r + R lambda + s         (V, R, s may be absent)
///     /fclib_global    M v = H r + G lambda + f,   u = H' v + w,   0 = G' v + b  (G, b may be absent)
/// a file has one, as datasets (with rolling friction in /fclib_local_rolling or /fclib_global_rolling)
///     spacedim                            d, 2 or 3; with rolling friction 3 or 5
///     W, V, R or M, H, G                  groups with the matrices
///     vectors/{q,s,mu} or {f,w,b,mu}      doubles; mu one a contact, and mu_r with rolling friction
///     info/{title,description,math_info}  text, may be absent
/// and beside it, if anything, /solution and /guesses/1 .. /guesses/number_of_guesses with v, u, r, l (l is lambda).
///
/// Matrices. m, n, nzmax, nz are integers, p, i integer arrays, x doubles:
///     nz = -1    compressed columns: column j is p[j] .. p[j+1] - 1 of i (rows) and x
///     nz = -2    compressed rows: row i is p[i] .. p[i+1] - 1 of i (columns) and x
///     nz >= 0    nz triplets: x[k] in row i[k] and COLUMN p[k]. The files and the code of the library agree on
///                this; the comment in its header says the reverse
/// nzmax and the arrays may be longer than their used part: p[last] or nz entries. Entries of one place add up.
///
/// Files are not trusted. HDF5's classic layout is read and written here (contact/io/hdf5.hpp), without HDF5's library.
/// External storage, links, compressed datasets and HDF5's newer layouts are refused; h5repack can rewrite most. A
/// count is accepted only if the file has as many bytes. Values that are not finite, indices out of range and
/// contradictory sizes are refused, by lcp::FileError with file, dataset and reason.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// A solution or a guess from a file, finite and of the right sizes, but not judged: many recorded ones are no
/// solutions. Parts that the file does not have, or announces but lacks, are empty.
struct FclibPoint {
  Vec v{};  ///< velocities of the bodies; of global problems
  Vec u{};  ///< d n
  Vec r{};  ///< d n
  Vec l{};  ///< multipliers of the bilateral constraints
};

struct Fclib {
  /// With `global` set where the file has a global problem. A local one's bilateral part is eliminated:
  ///     W - V R^-1 V',   q - V R^-1 s.
  Problem problem{};
  std::string title{};
  std::string description{};
  std::string math_info{};
  std::optional<FclibPoint> solution{};
  std::vector<FclibPoint> guesses{};
};

/// Reads a file. Throws lcp::FileError. The name of the problem is that of the file.
Fclib read_fclib(const std::string& path);
/// Reads the bytes of a file; `name` is for the errors.
Fclib parse_fclib(std::string_view content, const std::string& name);

enum class FclibForm {
  Given,  ///< global if the problem has its `global`, which must be what W and q come from; else local
  Local,  ///< W and q
};

/// Writes a problem, its solution and guesses. The file reads back bit for bit, and the same problem gives the same
/// bytes. An existing file is replaced only when the new one is complete. Throws std::invalid_argument if check()
/// refuses the problem or the sizes of a point do not fit, and lcp::FileError if the file cannot be written.
void write_fclib(const std::string& path, const Fclib& file, FclibForm form = FclibForm::Given);

}  // namespace perp::contact
