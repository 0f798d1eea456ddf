// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "ncp/strategy/attempts.hpp"
#include "ncp/strategy/strategy_node.hpp"

namespace perp::ncp {
namespace {

std::vector<Outline::Line> lines(const std::vector<Attempt>& list, int restart_limit) {
  std::vector<Outline::Line> out;
  int restarts = 0;
  for (const Attempt& attempt : list) {
    if (attempt.counted && restarts == restart_limit) break;
    if (attempt.counted && attempt.when.empty()) ++restarts;  // others may be left out
    out.push_back({attempt.name, attempt.what, attempt.when});
  }
  return out;
}

/// Runs on the scaled problem, then escapes.
std::vector<Outline::Line> afterwards(const std::string& name, int rescalings, bool escapes) {
  std::vector<Outline::Line> out{{"the options given", name, ""}};
  const std::string base = escapes ? "escape(" + name + ")" : name;
  if (rescalings > 0) out.push_back({std::string(scaled_at_best), "scaled(" + base + ")", ""});
  if (rescalings > 1) out.push_back({std::string(scaled_at_start), "scaled(" + base + ")", ""});
  if (escapes) out.push_back({"proximal escape", base, ""});
  return out;
}

}  // namespace

Outline outline(const Method& method) {
  if (const auto* path = std::get_if<PathSearch>(&method)) {
    std::vector<Attempt> list = path_list(*path);
    std::ranges::move(path_restarts(*path), std::back_inserter(list));
    return {.lines = lines(list, path->restart_limit), .presolved = path->preprocess};
  }
  if (const auto* choosing = std::get_if<Auto>(&method)) {
    const std::vector<Attempt> list = auto_list(*choosing);
    return {.lines = lines(list, static_cast<int>(list.size()))};
  }
  if (const auto* strategy = std::get_if<Strategy>(&method); strategy != nullptr && strategy->tree != nullptr)
    if (strategy->tree->kind == StrategyNode::Kind::FirstOf) {
      const std::vector<Attempt> list = first_list(*strategy->tree);
      return {.lines = lines(list, static_cast<int>(list.size()))};
    }
  return {.lines = afterwards(std::string(name(method)), rescalings_of(method), escape_of(method).rounds > 0)};
}

}  // namespace perp::ncp
