// SPDX-License-Identifier: Apache-2.0
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

/// Reads an n x 1 or 1 x n matrix, coordinate (absent entries are 0) or array, or plain text without a header, with a
/// number in each line. If `bounds`, inf, -inf, infinity and numbers of size 1e20 or more are infinite; if not, they
/// are refused. Throws FileError.
Vec read_vector(const std::string& path, bool bounds = false);

// The same from the text of a file; `name` is for the errors.
SpMat parse_matrix(std::string_view text, const std::string& name);
Vec parse_vector(std::string_view text, const std::string& name, bool bounds = false);

/// Return the text of a file: a matrix as coordinate, general, a vector as array, n x 1. Numbers have the shortest text
/// that reads back exactly.
std::string matrix_text(const SpMat& A, const std::string& comment = {});
std::string vector_text(In v, const std::string& comment = {});

/// Write a file by lcp/io/output_file.hpp. Throw FileError if the file cannot be written.
void write_matrix(const std::string& path, const SpMat& A, const std::string& comment = {});
void write_vector(const std::string& path, In v, const std::string& comment = {});

}  // namespace perp::lcp
