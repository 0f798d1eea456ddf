#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "app/campaign/cell.hpp"
#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/report/json.hpp"
#include "app/text/json_parts.hpp"
#include "app/worker/worker.hpp"
#include "app/worker/worker_files.hpp"

namespace perp::app::compare {

namespace {

constexpr std::array<std::string_view, 4> roles{"describe", "solve", "external", "judge"};

double real(const Json& value) {
  if (value.is_string()) return value == "inf" ? std::numeric_limits<double>::infinity() : std::nan("");
  return value.get<double>();
}

}  // namespace

std::string task_json(const Task& task) {
  return Json{{"role", roles.at(static_cast<std::size_t>(task.role))},
              {"problem", task.problem},
              {"start", task.start},
              {"method", task.method},
              {"name", task.name},
              {"options", task.options},
              {"command", task.command},
              {"tol", task.tol},
              {"time_limit", task.time_limit},
              {"seed", task.rule.seed},
              {"rule_problem", task.rule.problem},
              {"run", task.rule.run},
              {"folder", task.folder}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

Task parse_task(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    Task task;
    const auto role = json.at("role").get<std::string>();
    for (std::size_t k = 0; k < roles.size(); ++k)
      if (roles.at(k) == role) task.role = static_cast<Task::Role>(k);
    task.problem = json.at("problem").get<std::string>();
    task.start = json.at("start").get<int>();
    task.method = json.at("method").get<std::string>();
    task.name = json.at("name").get<std::string>();
    task.options = json.at("options").get<std::vector<std::string>>();
    task.command = json.at("command").get<std::string>();
    task.tol = json.at("tol").get<double>();
    task.time_limit = json.at("time_limit").get<double>();
    task.rule = {.seed = json.at("seed").get<unsigned>(),
                 .problem = json.at("rule_problem").get<std::string>(),
                 .start = task.start,
                 .run = json.at("run").get<int>()};
    task.folder = json.at("folder").get<std::string>();
    return task;
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("compare-worker: {}", error.what()));
  }
}

void write_answer(const std::string& folder, const Answer& answer) {
  Json curve = Json::array();
  for (const double value : answer.curve) curve.push_back(json_number(value));
  const AskedProblem& problem = answer.described;
  const Json json{{"refused", answer.refused},
                  {"out_of_memory", answer.out_of_memory},
                  {"status", answer.status},
                  {"claimed", answer.claimed},
                  {"to_rounding", answer.to_rounding},
                  {"infeasible", answer.infeasible},
                  {"proven", answer.proven},
                  {"not_applicable", answer.not_applicable},
                  {"time_limit", answer.time_limit},
                  {"crashed", answer.crashed},
                  {"garbage", answer.garbage},
                  {"message", answer.message},
                  {"iterations", answer.iterations},
                  {"F_evals", answer.F_evals},
                  {"J_evals", answer.J_evals},
                  {"factorizations", answer.factorizations},
                  {"krylov_iterations", answer.krylov_iterations},
                  {"seconds", answer.seconds},
                  {"peak_mb", answer.peak_mb},
                  {"curve", std::move(curve)},
                  {"has_x", answer.has_x},
                  {"natural", json_number(answer.natural)},
                  {"n", problem.n},
                  {"nonzeros", problem.nonzeros},
                  {"affine", problem.affine},
                  {"starts", problem.starts},
                  {"known_solutions", problem.known_solutions},
                  {"no_solution", problem.no_solution},
                  {"crc", problem.crc}};
  app::write_file(folder + "/result.json", json_text(json), lcp::Sync::No);
}

Answer read_answer(const std::string& folder) {
  Answer answer;
  const Json json = Json::parse(read_text(folder + "/result.json"), nullptr, false);
  if (!json.is_object()) return answer;
  try {
    json.at("refused").get_to(answer.refused);
    json.at("out_of_memory").get_to(answer.out_of_memory);
    json.at("status").get_to(answer.status);
    json.at("claimed").get_to(answer.claimed);
    json.at("to_rounding").get_to(answer.to_rounding);
    json.at("infeasible").get_to(answer.infeasible);
    json.at("proven").get_to(answer.proven);
    json.at("not_applicable").get_to(answer.not_applicable);
    json.at("time_limit").get_to(answer.time_limit);
    json.at("crashed").get_to(answer.crashed);
    json.at("garbage").get_to(answer.garbage);
    json.at("message").get_to(answer.message);
    json.at("iterations").get_to(answer.iterations);
    json.at("F_evals").get_to(answer.F_evals);
    json.at("J_evals").get_to(answer.J_evals);
    json.at("factorizations").get_to(answer.factorizations);
    json.at("krylov_iterations").get_to(answer.krylov_iterations);
    json.at("seconds").get_to(answer.seconds);
    json.at("peak_mb").get_to(answer.peak_mb);
    for (const Json& value : json.at("curve")) answer.curve.push_back(real(value));
    json.at("has_x").get_to(answer.has_x);
    answer.natural = real(json.at("natural"));
    AskedProblem& problem = answer.described;
    json.at("n").get_to(problem.n);
    json.at("nonzeros").get_to(problem.nonzeros);
    json.at("affine").get_to(problem.affine);
    json.at("starts").get_to(problem.starts);
    json.at("known_solutions").get_to(problem.known_solutions);
    json.at("no_solution").get_to(problem.no_solution);
    json.at("crc").get_to(problem.crc);
    answer.complete = true;
  } catch (const Json::exception&) {
    answer.complete = false;
  }
  return answer;
}

void write_point(const std::string& folder, ncp::In x) {
  app::write_file(
      folder + "/x.bin",
      std::string(reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)),
      lcp::Sync::No);
}

ncp::Vec read_point(const std::string& folder) {
  const std::string bytes = read_text(folder + "/x.bin");
  ncp::Vec x(static_cast<ncp::Index>(bytes.size() / sizeof(double)));
  std::copy_n(bytes.data(), static_cast<std::size_t>(x.size()) * sizeof(double), reinterpret_cast<char*>(x.data()));
  return x;
}

std::string file_crc(const std::string& path) { return fmt::format("{:08x}", crc32(read_text(path))); }

}  // namespace perp::app::compare
