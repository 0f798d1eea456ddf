#pragma once
/// The files between a campaign and its processes. Private to app/compare.
#include <string>

#include "app/worker/worker.hpp"

namespace perp::app::compare {

void write_answer(const std::string& folder, const Answer& answer);
void write_point(const std::string& folder, ncp::In x);
ncp::Vec read_point(const std::string& folder);  ///< empty if there is none
std::string file_crc(const std::string& path);   ///< 8 hex digits

}  // namespace perp::app::compare
