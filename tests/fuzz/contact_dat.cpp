// SPDX-License-Identifier: Apache-2.0
/// Siconos' friction problems, local and global (contact/io/dat_file.hpp): what is read passes contact::check and the
/// judge.
#include "contact/io/dat_file.hpp"
#include "contact/model/residual.hpp"
#include "fuzz/support.hpp"
#include "lcp/io/file_error.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = perp::fuzz::view(data, size);
  perp::fuzz::accepted<perp::lcp::FileError>([&] {
    const perp::contact::Problem problem = perp::contact::parse_dat(text, "input.dat");
    perp::contact::check(problem);
    const perp::contact::Judge judge(problem);
    judge(perp::lcp::Vec::Zero(problem.q.size()));
    perp::contact::states(problem, perp::lcp::Vec::Ones(problem.q.size()));
  });
  return 0;
}
