// SPDX-License-Identifier: Apache-2.0
#include "app/contact/studies/facets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <set>
#include <sstream>
#include <utility>

#include "app/contact/run/number_list.hpp"
#include "app/contact/run/report.hpp"
#include "app/problem/problem.hpp"
#include "app/program/files.hpp"
#include "app/report/json.hpp"
#include "app/text/json_parts.hpp"
#include "app/text/table.hpp"

namespace perp::app::contacts {

namespace {

using lcp::Index;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double exact_tol = 1e-9;     // asked for
constexpr double exact_enough = 1e-8;  // of both published metrics
/// Parts of the angle between two corners: 1/12, 5/12 and 3/12 away from the nearest corner.
constexpr std::array<double, 3> positions{1.0 / 12, 5.0 / 12, 9.0 / 12};

std::size_t at(FacetError error) { return static_cast<std::size_t>(error); }

const char* side(bool outer) { return outer ? "outer" : "inner"; }

double median(std::vector<double> values) {
  if (values.empty()) return unknown;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

void check(const FacetsRequest& request) {
  if (request.problems.empty()) throw InputError("--facets: on which problems? FILE..., or NAME:SIZE[:SEED]");
  std::set<std::string> seen;
  for (const std::string& problem : request.problems)
    if (!seen.insert(problem).second) throw input_error("'{}' is there twice", problem);
  if (!(request.tol > 0) || !std::isfinite(request.tol))
    throw input_error("--tol {:g}: a tolerance is positive", request.tol);
  if (!(request.time_limit > 0)) throw input_error("--time-limit {:g}: a limit is positive", request.time_limit);
  if (request.svg == "-") throw InputError("--svg -: a picture goes to a file");
}

class Study {
 public:
  Study(const FacetsRequest& request, const std::atomic<bool>* interrupt) : request_(request), interrupt_(interrupt) {
    study_.facets = parse_list("--facets", request.facets, 3, contact::most_facets);
    std::ranges::sort(study_.facets);
    study_.form = parse_variant({.formulation = "inner:3", .form = request.form}).form;
    study_.tol = request.tol;
  }

  /// False: a problem was refused, and the words are in `err`.
  bool load_all(std::ostream& err) {
    bool good = true;
    for (const std::string& name : request_.problems) {
      const std::string why = refusal(name, [&] { loaded_.push_back(std::make_shared<const Loaded>(load(name))); });
      if (why.empty()) continue;
      err << "perp: " << why << '\n';
      refused_.push_back(why);
      good = false;
    }
    return good;
  }
  std::string refused() const { return fmt::format("{}", fmt::join(refused_, "; ")); }

  const FacetStudy& run(std::ostream& err) {
    for (std::size_t p = 0; p < loaded_.size() && !stopped(); ++p) {
      err << fmt::format("perp: {} of {}: {}\n", p + 1, loaded_.size(), loaded_[p]->label) << std::flush;
      one(p);
    }
    return study_;
  }
  bool stopped() const { return interrupt_ != nullptr && interrupt_->load(); }

 private:
  void one(std::size_t p) {
    const contact::Problem& problem = loaded_[p]->problem;
    const Run exact = within_limits(p, parse_variant("glocker"), std::min(exact_tol, request_.tol));
    const contact::Residual& e = exact.residual;
    study_.problems.push_back({.label = loaded_[p]->label,
                               .dimension = problem.dimension,
                               .contacts = problem.contacts(),
                               .slipping = exact.in_state(contact::State::Slip),
                               .solved = contact::accepted(e, exact_enough),
                               .siconos = e.siconos});
    for (const bool outer : {false, true})
      for (const int K : study_.facets)
        for (const double position : positions)
          if (!stopped()) polygon(p, outer, K, position * 2 * std::numbers::pi / K, exact.solution);
  }

  Run within_limits(std::size_t p, const Variant& variant, double tol) {
    const Patience limits = patience(std::chrono::duration<double>(request_.time_limit), interrupt_);
    return run_within(limits, loaded_[p], variant, {.tol = tol, .seconds = request_.time_limit});
  }

  void polygon(std::size_t p, bool outer, int K, double rotation, const contact::Solution& exact) {
    const contact::Problem& problem = loaded_[p]->problem;
    Variant variant = parse_variant(fmt::format("{}:{}", side(outer), K));
    variant.form = study_.form;
    variant.rotation = rotation;
    const Run run = within_limits(p, variant, request_.tol);
    FacetRun& result = study_.runs.emplace_back();
    result = {.problem = p,
              .outer = outer,
              .facets = K,
              .rotation = rotation,
              .status = run.status,
              .solved = run.solved,
              .own = run.own,
              .unknowns = run.unknowns,
              .seconds = run.seconds};
    constexpr double least = std::numeric_limits<double>::min();
    double r_N = least;
    for (Index a = 0; a < problem.contacts(); ++a) r_N = std::max(r_N, run.solution.r[problem.dimension * a]);
    const double q = std::max(least, problem.q.size() > 0 ? problem.q.lpNorm<Eigen::Infinity>() : 0);
    result.errors[at(FacetError::Natural)] = run.residual.scaled;
    result.errors[at(FacetError::Velocity)] =
        study_.problems[p].solved ? (run.solution.u - exact.u).norm() / std::max(least, problem.q.norm()) : unknown;
    result.errors[at(FacetError::Cone)] = run.residual.cone / r_N;
    result.errors[at(FacetError::Slip)] = run.residual.slip / (r_N * q);
  }

  const FacetsRequest& request_;
  const std::atomic<bool>* interrupt_;
  std::vector<std::shared_ptr<const Loaded>> loaded_;
  std::vector<std::string> refused_;
  FacetStudy study_;
};

std::string error_text(double value) {
  return std::isnan(value) ? "-" : value < facet_rounding ? "0" : number(value, 3);
}

std::string power_text(double power) { return std::isnan(power) ? "-" : fmt::format("K^{:.2f}", power); }

void print(std::ostream& out, const FacetStudy& study) {
  Index least = 0;
  Index most = 0;
  for (const FacetProblem& problem : study.problems) {
    least = least == 0 ? problem.contacts : std::min(least, problem.contacts);
    most = std::max(most, problem.contacts);
  }
  const auto exact = std::ranges::count(study.problems, true, &FacetProblem::solved);
  out << fmt::format(
      "{} of {} contacts, {} of them solved by the exact law; in {} something slips\n"
      "Polygons of K facets ({}) in {} positions; own residual: the largest of the solved; errors: medians over\n"
      "problems in which something slips\n\n",
      count(static_cast<long long>(study.problems.size()), "problem"),
      least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most), exact, study.counting(),
      study.form == contact::Form::Mixed ? "MLCPs" : "LCPs", positions.size());
  Table table({"polygon", ">K", ">solved", ">own residual", ">natural", ">velocity", ">cone", ">slip", ">slowest"});
  const std::vector<FacetLine> lines = study.lines();
  for (const FacetLine& line : lines) {
    std::vector<std::string> row{side(line.outer), fmt::format("{}", line.facets),
                                 fmt::format("{}/{}", line.solved, line.runs),
                                 line.solved > 0 ? number(line.own, 2) : "-"};
    for (const double error : line.medians) row.push_back(error_text(error));
    row.push_back(seconds_text(line.slowest));
    table.add(std::move(row));
  }
  for (const bool outer : {false, true}) {
    std::vector<std::string> row{side(outer), "fit", "", ""};
    for (const FacetError error : facet_errors) row.push_back(power_text(fitted_power(lines, outer, error)));
    row.emplace_back("");
    table.add(std::move(row));
  }
  table.print(out, 2);
  out << "  natural   natural map of Coulomb's law, free of units     } friction is turned towards a corner,\n"
         "  velocity  |u - u_exact| / |q|                             } by up to pi / K\n"
         "  cone      |r_T| - mu r_N over the largest r_N             } the polygon's gap,\n"
         "  slip      missing dissipation over max r_N times max |q|  } 1 - cos(pi / K)\n";
  if (study.counting() == 0) out << "Nothing slips (or all is plane): polygons have no error here.\n";
  for (const FacetProblem& problem : study.problems)
    if (!problem.solved)
      out << fmt::format("{}: no exact solution to compare with (Siconos' metric {})\n", problem.label,
                         number(problem.siconos, 2));
  for (const FacetRun& run : study.runs)
    if (!run.solved)
      out << fmt::format("{}, {}:{}: {}, natural residual {}\n", study.problems[run.problem].label, side(run.outer),
                         run.facets, to_string(run.status), number(run.own, 2));
}

Json errors_json(const std::array<double, 4>& errors) {
  Json json = Json::object();
  for (const FacetError error : facet_errors) {
    const double value = errors.at(at(error));
    json[name(error)] = json_known(value);
  }
  return json;
}

std::string study_json(const FacetStudy& study, ExitCode code) {
  Json json = json_header(Document::ContactFacets);
  json["exit_code"] = static_cast<int>(code);
  json["form"] = study.form == contact::Form::Mixed ? "mixed" : "reduced";
  json["tol"] = json_number(study.tol);
  const std::vector<FacetLine> lines = study.lines();
  json["lines"] = Json::array();
  for (const FacetLine& line : lines)
    json["lines"].push_back({{"polygon", side(line.outer)},
                             {"facets", line.facets},
                             {"runs", line.runs},
                             {"solved", line.solved},
                             {"own_residual", line.solved > 0 ? json_number(line.own) : Json(nullptr)},
                             {"slowest_s", json_number(line.slowest)},
                             {"medians", errors_json(line.medians)}});
  json["powers"] = Json::object();
  for (const bool outer : {false, true}) {
    std::array<double, 4> powers{};
    for (const FacetError error : facet_errors) powers.at(at(error)) = fitted_power(lines, outer, error);
    json["powers"][side(outer)] = errors_json(powers);
  }
  json["problems"] = Json::array();
  for (const FacetProblem& problem : study.problems)
    json["problems"].push_back({{"problem", problem.label},
                                {"dimension", problem.dimension},
                                {"contacts", problem.contacts},
                                {"slipping", problem.slipping},
                                {"exact_solved", problem.solved},
                                {"siconos", json_number(problem.siconos)},
                                {"counts", problem.counts()}});
  json["runs"] = Json::array();
  for (const FacetRun& run : study.runs)
    json["runs"].push_back({{"problem", study.problems[run.problem].label},
                            {"polygon", side(run.outer)},
                            {"facets", run.facets},
                            {"rotation", json_number(run.rotation)},
                            {"status", to_string(run.status)},
                            {"own_residual", json_number(run.own)},
                            {"unknowns", run.unknowns},
                            {"time_s", json_number(run.seconds)},
                            {"errors", errors_json(run.errors)}});
  return json_text(json);
}

}  // namespace

const char* name(FacetError error) {
  constexpr std::array<const char*, 4> names{"natural", "velocity", "cone", "slip"};
  return names.at(at(error));
}

int FacetStudy::counting() const {
  return static_cast<int>(std::ranges::count_if(problems, [](const FacetProblem& p) { return p.counts(); }));
}

bool FacetStudy::complete() const {
  return std::ranges::all_of(problems, &FacetProblem::solved) && std::ranges::all_of(runs, &FacetRun::solved);
}

std::vector<FacetLine> FacetStudy::lines() const {
  std::vector<FacetLine> all;
  for (const bool outer : {false, true})
    for (const int K : facets) {
      FacetLine line{.outer = outer, .facets = K};
      std::array<std::vector<double>, 4> errors;
      for (const FacetRun& run : runs) {
        if (run.outer != outer || run.facets != K) continue;
        ++line.runs;
        line.slowest = std::max(line.slowest, run.seconds);
        if (!run.solved) continue;
        ++line.solved;
        line.own = std::max(line.own, run.own);
        for (std::size_t k = 0; problems[run.problem].counts() && k < errors.size(); ++k)
          errors.at(k).push_back(run.errors.at(k));
      }
      for (std::size_t k = 0; k < errors.size(); ++k) line.medians.at(k) = median(std::move(errors.at(k)));
      all.push_back(line);
    }
  return all;
}

double fitted_power(const std::vector<FacetLine>& lines, bool outer, FacetError error) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const FacetLine& line : lines) {
    const double value = line.medians.at(at(error));
    if (line.outer != outer || !(value >= facet_rounding)) continue;
    const double log_K = std::log(line.facets);
    const double log_e = std::log(value);
    n += 1, x += log_K, y += log_e, xx += log_K * log_K, xy += log_K * log_e;
  }
  return n < 2 ? unknown : (n * xy - x * y) / (n * xx - x * x);
}

