// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "app/campaign/cell.hpp"
#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/text/json_fields.hpp"
#include "app/worker/worker.hpp"

namespace perp::app::compare {

std::string task_json(const Task& task) { return line_of(json_of(task)); }

Task parse_task(const std::string& text) {
  try {
    return row_of<Task>(json_object(text));
  } catch (const InputError& error) {
    throw input_error("compare-worker: {}", error.what());
  }
}

void write_answer(const std::string& folder, const Answer& answer) {
  app::write_file(folder + "/result.json", json_text(json_of(answer)), lcp::Sync::No);
}

Answer read_answer(const std::string& folder) {
  try {
    Answer answer = row_of<Answer>(json_object(read_text(folder + "/result.json")));
    answer.complete = true;
    return answer;
  } catch (const InputError&) {
    return {};
  }
}

void write_point(const std::string& folder, ncp::In x) {
  app::write_file(
      folder + "/x.bin",
      std::string(reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)),
      lcp::Sync::No);
}

ncp::Vec read_point(const std::string& folder) {
  const std::string bytes = read_text(folder + "/x.bin");
  ncp::Vec x(static_cast<ncp::Index>(bytes.size() / sizeof(double)));
  std::copy_n(bytes.data(), static_cast<std::size_t>(x.size()) * sizeof(double), reinterpret_cast<char*>(x.data()));
  return x;
}

}  // namespace perp::app::compare
