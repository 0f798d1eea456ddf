// SPDX-License-Identifier: Apache-2.0
/// The JSON of an earlier run as a start (app/problem/warm_start.hpp), of a problem with a variable of each kind of
/// bounds: what is read is finite, and the path search takes the basis.
#include "app/problem/warm_start.hpp"
#include "fuzz/support.hpp"
#include "lcp/io/file_error.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"

namespace {

using namespace perp;
using fuzz::require;

/// x[1] >= 0, x[2] free, x[3] in [0, 1], x[4] = 2.
std::unique_ptr<ncp::Mcp> problem() {
  lcp::SpMat M(4, 4);
  M.setIdentity();
  ncp::Box box{ncp::Vec::Zero(4), ncp::Vec::Constant(4, ncp::infinity)};
  box.lower << 0, -ncp::infinity, 0, 2;
  box.upper << ncp::infinity, ncp::infinity, 1, 2;
  return ncp::make_affine_mcp({.M = M, .q = ncp::Vec::Constant(4, -0.5), .box = box}, "four");
}

void use(app::WarmStart warm, bool solve) {
  app::LoadedProblem loaded{.label = "four", .mcp = problem(), .x0 = ncp::Vec::Zero(4)};
  require(warm.x.size() == 4 && warm.x.allFinite(), "a start is a point");
  require(warm.basis.empty() || warm.basis.size() == 4, "a basis is one of all variables");
  static const app::Applied path = app::apply_options({});
  app::Applied options = path;
  app::set_warm_start(std::move(warm), loaded, options);
  ncp::residual(*loaded.mcp, loaded.x0);
  if (!solve) return;
  const ncp::Result result = ncp::solve(*loaded.mcp, loaded.x0, options.settings.method);
  require(result.status != ncp::Status::Solved || result.residual.natural < 1, "what is solved has a residual");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::unique_ptr<ncp::Mcp> mcp = problem();
  const std::string_view text = fuzz::view(data, size);
  fuzz::accepted<app::InputError, lcp::FileError>(
      [&] { use(app::parse_warm_start(text, "input.json", *mcp), fuzz::one_in(16, text)); });
  return 0;
}
