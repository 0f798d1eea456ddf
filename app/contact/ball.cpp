// SPDX-License-Identifier: Apache-2.0
#include "app/contact/ball.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <utility>

#include "app/contact/run/number_list.hpp"
#include "app/problem/problem.hpp"
#include "app/program/command_option.hpp"
#include "app/program/files.hpp"
#include "app/report/json.hpp"
#include "app/text/json_parts.hpp"
#include "app/text/table.hpp"
#include "contact/laws/polygon.hpp"

namespace perp::app::contacts {

namespace {

using contact::BallPath;
using contact::CyclicBall;
using contact::FrictionLaw;

constexpr std::size_t most_loads = 6;
constexpr std::size_t most_points = 1000;  // of a path in JSON

std::vector<FrictionLaw> laws(const BallRequest& request) {
  const bool all = !request.facets && !request.exact;
  std::vector<FrictionLaw> laws;
  if (request.facets || all)
    for (const int K : parse_list("--facets", request.facets.value_or("4,6,8,16"), 3, contact::most_facets))
      laws.push_back({request.outer ? FrictionLaw::Kind::Outer : FrictionLaw::Kind::Inner, K});
  if (request.exact || all) laws.emplace_back();
  return laws;
}

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Three decimals, and no -0.000.
std::string metres(double value) { return fmt::format("{:.3f}", std::abs(value) < 5e-4 ? 0 : value); }
/// What rounding and tolerances leave is 0.
std::string joules(double value) { return std::abs(value) < 1e-6 ? "0" : number(value, 4); }

std::string heading(const CyclicBall& ball) {
  std::string text = fmt::format(
      "Ball on a plane, mu {:g}; a load of constant size at 60, 180 and -60 degrees, {:g} s each, in turn; {:g} {}, "
      "steps of {:g} s",
      ball.mu, ball.phase, ball.cycles, ball.cycles == 1 ? "cycle" : "cycles", ball.h);
  if (ball.frame != 0) text += fmt::format("; frame turned by {:.4g} degrees", degrees(ball.frame));
  return text + (ball.rolls ? "; it may roll" : "");
}

void print(std::ostream& out, const BallScene& scene) {
  out << fmt::format("\nLoad {:g} mu m g\n", scene.ball.load);
  Table table({"law", ">end x [m]", ">y [m]", ">from exact [m]", ">drift [m/s]", ">towards", ">work [J]",
               ">friction [J]", ">time [s]"});
  for (const BallPath& path : scene.paths) {
    const contact::Vec3 drift = path.drift(scene.ball);
    const contact::Vec3 end = path.centres.back();
    const double distance = from_exact(scene, path);
    const bool drifts = drift.norm() > 1e-5;
    table.add({name(path.law) + (path.solved ? "" : " (unsolved)"), metres(end.x()), metres(end.y()),
               std::isnan(distance) ? "" : metres(distance), fmt::format("{:.4f}", drift.norm()),
               drifts ? fmt::format("{:.0f} deg", degrees(std::atan2(drift.y(), drift.x()))) : "-",
               joules(path.energy.work), joules(path.energy.friction), fmt::format("{:.2f}", path.seconds)});
  }
  table.print(out, 2);
  for (const BallPath& path : scene.paths)
    if (!path.solved)
      out << fmt::format("  {} stopped at t = {:g} s: {}\n", name(path.law), path.times.back(), path.message);
}

Json vector_json(const contact::Vec3& v) { return Json::array({json_number(v.x()), json_number(v.y())}); }

Json path_json(const BallScene& scene, const BallPath& path) {
  Json json{{"law", name(path.law)}, {"solved", path.solved}};
  if (!path.solved) json["message"] = path.message;
  const double distance = from_exact(scene, path);
  json["steps"] = path.times.size() - 1;
  json["end"] = vector_json(path.centres.back());
  json["from_exact"] = json_known(distance);
  json["drift"] = vector_json(path.drift(scene.ball));
  json["exact_residual"] = json_number(path.worst);
  json["energy"] = {{"start", json_number(path.start_energy)},         {"kinetic", json_number(path.energy.kinetic)},
                    {"potential", json_number(path.energy.potential)}, {"work", json_number(path.energy.work)},
                    {"friction", json_number(path.energy.friction)},   {"impacts", json_number(path.energy.impacts)},
                    {"scheme", json_number(path.energy.scheme)}};
  json["iterations"] = path.iterations;
  json["time_s"] = json_number(path.seconds);
  const std::size_t every = 1 + (path.times.size() - 1) / most_points;
  Json points = Json::array();
  for (std::size_t k = 0; k < path.times.size(); ++k)
    if (k % every == 0 || k + 1 == path.times.size())
      points.push_back(
          {json_number(path.times[k]), json_number(path.centres[k].x()), json_number(path.centres[k].y())});
  json["path"] = std::move(points);
  return json;
}

std::string ball_json(const std::vector<BallScene>& scenes, ExitCode code) {
  Json json = json_header(Document::ContactBall);
  const CyclicBall& ball = scenes.front().ball;
  json["problem"] = "ball";
  json["exit_code"] = static_cast<int>(code);
  json["mu"] = json_number(ball.mu);
  json["gravity"] = json_number(ball.gravity);
  json["mass"] = json_number(ball.mass);
  json["phase"] = json_number(ball.phase);
  json["cycles"] = json_number(ball.cycles);
  json["step"] = json_number(ball.h);
  json["theta"] = json_number(ball.theta);
  json["frame_degrees"] = json_number(degrees(ball.frame));
  json["rolling"] = ball.rolls;
  json["loads"] = Json::array();
  for (const BallScene& scene : scenes) {
    Json paths = Json::array();
    for (const BallPath& path : scene.paths) paths.push_back(path_json(scene, path));
    json["loads"].push_back({{"load", json_number(scene.ball.load)}, {"paths", std::move(paths)}});
  }
  return json_text(json);
}

std::vector<BallScene> run(const BallRequest& request, const std::atomic<bool>* interrupt) {
  if (!std::isfinite(request.frame)) throw input_error("--frame {}: an angle is finite", request.frame);
  const std::vector<FrictionLaw> all = laws(request);
  const std::vector<double> loads = parse_list("--load", request.loads, 0.0, 1e6);
  if (loads.size() > most_loads)
    throw input_error("--load {}: {} loads, at most {}", request.loads, loads.size(), most_loads);
  const auto stop = [interrupt] { return interrupt != nullptr && interrupt->load(); };
  std::vector<BallScene> scenes;
  for (const double load : loads) {
    BallScene scene{.ball = request.ball};
    scene.ball.load = load;
    scene.ball.frame = request.frame * std::numbers::pi / 180;
    for (const FrictionLaw& law : all) scene.paths.push_back(run_ball(scene.ball, law, stop));
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

constexpr const char* ball_footer =
    "A ball slides on a plane under a load that comes from 60, 180 and -60 degrees in turn (lecture 3 by Acary). With "
    "a\n"
    "polygon of K facets in place of the friction disk, the path of the ball is bent and drifts. It then depends on "
    "how\n"
    "the frame of the contact is turned. By Coulomb's law the ball stays if friction can hold the load. Otherwise its\n"
    "path closes.\n"
    "\n"
    "Examples:\n"
    "  perp contact ball                                       4, 6, 8, 16 facets and the exact law\n"
    "  perp contact ball --facets 8 --exact --load 1.2 --frame 20\n"
    "  perp contact ball --exact --json - | jq '.loads[].paths[].drift'\n"
    "\n"
    "'perp-compare ball' draws the paths. Exit codes: 0 every step solved, 1 not, 2 wrong usage or input, 3 internal "
    "error.";

}  // namespace

const BallPath* BallScene::exact() const {
  return !paths.empty() && paths.back().law.kind == FrictionLaw::Kind::Coulomb ? &paths.back() : nullptr;
}

double from_exact(const BallScene& scene, const BallPath& path) {
  const BallPath* exact = scene.exact();
  if (exact == nullptr || exact->times.size() != path.times.size()) return std::numeric_limits<double>::quiet_NaN();
  return (path.centres.back() - exact->centres.back()).norm();
}

ExitCode ball(const BallRequest& request, Streams streams, const std::atomic<bool>* interrupt) {
  const std::vector<FileUse> outputs{{"--json", request.json}};
  if (!outputs_fit(outputs, {}, streams)) return exit_input;
  std::ostream& log = request.json == "-" ? streams.err : streams.out;
  ExitCode code = exit_solved;
  std::string json;
  const std::string why = refusal("ball", [&] {
    const std::vector<BallScene> scenes = run(request, interrupt);
    log << heading(scenes.front().ball) << '\n';
    for (const BallScene& scene : scenes) {
      print(log, scene);
      for (const BallPath& path : scene.paths)
        if (!path.solved) code = exit_unsolved;
    }
    log << (request.ball.rolls
                ? "\nRolling takes 2/7 of the load in friction: laws differ where that is more than they allow.\n"
                : "\ndrift: the mean velocity over the last cycle. By Coulomb's law there is none.\n");
    json = request.json.empty() ? "" : ball_json(scenes, code);
  });
  log.flush();
  if (!why.empty()) return deliver_refusal(request.json, "ball", why, streams);
  return deliver_json(request.json, json, streams) ? code : exit_input;
}

CLI::App* add_ball_command(CLI::App& contact, BallRequest& request) {
  CLI::App* ball = contact.add_subcommand(
      "ball", "Compute the path of a ball under a cyclic load, by friction polygons and by Coulomb's law");
  ball->footer(ball_footer);
  option(ball, "--facets", request.facets,
         "friction polygons of K facets (without --facets and --exact: 4,6,8,16 and Coulomb's law)", "K[,K]...");
  ball->add_flag("--exact", request.exact, "Coulomb's law; distances are measured from its path");
  ball->add_flag("--outer", request.outer, "polygons around the friction disk, not inside it");
  option(ball, "--load", request.loads, "size of the load in units of mu m g; one path for each (1,1.5)", "L[,L]...");
  option(ball, "--frame", request.frame, "turn the tangents (T1, T2) of the contact (0)", "DEGREES");
  option(ball, "--mu", request.ball.mu, "coefficient of friction (0.3)", "MU");
  option(ball, "--phase", request.ball.phase, "time for which the load keeps a direction (5)", "SECONDS");
  option(ball, "--cycles", request.ball.cycles, "number of cycles of three phases (4)", "N");
  option(ball, "--step", request.ball.h, "time step h (0.01)", "SECONDS");
  option(ball, "--theta", request.ball.theta, "theta of the time-stepping scheme, from 1/2 to 1 (0.5)", "THETA");
  ball->add_flag("--rolling", request.ball.rolls, "let the ball turn; then it rolls, with 2/7 of the load as friction");
  option(ball, "--json", request.json,
         "write the result as JSON; - is standard output, the text then goes to standard error", "FILE");
  return ball;
}

int run_ball_command(const CLI::App& contact, const BallRequest& request, Streams streams,
                     const std::atomic<bool>* interrupt) {
  for (const CLI::Option* option : contact.get_options())
    if (option->count() > 0) {
      streams.err << fmt::format(
          "perp contact: {} stands before 'ball', which is a command of its own; see 'perp "
          "contact ball --help' (./ball is a file)\n",
          option->get_name());
      return exit_input;
    }
  return ball(request, streams, interrupt);
}

}  // namespace perp::app::contacts
