// SPDX-License-Identifier: Apache-2.0
/// Siconos' LCPs and MLCPs (lcp/io/siconos_file.hpp): every input goes to both readers; what is read is a sound
/// problem, the judge takes it with its known solution, and both forms of an MLCP can be made of it.
#include "fuzz/support.hpp"
#include "lcp/io/siconos_file.hpp"
#include "lcp/judge/judge.hpp"

namespace {

using perp::fuzz::require;
using perp::lcp::Vec;
constexpr perp::lcp::Index few = 40;

void use(const perp::lcp::SiconosLcp& file) {
  require(!file.problem.invalid(), "an LCP is sound");
  require(file.z.size() == file.w.size() && (file.z.size() == 0 || file.z.size() == file.problem.size()),
          "a known solution has the problem's size");
  if (file.problem.size() > few) return;
  perp::lcp::judge(file.problem, Vec::Ones(file.problem.size()));
  if (file.z.size() > 0) perp::lcp::judge(file.problem, file.z);
}

void use(const perp::lcp::SiconosMlcp& file) {
  const perp::lcp::Mlcp& mlcp = file.mlcp;
  require(!mlcp.invalid(), "an MLCP is sound");
  require(static_cast<perp::lcp::Index>(file.equations.size()) == mlcp.a.size() &&
              static_cast<perp::lcp::Index>(file.conditions.size()) == mlcp.b.size(),
          "every row is an equation or a condition");
  require(file.v.size() == file.w.size() && (file.v.size() == 0 || file.v.size() == mlcp.b.size()),
          "a known solution has the problem's size");
  const perp::lcp::AffineMcp affine = perp::lcp::to_affine(mlcp);
  if (affine.size() > few) return;
  perp::lcp::residual(mlcp, perp::lcp::from_affine(mlcp, Vec::Ones(affine.size())));
  perp::lcp::judge(affine, Vec::Ones(affine.size()));
  const perp::lcp::SchurReduction reduced(mlcp);
  if (reduced.status() == perp::lcp::LuStatus::Ok) reduced.recover(Vec::Ones(mlcp.b.size()));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = perp::fuzz::view(data, size);
  const std::string name = "input.dat";
  perp::fuzz::accepted<perp::lcp::FileError>([&] { use(perp::lcp::parse_siconos_lcp(text, name)); });
  perp::fuzz::accepted<perp::lcp::FileError>([&] { use(perp::lcp::parse_siconos_mlcp(text, name)); });
  return 0;
}
