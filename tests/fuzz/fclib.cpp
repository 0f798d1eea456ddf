// SPDX-License-Identifier: Apache-2.0
/// FCLIB files from their bytes (contact/io/fclib.hpp): what is read passes contact::check and the judge, and what is
/// written of it reads back the same.
#include "contact/io/fclib.hpp"

#include "contact/model/residual.hpp"
#include "fuzz/support.hpp"
#include "lcp/io/file_error.hpp"

namespace {

using perp::contact::Fclib;
using perp::fuzz::require;

const perp::fuzz::Scratch& scratch() {
  static const perp::fuzz::Scratch folder;
  return folder;
}

void write_and_read(const Fclib& file) {
  const std::string path = scratch().path("again.hdf5");
  perp::contact::write_fclib(path, file);
  const Fclib again = perp::contact::read_fclib(path);
  require(again.problem.mu == file.problem.mu && again.problem.q.size() == file.problem.q.size() &&
              again.guesses.size() == file.guesses.size() && again.title == file.title,
          "a problem reads back as it was");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view content = perp::fuzz::view(data, size);
  perp::fuzz::accepted<perp::lcp::FileError>([&] {
    const Fclib file = perp::contact::parse_fclib(content, "input.hdf5");
    perp::contact::check(file.problem);
    const perp::contact::Judge judge(file.problem);
    judge(perp::lcp::Vec::Zero(file.problem.q.size()));
    if (file.solution && file.solution->r.size() == file.problem.q.size()) judge(file.solution->r);
    if (perp::fuzz::one_in(16, content)) write_and_read(file);
  });
  return 0;
}
