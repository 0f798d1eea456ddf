#pragma once
/// Private to contact/.
#include <string>
#include <string_view>

namespace perp::contact {

/// Replaces the regular file at `path`, or makes it, at once: written beside it under another name, then renamed. What
/// was there is kept if anything fails. Throws lcp::FileError.
void write_atomically(const std::string& path, std::string_view content);

}  // namespace perp::contact
