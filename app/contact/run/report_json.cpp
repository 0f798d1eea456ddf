// SPDX-License-Identifier: Apache-2.0
/// Runs as JSON.
#include "app/contact/run/report.hpp"
#include "app/problem/problem.hpp"
#include "app/report/json.hpp"
#include "app/text/json_parts.hpp"

namespace perp::app::contacts {

namespace {

using contact::Problem;
using lcp::Index;

Json contacts_json(const Problem& problem, const Run& run) {
  const int d = problem.dimension;
  Json array = Json::array();
  for (Index a = 0; a < problem.contacts(); ++a) {
    const contact::ContactState& s = run.states[static_cast<std::size_t>(a)];
    array.push_back({{"contact", a + 1},
                     {"mu", json_number(problem.mu[a])},
                     {"state", contact::name(s.state)},
                     {"margin", json_number(s.margin)},
                     {"r", json_numbers(run.solution.r.segment(d * a, d))},
                     {"u", json_numbers(run.solution.u.segment(d * a, d))}});
    if (problem.rolls()) array.back()["mu_r"] = json_number(problem.mu_r[a]);
  }
  return array;
}

Json exact_residual_json(const contact::Residual& r) {
  return {{"natural", json_number(r.natural)},
          {"siconos", json_number(r.siconos)},
          {"rr9118", json_number(r.rr9118)},
          {"scaled", json_number(r.scaled)},
          {"cone", json_number(r.cone)},
          {"normal", json_number(r.normal)},
          {"slip", json_number(r.slip)},
          {"cone_share", json_number(r.cone_share)},
          {"normal_share", json_number(r.normal_share)},
          {"slip_share", json_number(r.slip_share)},
          {"worst", r.worst < 0 ? Json(nullptr) : Json(r.worst + 1)}};
}

/// What is known of the existence of solutions: null where a solution was found.
void add_verdict(Json& json, const Run& run) {
  const contact::Verdict& verdict = run.verdict;
  const bool certified = verdict.certificate.size() > 0;
  json["existence"] = run.solved ? Json(nullptr) : Json(contact::to_string(verdict.existence));
  json["certificate"] = certified ? json_numbers(verdict.certificate) : Json(nullptr);
  json["radius"] = certified ? json_number(verdict.radius) : Json(nullptr);
  const bool exists = verdict.existence == contact::Existence::Exists;
  const contact::Witness& witness = verdict.witness;
  json["witness"] = exists ? json_numbers(witness.r) : Json(nullptr);
  json["witness_velocities"] = exists && witness.v.size() > 0 ? json_numbers(witness.v) : Json(nullptr);
}

Json stats_json(const Run& run) {
  Json json = Json::object();
  for (const auto& [what, n] : run.counts) json[what] = n;
  json["time_s"] = json_number(run.seconds);
  return json;
}

}  // namespace

std::string run_json(const Loaded& loaded, const Run& run, ExitCode code) {
  const Variant& variant = run.variant;
  Json json = json_header(Document::Contact);
  json["problem"] = loaded.label;
  json["dimension"] = loaded.problem.space();
  json["formulation"] = variant.formulation();
  json["method"] = variant.method;
  json["variant"] = variant.label();
  const contact::GlockerNcp* ncp = variant.as_ncp();
  const bool original = ncp != nullptr && ncp->formulation.row == contact::DiskRow::Original;
  json["encoding"] = ncp ? Json(ncp->formulation.encoding == contact::Encoding::A ? "A" : "B") : Json(nullptr);
  json["row"] = ncp ? Json(original ? "original" : "normalised") : Json(nullptr);
  json["form"] = variant.faceted() ? Json(variant.form == contact::Form::Mixed ? "mixed" : "reduced") : Json(nullptr);
  json["rotation"] = variant.faceted() ? json_number(variant.rotation) : Json(nullptr);
  json["options"] = variant.options;
  json["exact"] = variant.exact();
  json["tol"] = json_number(run.limits.tol);
  json["status"] = to_string(run.status);
  json["solved_by"] = run.solved_by.empty() ? Json(nullptr) : Json(run.solved_by);
  json["exit_code"] = static_cast<int>(code);
  json["message"] = run.message;
  add_verdict(json, run);
  json["residual"] = exact_residual_json(run.residual);
  const lcp::Vec& q = loaded.problem.q;
  json["free_velocity"] = {{"norm", json_number(q.norm())},
                           {"largest", json_number(q.size() > 0 ? q.lpNorm<Eigen::Infinity>() : 0)}};
  json["own_residual"] = json_known(run.own);
  json["unknowns"] = run.unknowns > 0 ? Json(run.unknowns) : Json(nullptr);
  json["states"] = {{"open", run.in_state(contact::State::Open)},
                    {"stick", run.in_state(contact::State::Stick)},
                    {"slip", run.in_state(contact::State::Slip)}};
  if (loaded.problem.rolls()) json["states"]["roll"] = run.in_state(contact::State::Roll);
  json["stats"] = stats_json(run);
  json["contacts"] = contacts_json(loaded.problem, run);
  return json_text(json);
}

std::string runs_json(std::span<const std::string> objects, ExitCode code) {
  Json json = json_header(Document::ContactRuns);
  json["exit_code"] = static_cast<int>(code);
  json["problems"] = Json::array();
  for (const std::string& object : objects) json["problems"].push_back(Json::parse(object));
  return json_text(json);
}

ExitCode list_variants(const std::string& list, const std::vector<std::string>& problems, const std::string& json,
                       Streams streams) {
  Json all = json_header(Document::ContactVariants);
  const std::string why = refusal("", [&] {
    all["variants"] = Json::array();
    for (const Variant& variant : parse_variants(list))
      all["variants"].push_back({{"label", variant.label()}, {"exact", variant.exact()}, {"flags", variant.flags()}});
    for (const std::string& problem : problems)
      if (!is_generated(problem)) load(problem);
  });
  if (!why.empty()) return deliver_refusal(json.empty() ? "-" : json, "", why, streams);
  return deliver_json(json.empty() ? "-" : json, json_text(all), streams) ? exit_solved : exit_input;
}

}  // namespace perp::app::contacts
