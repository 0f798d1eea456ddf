#pragma once
/// Files of the Frictional Contact Library, FCLIB (Acary, Bremond, Koziara & Perignon, 2014; HDF5). Of the two problems
///     /fclib_local     u = W r + V lambda + q,   0 = V' r + R lambda + s         (V, R, s may be absent)
///     /fclib_global    M v = H r + G lambda + f,   u = H' v + w,   0 = G' v + b  (G, b may be absent)
/// a file has one, as datasets
///     spacedim                            d, 2 or 3
///     W, V, R or M, H, G                  groups with the matrices
///     vectors/{q,s,mu} or {f,w,b,mu}      doubles; mu one a contact
///     info/{title,description,math_info}  text, may be absent
/// and beside it, if anything, /solution and /guesses/1 .. /guesses/number_of_guesses with v, u, r, l (l is lambda).
///
/// Matrices. m, n, nzmax, nz are integers, p, i integer arrays, x doubles:
///     nz = -1    compressed columns: column j is p[j] .. p[j+1] - 1 of i (rows) and x
///     nz = -2    compressed rows: row i is p[i] .. p[i+1] - 1 of i (columns) and x
///     nz >= 0    nz triplets: x[k] in row i[k] and COLUMN p[k], as the files and the library's code have it; its
///     header
///                says the reverse
/// nzmax, and the arrays, may be longer than what is used: p[last] or nz entries. Entries of one place add up.
///
/// Nothing is trusted: HDF5 is given the file's bytes after a look at all of its metadata, and never opens another
/// file. External storage and links, virtual datasets are refused; so are compressed ones and HDF5's newer layouts,
/// which h5repack rewrites. No count is believed before there are as many bytes. Values that are not finite, indices
/// out of range, sizes that contradict each other are refused, by lcp::FileError with file, dataset and reason.
///
/// HDF5 is not made for threads (Debian's is built without the lock): calls of these functions wait for each other. A
/// program that calls HDF5 itself has to keep its calls apart from these.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact {

/// A solution or a guess as a file has it, finite and of the right sizes, but unjudged: many recorded ones are no
/// solutions. Parts that are not given, or announced and never written, are empty.
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

/// Throws lcp::FileError. The problem's name is the file's.
Fclib read_fclib(const std::string& path);
/// The same from the bytes of a file; `name` is for the errors.
Fclib parse_fclib(std::string_view content, const std::string& name);

enum class FclibForm {
  Given,  ///< global if the problem has its `global`, which must be what W and q come from; else local
  Local,  ///< W and q
};

/// Writes one problem, its solution and guesses; what is written reads back bit for bit, and the same problem gives the
/// same bytes. The file appears at once: what was there before is either kept or replaced. Throws std::invalid_argument
/// if the problem is none (check()) or a point's sizes are not the problem's, lcp::FileError if the file cannot be
/// written.
void write_fclib(const std::string& path, const Fclib& file, FclibForm form = FclibForm::Given);

}  // namespace perp::contact
