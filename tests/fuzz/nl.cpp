// SPDX-License-Identifier: Apache-2.0
/// .nl files, text and binary (ncp/ampl/model.hpp). nl_check sees every input in memory, as it is the first to see a
/// file; what it lets pass goes through a file to read_model() and AMPL's library. F and J have the same values however
/// often and in whatever order they are asked for, and J the entries that linear_entries() calls constant.
#include <cstring>
#include <vector>

#include "fuzz/support.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/ampl/nl_check.hpp"
#include "ncp/problem/residual.hpp"

namespace {

using namespace perp::ncp;
using perp::fuzz::require;

/// F and J at a point; where they are not defined, that.
struct Values {
  bool F_defined = false;
  bool J_defined = false;
  Vec F{};
  SpMat J{};
};

Values values(const Mcp& mcp, const Vec& x) {
  Values v{.F = Vec::Zero(mcp.size()), .J = mcp.jacobian_pattern()};
  v.F_defined = mcp.eval(x, v.F);
  v.J_defined = mcp.jacobian(x, v.J);
  return v;
}

/// Bit by bit where they are numbers; which NaN it is says nothing.
bool same(const double* a, const double* b, Index n) {
  for (Index i = 0; i < n; ++i)
    if (std::memcmp(a + i, b + i, sizeof *a) != 0 && !(std::isnan(a[i]) && std::isnan(b[i]))) return false;
  return true;
}

bool same(const Values& a, const Values& b) {
  return a.F_defined == b.F_defined && a.J_defined == b.J_defined && same(a.F.data(), b.F.data(), a.F.size()) &&
         (!a.J_defined || same(a.J.valuePtr(), b.J.valuePtr(), a.J.nonZeros()));
}

void use(const ampl::Model& model, bool write) {
  require(!model.box().lower.hasNaN() && model.jacobian_pattern().isCompressed(), "a model has a box and a pattern");
  const Vec x0 = model.start();
  const Vec x1 = x0.array() + 0.5;
  const Values at_x0 = values(model, x0);
  const Values at_x1 = values(model, x1);
  require(same(values(model, x0), at_x0) && same(values(model, x1), at_x1), "F and J depend on x alone");
  const std::vector<bool> linear = model.linear_entries();
  require(linear.empty() || static_cast<Index>(linear.size()) == at_x0.J.nonZeros(), "a flag an entry");
  if (at_x0.J_defined && at_x1.J_defined)
    for (std::size_t k = 0; k < linear.size(); ++k)
      require(!linear[k] || same(at_x0.J.valuePtr() + k, at_x1.J.valuePtr() + k, 1), "linear entries are constant");
  for (Index i = 0; i < model.size(); ++i) {
    model.variable_name(i);
    model.equation_name(i);
  }
  if (at_x0.F_defined) residual(model.box(), x0, at_x0.F);
  if (write) model.write_sol("of the fuzzer", x0.head(model.n_var()), 0);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const perp::fuzz::Scratch scratch;
  const std::string_view bytes = perp::fuzz::view(data, size);
  const bool sound = perp::fuzz::accepted<ampl::ModelError>([&] { ampl::check_nl("model.nl", bytes); });
  if (!sound) return 0;
  const std::string path = scratch.write("model.nl", bytes);
  std::unique_ptr<ampl::Model> model;
  if (!perp::fuzz::accepted<ampl::ModelError>([&] { model = ampl::read_model(path); })) return 0;
  use(*model, perp::fuzz::one_in(64, bytes));
  return 0;
}
