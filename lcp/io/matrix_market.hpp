#pragma once
/// Matrix Market files (Boisvert, Pozo & Remington, NIST IR 5935, 1996): a header line
///     %%MatrixMarket matrix coordinate|array real|integer|double|pattern general|symmetric|skew-symmetric
/// comment lines that begin with %, a line of sizes, then the entries: "i j value" from 1 for coordinate (pattern: "i
/// j", value 1), one value after the other by columns for array. Of symmetric matrices the lower triangle is given, of
/// skew-symmetric ones what is strictly below the diagonal. Entries of a place given twice are added up. Case, blank
/// lines and carriage returns do not matter. Complex and Hermitian matrices are refused, and so is everything that is
/// not as announced: counts, ranges, values that are not finite, text after the last entry.
#include <string>
#include <string_view>

#include "lcp/io/file_error.hpp"
#include "lcp/types.hpp"

namespace perp::lcp {

/// Throws FileError.
SpMat read_matrix(const std::string& path);

/// An n x 1 or 1 x n matrix, coordinate (absent entries are 0) or array; or plain text, a number a line, without
/// header. Bounds may be infinite: inf, -inf, infinity, or 1e20 and beyond in size, are taken as infinite if `bounds`,
/// refused if not. Throws FileError.
Vec read_vector(const std::string& path, bool bounds = false);

// The same from the text of a file; `name` is for the errors.
SpMat parse_matrix(std::string_view text, const std::string& name);
Vec parse_vector(std::string_view text, const std::string& name, bool bounds = false);

/// What a file of it holds: coordinate, general, the shortest text that reads back exactly; of a vector array, n x 1.
std::string matrix_text(const SpMat& A, const std::string& comment = {});
std::string vector_text(In v, const std::string& comment = {});

/// By lcp/io/output_file.hpp. Throws FileError if the file cannot be written.
void write_matrix(const std::string& path, const SpMat& A, const std::string& comment = {});
void write_vector(const std::string& path, In v, const std::string& comment = {});

}  // namespace perp::lcp
