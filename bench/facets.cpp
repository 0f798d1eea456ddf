/// bench_facets [--encodings LIST] [--facets K,K..] [--seconds S] FILES...: the faceted encodings of contact problems,
/// solved and judged by the exact law. A row of CSV a run on standard output, the table of medians on standard error.
/// README.md says how to read both.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "contact/io/read.hpp"
#include "contact/laws/inner_faceting.hpp"
#include "contact/laws/outer_faceting.hpp"
#include "contact/model/residual.hpp"
#include "contact/solvers/solve.hpp"

namespace {

using namespace perp;
using namespace perp::contact;

/// Measures of one run that fall with K, each free of units.
struct Errors {
  double natural = 0;   ///< Residual::scaled
  double cone = 0;      ///< Residual::cone / max r_N
  double slip = 0;      ///< Residual::slip / (max r_N max |u|)
  double velocity = 0;  ///< ||u - u_exact|| / ||u_exact||
};

struct Summary {
  int runs = 0;
  int solved = 0;
  int by_lemke = 0;
  double residual = 0;
  double slowest = 0;
  std::vector<Errors> errors;
};

double median(const std::vector<Errors>& all, double Errors::*member) {
  std::vector<double> values;
  for (const Errors& e : all) values.push_back(e.*member);
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

AffineEncoding encode(const Problem& p, const std::string& encoding, int K) {
  const bool outer = encoding.starts_with("outer");
  const EncodingOptions options{.form = encoding.ends_with("mixed") ? Form::Mixed : Form::Reduced};
  const Polygons polygons{p.dimension == 2 ? Polygon::interval()
                          : outer          ? Polygon::circumscribed(K, 0.1)
                                           : Polygon::inscribed(K, 0.1)};
  return outer ? AffineEncoding(OuterFaceting(p, polygons, options)) : InnerFaceting(p, polygons, options);
}

void run(const Problem& p, const Vec& exact, const std::string& encoding, int K, double seconds, Summary& summary) {
  const auto begin = std::chrono::steady_clock::now();
  const AffineEncoding form = encode(p, encoding, K);
  lcp::Limits limits{.tol = 5e-10};
  limits.deadline = begin + std::chrono::milliseconds(static_cast<long>(1000 * seconds));
  const EncodingResult result = contact::solve(form, limits);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const bool by_lemke = result.by == std::string_view("lemke");
  const Solution s = form.recover(result.z);
  const Residual e = residual(p, s.r);
  double r_N = 1e-300;
  for (Index a = 0; a < p.contacts(); ++a) r_N = std::max(r_N, s.r[p.dimension * a]);
  const double u = std::max(1e-300, p.q.lpNorm<Eigen::Infinity>());
  const Errors errors{e.scaled, e.cone / r_N, e.slip / (r_N * u), (s.u - exact).norm() / std::max(1e-300, p.q.norm())};
  const std::string status(lcp::to_string(result.status));
  std::printf("%s,%ld,%s,%d,%ld,%s,%s,%.1e,%ld,%.4f,%.3e,%.3e,%.3e,%.3e\n", p.name.c_str(),
              static_cast<long>(p.contacts()), encoding.c_str(), K, static_cast<long>(form.affine().size()),
              status.c_str(), by_lemke ? "lemke" : "other", result.residual, result.iterations, took, errors.natural,
              errors.cone, errors.slip, errors.velocity);
  std::fflush(stdout);
  ++summary.runs;
  summary.solved += result.residual <= 1e-9;
  summary.by_lemke += by_lemke;
  summary.slowest = std::max(summary.slowest, took);
  if (result.residual > 1e-9) return;
  summary.residual = std::max(summary.residual, result.residual);
  if (errors.natural > 1e-10) summary.errors.push_back(errors);  // exact already where nothing slips
}

void measure(const std::vector<std::string>& files, const std::vector<std::string>& encodings,
             const std::vector<int>& facets, double seconds) {
  std::map<std::pair<std::string, int>, Summary> summaries;
  std::printf("file,contacts,encoding,K,unknowns,status,by,residual,pivots,seconds,natural,cone,slip,velocity\n");
  for (const std::string& file : files) {
    const Problem p = read_problem(file);
    const contact::Result exact = contact::solve(p, {.tol = 1e-9});
    if (!exact.solved()) std::fprintf(stderr, "%s: no exact solution to compare with\n", file.c_str());
    for (const std::string& encoding : encodings)
      for (const int K : facets) run(p, exact.solution.u, encoding, K, seconds, summaries[{encoding, K}]);
  }
  std::fprintf(stderr,
               "| encoding | K | solved | by Lemke | residual | slowest [s] | natural | cone | slip | velocity |\n"
               "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [key, s] : summaries)
    std::fprintf(stderr, "| %s | %d | %d of %d | %d | %.0e | %.2f | %.1e | %.1e | %.1e | %.1e |\n", key.first.c_str(),
                 key.second, s.solved, s.runs, s.by_lemke, s.residual, s.slowest, median(s.errors, &Errors::natural),
                 median(s.errors, &Errors::cone), median(s.errors, &Errors::slip), median(s.errors, &Errors::velocity));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("the faceted encodings of contact problems, judged by the exact law");
  std::vector<std::string> files;
  std::vector<std::string> encodings{"outer-mixed", "outer-reduced", "inner-mixed", "inner-reduced"};
  std::vector<int> facets{4, 6, 8, 16, 32, 64};
  double seconds = 30;
  app.add_option("files", files, "contact problems, .dat or .hdf5")->required()->check(CLI::ExistingFile);
  app.add_option("--encodings", encodings)->delimiter(',')->check(CLI::IsMember(encodings));
  app.add_option("--facets", facets)->delimiter(',')->check(CLI::Range(3, 1000));
  app.add_option("--seconds", seconds, "limit of a run")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    measure(files, encodings, facets, seconds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_facets: %s\n", error.what());
    return 1;
  }
  return 0;
}
