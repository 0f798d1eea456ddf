// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Names of files are UTF-8 in all of Perp. Windows itself takes those bytes for letters of the machine's code page.
#include <cstdio>
#include <filesystem>
#include <string>

namespace perp::lcp {

/// The path of this name.
std::filesystem::path file_path(const std::string& name);

/// Opens it to be read byte for byte; NULL, and errno, where it cannot be.
std::FILE* open_file(const std::string& name);

}  // namespace perp::lcp