ExitCode facets(const FacetsRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  const std::vector<FileUse> outputs{{"--json", request.json}, {"--svg", request.svg}};
  if (!outputs_fit(outputs, files_of(request.problems), streams)) return exit_input;
  std::ostream& log = request.json == "-" ? streams.err : streams.out;
  ExitCode code = exit_solved;
  std::string json;
  bool told = false;
  std::string why = refusal("--facets", [&] {
    check(request);
    Study study(request, interrupt);
    if (!study.load_all(streams.err)) {
      told = true;
      throw InputError(study.refused());
    }
    const FacetStudy& result = study.run(streams.err);
    const bool all = !study.stopped() && result.complete();
    code = all ? exit_solved : exit_unsolved;
    print(log, result);
    if (study.stopped()) log << "interrupted: not all of it was run\n";
    if (!request.svg.empty()) write_file(request.svg, facets_svg(result));
    json = request.json.empty() ? "" : study_json(result, code);
  });
  log.flush();
  if (!why.empty()) {
    if (!told) streams.err << "perp: " << why << '\n';
    std::ostringstream said;  // that it cannot be written, again
    deliver_json(request.json, refused_json(fmt::format("{}", fmt::join(request.problems, " ")), why),
                 {streams.out, said});
    return exit_input;
  }
  return deliver_json(request.json, json, streams) ? code : exit_input;
}

}  // namespace perp::app::contacts
