#include "app/campaign/campaign.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sched.h>
#include <sys/sysinfo.h>
#include <sys/utsname.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "app/campaign/cell.hpp"
#include "app/campaign/differences.hpp"
#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/text/json_integer.hpp"
#include "app/text/json_parts.hpp"

namespace perp::app::compare {

namespace {

constexpr int format_version = 1;
// What nobody runs, and a damaged file may ask for: starts of a problem, and cells.
constexpr int most_starts = 10'000;
constexpr std::size_t most_cells = 10'000'000;

Json pairs_json(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json object = Json::object();
  for (const auto& [name, value] : pairs) object[name] = value;
  return object;
}

Json to_json(const AskedMethod& method) {
  Json json{{"label", method.label},
            {"name", method.name},
            {"options", method.options},
            {"external", method.external()},
            {"in_force", pairs_json(method.in_force)}};
  if (method.external()) json["command"] = method.command;
  return json;
}

Json to_json(const AskedProblem& problem) {
  Json json{{"name", problem.name},
            {"class", problem.cls},
            {"n", problem.n},
            {"nonzeros", problem.nonzeros},
            {"affine", problem.affine},
            {"starts", problem.starts},
            {"known_solutions", problem.known_solutions},
            {"solvable", problem.solvable()},
            {"no_solution", problem.no_solution}};
  if (!problem.file.empty()) {
    json["file"] = problem.file;
    json["crc"] = problem.crc;
  }
  return json;
}

AskedMethod method_of(const Json& json) {
  AskedMethod method{.label = json.at("label").get<std::string>(), .name = json.at("name").get<std::string>()};
  method.options = json.at("options").get<std::vector<std::string>>();
  if (json.at("external").get<bool>()) method.command = json.at("command").get<std::string>();
  for (const auto& [name, value] : json.at("in_force").items())
    method.in_force.emplace_back(name, value.get<std::string>());
  return method;
}

AskedProblem problem_of(const Json& json) {
  AskedProblem problem{.name = json.at("name").get<std::string>(),
                       .file = json.value("file", ""),
                       .cls = json.at("class").get<std::string>()};
  problem.n = json_integer<long long>(json.at("n"), "n");
  problem.nonzeros = json_integer<long long>(json.at("nonzeros"), "nonzeros");
  problem.affine = json.at("affine").get<bool>();
  problem.starts = json_integer(json.at("starts"), "starts", 1, most_starts);
  problem.known_solutions = json_integer<int>(json.at("known_solutions"), "known_solutions");
  problem.no_solution = json.at("no_solution").get<std::string>();
  problem.crc = json.value("crc", "");
  return problem;
}

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

template <class T, class Name>
std::vector<std::string> names_of(const std::vector<T>& items, Name name) {
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const T& item : items) names.push_back(item.*name);
  return names;
}

}  // namespace

Machine Machine::here() {
  Machine machine{.cpu = cpu_model()};
  cpu_set_t set;
  CPU_ZERO(&set);
  machine.cores = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  struct sysinfo memory {};
  if (sysinfo(&memory) == 0)
    machine.memory_mb = static_cast<long long>(memory.totalram) * static_cast<long long>(memory.mem_unit) / (1 << 20);
  utsname name{};
  if (uname(&name) == 0)
    machine.system = fmt::format("{} {} {}", static_cast<const char*>(name.sysname),
                                 static_cast<const char*>(name.release), static_cast<const char*>(name.machine));
  return machine;
}

std::size_t Campaign::cells() const {
  std::size_t pairs = 0;
  for (const AskedProblem& problem : problems) pairs += static_cast<std::size_t>(problem.starts);
  return methods.size() * pairs;
}

