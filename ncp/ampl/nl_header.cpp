// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/nl_header.hpp"

#include <algorithm>

namespace perp::ncp::ampl {
namespace {

class HeaderLine {
 public:
  HeaderLine(NlTokens& tokens, const char* what, std::size_t at_least) : tokens_(tokens), what_(what) {
    tokens.header_line();
    values_ = tokens.header_integers(what);
    if (!tokens.line_ends()) tokens.fail("header (" + std::string(what) + "): found something that is no integer");
    if (values_.size() < at_least)
      tokens.fail("header (" + std::string(what) + "): expected " + std::to_string(at_least) + " integers, found " +
                  std::to_string(values_.size()));
  }
  std::size_t size() const { return values_.size(); }
  /// The i-th integer, which counts something; 0 in the short lines of old headers.
  int count(std::size_t i) const {
    if (i >= values_.size()) return 0;
    if (values_[i] < 0)
      tokens_.fail("header (" + std::string(what_) + "): " + std::to_string(values_[i]) + " is negative");
    return values_[i];
  }

 private:
  NlTokens& tokens_;
  const char* what_;
  std::vector<int> values_;
};

void read_format(NlTokens& tokens, NlHeader& header) {
  const char kind = tokens.header_kind("gGbBzZhHE");
  if (kind == 'z' || kind == 'Z' || kind == 'h' || kind == 'H' || kind == 'E')
    tokens.fail(std::string("the .nl format '") + kind + "' is not supported: write g (text) or b (binary)");
  header.binary = kind == 'b' || kind == 'B';
  header.options = tokens.header_integers("format");
  if (header.options.empty()) header.options = {0};
  const int k = header.options.front();
  if (k < 0 || k > 9) tokens.fail("header (format): " + std::to_string(k) + " options, not in 0..9");
  const std::size_t found = header.options.size() - 1;
  if (found < static_cast<std::size_t>(k))
    tokens.fail("header (format): " + std::to_string(k) + " options announced, " + std::to_string(found) + " found");
  if (k >= 2 && header.options[2] == 3) {  // a tolerance follows, to be given back in the .sol file
    if (found > static_cast<std::size_t>(k))
      header.tolerance = header.options[static_cast<std::size_t>(k) + 1];
    else if (!tokens.line_ends())
      header.tolerance = tokens.real("the tolerance of the format line");
  }
  header.options.resize(static_cast<std::size_t>(k) + 1);
  if (!tokens.line_ends()) tokens.fail("header (format): found something that is no integer");
}

// Everything counted takes some bytes, so that nothing is ever allocated for a size that cannot be meant.
void check_sizes(NlTokens& tokens, const NlHeader& h, std::size_t file_size) {
  const auto fits = [&](const char* what, long long count, long long bytes_each) {
    if (count > static_cast<long long>(file_size) / bytes_each)
      tokens.fail("the header declares " + std::to_string(count) + " " + what + ", but the file has only " +
                  std::to_string(file_size) + " bytes");
  };
  const long long defined = 0LL + h.defined_both + h.defined_con + h.defined_obj + h.defined_con1 + h.defined_obj1;
  fits("variables", h.n_var, 1);
  fits("constraints", h.n_con, 8);  // a C segment with its expression, and an entry of r
  fits("objectives", h.n_obj, 8);
  fits("logical constraints", h.n_lcon, 8);
  fits("complementarity conditions", h.n_cc, 8);
  fits("imported functions", h.n_func, 1);
  fits("Jacobian nonzeros", h.jacobian_nonzeros, 4);
  fits("gradient nonzeros", h.gradient_nonzeros, 4);
  fits("defined variables", defined, 8);
  fits("variables, defined ones included", h.n_var + defined, 1);
  if (h.n_var == 0) tokens.fail("the header declares no variables");
  const auto within = [&](const char* what, int count, int total) {
    if (count > total)
      tokens.fail("the header declares " + std::to_string(count) + " " + what + " of " + std::to_string(total));
  };
  within("nonlinear constraints", h.nonlinear_con, h.n_con);
  within("nonlinear objectives", h.nonlinear_obj, h.n_obj);
  within("complementarity conditions among the constraints", h.n_cc, h.n_con);
  within("variables nonlinear in constraints", h.nonlinear_var_con, h.n_var);
  within("variables nonlinear in objectives", h.nonlinear_var_obj, h.n_var);
  within("variables nonlinear in both", h.nonlinear_var_both, std::min(h.nonlinear_var_con, h.nonlinear_var_obj));
  for (int n : {h.binary_var, h.integer_var, h.integer_both, h.integer_con, h.integer_obj})
    within("discrete variables", n, h.n_var);
}

}  // namespace

NlHeader read_header(NlTokens& tokens, std::size_t file_size) {
  NlHeader h;
  read_format(tokens, h);

  const HeaderLine sizes(tokens, "variables, constraints, objectives", 3);
  h.n_var = sizes.count(0);
  h.n_con = sizes.count(1);
  h.n_obj = sizes.count(2);
  h.n_lcon = sizes.count(5);  // ranges (3) and equations (4) are counted in the rows themselves
  const HeaderLine nonlinear(tokens, "nonlinear constraints, objectives, complementarities", 2);
  h.nonlinear_con = nonlinear.count(0);
  h.nonlinear_obj = nonlinear.count(1);
  if (static_cast<long long>(nonlinear.count(2)) + nonlinear.count(3) > h.n_con)
    tokens.fail("the header declares " + std::to_string(nonlinear.count(2)) + " + " +
                std::to_string(nonlinear.count(3)) + " complementarity conditions among " + std::to_string(h.n_con) +
                " constraints");
  h.n_cc = nonlinear.count(2) + nonlinear.count(3);
  const HeaderLine network(tokens, "network constraints", 2);
  h.network_con = network.count(0) > 0 ? network.count(0) : network.count(1);
  const HeaderLine variables(tokens, "nonlinear variables", 2);
  h.nonlinear_var_con = variables.count(0);
  h.nonlinear_var_obj = variables.count(1);
  if (variables.size() > 2) h.nonlinear_var_both = variables.count(2);
  const HeaderLine functions(tokens, "network variables, functions, arithmetic", 2);
  h.network_var = functions.count(0);
  h.n_func = functions.count(1);
  const int arithmetic = functions.count(2);
  if (arithmetic == 2)
    tokens.fail("the file was written on a big-endian machine (arithmetic kind 2): write it as text (g) instead");
  if (arithmetic > 1)
    tokens.fail("unknown arithmetic kind " + std::to_string(arithmetic) + " (1 is IEEE little-endian)");
  const HeaderLine discrete(tokens, "discrete variables", h.nonlinear_var_both < 0 ? 2 : 5);
  h.binary_var = discrete.count(0);
  h.integer_var = discrete.count(1);
  if (h.nonlinear_var_both >= 0) {
    h.integer_both = discrete.count(2);
    h.integer_con = discrete.count(3);
    h.integer_obj = discrete.count(4);
  }
  const HeaderLine nonzeros(tokens, "nonzeros", 2);
  h.jacobian_nonzeros = nonzeros.count(0);
  h.gradient_nonzeros = nonzeros.count(1);
  const HeaderLine names(tokens, "name lengths", 2);
  (void)names.count(0);
  (void)names.count(1);
  const HeaderLine defined(tokens, "defined variables", 5);
  h.defined_both = defined.count(0);
  h.defined_con = defined.count(1);
  h.defined_obj = defined.count(2);
  h.defined_con1 = defined.count(3);
  h.defined_obj1 = defined.count(4);
  check_sizes(tokens, h, file_size);
  h.body = tokens.offset();
  if (h.binary) tokens.switch_to_binary();
  return h;
}

}  // namespace perp::ncp::ampl
