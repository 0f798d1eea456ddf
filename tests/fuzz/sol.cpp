// SPDX-License-Identifier: Apache-2.0
/// .sol files of other programs, text and binary (app/worker/sol_file.hpp). The first byte says how many variables the
/// model has. What is read, written by the writer of our own, reads back the same.
#include "ncp/ampl/sol.hpp"
#include "app/program/program.hpp"
#include "app/worker/sol_file.hpp"
#include "fuzz/support.hpp"

namespace {

using namespace perp;
using fuzz::require;

void use(const app::compare::SolFile& sol, int variables) {
  require(sol.x.size() == 0 || sol.x.size() == variables, "x has a value a variable, or none");
  for (const bool binary : {false, true}) {
    const std::string text = ncp::ampl::sol_text({.binary = binary, .n_con = 1, .n_var = variables}, sol.message,
                                                 {sol.x.data(), static_cast<std::size_t>(sol.x.size())}, sol.code);
    const app::compare::SolFile again = app::compare::parse_sol(text, variables);
    require(again.code == sol.code && again.x.size() == sol.x.size(), "a .sol file reads back");
    for (ncp::Index i = 0; i < sol.x.size(); ++i)
      require(again.x[i] == sol.x[i] || (std::isnan(again.x[i]) && std::isnan(sol.x[i])), "x reads back as it was");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return -1;
  const int variables = data[0] % 10;
  const std::string_view text = fuzz::view(data + 1, size - 1);
  fuzz::accepted<app::InputError>([&] { use(app::compare::parse_sol(text, variables), variables); });
  return 0;
}