void stamp(Campaign& campaign) {
  campaign.version = version_number();
  campaign.build = fmt::format("{:08x}", crc32(read_text("/proc/self/exe")));
  campaign.libraries = library_versions();
  campaign.machine = Machine::here();
  campaign.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                              fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

std::string campaign_json(const Campaign& campaign) {
  Json json = json_header();
  json["campaign"] = format_version;
  json["version"] = campaign.version;
  json["build"] = campaign.build;
  json["libraries"] = campaign.libraries;
  json["date"] = campaign.date;
  json["command_line"] = campaign.command_line;
  const Machine& machine = campaign.machine;
  json["machine"] = {
      {"cpu", machine.cpu}, {"cores", machine.cores}, {"memory_mb", machine.memory_mb}, {"system", machine.system}};
  json["tol"] = campaign.tol;
  json["time_limit"] = campaign.time_limit;
  json["memory_limit_mb"] = campaign.memory_mb;
  json["restarts"] = campaign.restarts;
  json["seed"] = campaign.seed;
  json["starts"] = campaign.starts == 0 ? Json("all") : Json(campaign.starts);
  json["jobs"] = campaign.jobs;
  json["methods"] = Json::array();
  for (const AskedMethod& method : campaign.methods) json["methods"].push_back(to_json(method));
  json["problems"] = Json::array();
  for (const AskedProblem& problem : campaign.problems) json["problems"].push_back(to_json(problem));
  return json_text(json);
}

Campaign parse_campaign(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    if (const int format = json_integer<int>(json.at("campaign"), "campaign"); format != format_version)
      throw InputError(fmt::format("written in format {}, of another version", format));
    Campaign campaign;
    campaign.version = json.at("version").get<std::string>();
    campaign.build = json.at("build").get<std::string>();
    campaign.libraries = json.at("libraries").get<std::vector<std::string>>();
    campaign.date = json.at("date").get<std::string>();
    campaign.command_line = json.at("command_line").get<std::vector<std::string>>();
    const Json& machine = json.at("machine");
    campaign.machine = {.cpu = machine.at("cpu").get<std::string>(),
                        .cores = json_integer<int>(machine.at("cores"), "cores"),
                        .memory_mb = json_integer<long long>(machine.at("memory_mb"), "memory_mb"),
                        .system = machine.at("system").get<std::string>()};
    campaign.tol = json.at("tol").get<double>();
    campaign.time_limit = json.at("time_limit").get<double>();
    campaign.memory_mb = json_integer<long long>(json.at("memory_limit_mb"), "memory_limit_mb");
    campaign.restarts = json_integer(json.at("restarts"), "restarts", 0);
    campaign.seed = json_integer<unsigned>(json.at("seed"), "seed");
    campaign.starts = json.at("starts").is_string() ? 0 : json_integer(json.at("starts"), "starts", 0);
    campaign.jobs = json_integer<int>(json.at("jobs"), "jobs");
    for (const Json& method : json.at("methods")) campaign.methods.push_back(method_of(method));
    for (const Json& problem : json.at("problems")) campaign.problems.push_back(problem_of(problem));
    std::size_t pairs = 0;
    for (const AskedProblem& problem : campaign.problems) pairs += static_cast<std::size_t>(problem.starts);
    if (pairs > most_cells || campaign.cells() > most_cells)
      throw InputError(fmt::format("more than {} cells", most_cells));
    return campaign;
  } catch (const Json::exception& error) {
    throw InputError(error.what());
  }
}

Campaign read_campaign(const std::string& dir) {
  const std::string path = dir + "/campaign.json";
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(fmt::format("'{}' cannot be read", path));
  try {
    return parse_campaign(read_text(path));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  }
}

std::vector<std::string> differences(const Campaign& before, const Campaign& now) {
  std::vector<std::string> found;
  compare_names("methods", names_of(before.methods, &AskedMethod::label), names_of(now.methods, &AskedMethod::label),
                found);
  compare_names("problems", names_of(before.problems, &AskedProblem::name), names_of(now.problems, &AskedProblem::name),
                found);
  for (const AskedMethod& method : now.methods) {
    const auto same = std::ranges::find(before.methods, method.label, &AskedMethod::label);
    if (same == before.methods.end()) continue;
    compare_value("command of " + method.label, same->command, method.command, found);
    for (const auto& [option, value] : method.in_force) {
      const auto old = std::ranges::find(same->in_force, option, &std::pair<std::string, std::string>::first);
      compare_value(fmt::format("option {} of {}", option, method.label),
                    old == same->in_force.end() ? std::string("(none)") : old->second, value, found);
    }
  }
  for (const AskedProblem& problem : now.problems) {
    const auto same = std::ranges::find(before.problems, problem.name, &AskedProblem::name);
    if (same == before.problems.end()) continue;
    compare_value("file of " + problem.name, same->file, problem.file, found);
    compare_value("content (CRC) of " + problem.name, same->crc, problem.crc, found);
    compare_value("size of " + problem.name, same->n, problem.n, found);
    compare_value("starts of " + problem.name, same->starts, problem.starts, found);
  }
  compare_value("--tol", before.tol, now.tol, found);
  compare_value("--time-limit", before.time_limit, now.time_limit, found);
  compare_value("--memory-limit", before.memory_mb, now.memory_mb, found);
  compare_value("--restarts", before.restarts, now.restarts, found);
  compare_value("--seed", before.seed, now.seed, found);
  compare_value("version of perp", before.version, now.version, found);
  return found;
}

}  // namespace perp::app::compare
