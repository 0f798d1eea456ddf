// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/selection.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <glob.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include "app/problem/problem.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::app::compare {

namespace {

namespace fs = std::filesystem;
namespace collection = ncp::collection;

struct Item {
  std::string text;
  bool take = true;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\n") + 1 - first);
}

/// Of the comma that ends an item: those in parentheses belong to strategies.
std::size_t end_of_item(const std::string& list, std::size_t begin) {
  int depth = 0;
  for (std::size_t at = begin; at < list.size(); ++at) {
    if (list[at] == '(') ++depth;
    if (list[at] == ')') --depth;
    if (list[at] == ',' && depth <= 0) return at;
  }
  return list.size();
}

/// The items of a LIST; "all" before them where nothing is taken.
std::vector<Item> items_of(const std::string& list, const char* flag) {
  std::vector<Item> items;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = end_of_item(list, begin);
    const std::string text = trimmed(list.substr(begin, end - begin));
    if (text.empty() || text == "-") throw input_error("{} '{}': an item is empty", flag, list);
    items.push_back(text.starts_with('-') ? Item{text.substr(1), false} : Item{text});
    begin = end + 1;
  }
  if (std::ranges::none_of(items, &Item::take)) items.insert(items.begin(), {"all"});
  return items;
}

bool is_pattern(const std::string& text) { return text.find_first_of("*?[") != std::string::npos; }

bool matches(const std::string& pattern, std::string_view name) {
  return fnmatch(pattern.c_str(), std::string(name).c_str(), 0) == 0;
}

/// What the items take, in order, without what they take away.
template <class T, class Expand>
std::vector<T> select(const std::vector<Item>& items, std::string T::*name, Expand expand) {
  std::vector<T> taken;
  std::set<std::string> seen;
  std::set<std::string> away;
  for (const Item& item : items) {
    for (T& found : expand(item)) {
      if (!item.take)
        away.insert(found.*name);
      else if (seen.insert(found.*name).second)
        taken.push_back(std::move(found));
    }
  }
  std::erase_if(taken, [&](const T& item) { return away.contains(item.*name); });
  return taken;
}

// Problems.

constexpr const char* problems_flag = "--problems";

AskedProblem of_collection(const collection::Entry& entry) {
  return {.name = std::string(entry.name), .cls = std::string(entry.problem_class)};
}

template <class Test>
std::vector<AskedProblem> entries_where(Test test) {
  std::vector<AskedProblem> found;
  for (const collection::Entry& entry : collection::entries())
    if (test(entry)) found.push_back(of_collection(entry));
  return found;
}

std::vector<AskedProblem> of_class(const std::string& cls) {
  std::vector<AskedProblem> found =
      entries_where([&](const collection::Entry& entry) { return matches(cls, entry.problem_class); });
  if (!found.empty()) return found;
  std::set<std::string_view> classes;
  for (const collection::Entry& entry : collection::entries()) classes.insert(entry.problem_class);
  throw input_error("{}: there is no class '{}'; the collection has {}", problems_flag, cls, fmt::join(classes, ", "));
}

bool is_file(const std::string& text) {
  return text.ends_with(".nl") || text.ends_with(".dat") || text.find('/') != std::string::npos;
}

AskedProblem of_file(const std::string& path) {
  std::error_code ignored;
  if (!path.ends_with(".nl") && !path.ends_with(".dat"))
    throw input_error("{}: '{}' is neither an .nl nor a .dat file", problems_flag, path);
  if (!fs::is_regular_file(path, ignored)) throw input_error("{}: there is no file '{}'", problems_flag, path);
  check_utf8(fs::canonical(path));
  return {.name = fs::path(path).filename(), .file = fs::canonical(path), .cls = path.ends_with(".nl") ? "nl" : "dat"};
}

std::vector<AskedProblem> of_files(const std::string& pattern) {
  if (!is_pattern(pattern)) return {of_file(pattern)};
  struct Paths : glob_t {
    Paths() : glob_t{} {}
    Paths(const Paths&) = delete;
    Paths& operator=(const Paths&) = delete;
    ~Paths() { globfree(this); }
  } paths;
  std::vector<AskedProblem> found;
  if (glob(pattern.c_str(), 0, nullptr, &paths) == 0)
    for (std::size_t k = 0; k < paths.gl_pathc; ++k) {
      found.push_back(of_file(paths.gl_pathv[k]));
      found.back().by_pattern = true;
    }
  if (found.empty()) throw input_error("{}: no file fits '{}'", problems_flag, pattern);
  return found;
}

std::vector<AskedProblem> problems_of(const Item& item) {
  constexpr std::string_view class_prefix = "class:";
  const std::string& text = item.text;
  if (text == "all") return entries_where([](const collection::Entry&) { return true; });
  if (text.starts_with(class_prefix)) return of_class(text.substr(class_prefix.size()));
  if (is_file(text)) return of_files(text);
  if (is_pattern(text)) {
    std::vector<AskedProblem> found =
        entries_where([&](const collection::Entry& entry) { return matches(text, entry.name); });
    if (found.empty()) throw input_error("{}: no problem of the collection fits '{}'", problems_flag, text);
    return found;
  }
  const std::string name = text.substr(0, text.find(':'));
  const collection::Entry& entry = find_entry(name);  // throws, with a suggestion
  AskedProblem problem = of_collection(entry);
  problem.name = text;
  return {std::move(problem)};
}

// Methods.

constexpr const char* methods_flag = "--methods";

AskedMethod of_method(const std::string& label) {
  AskedMethod method{.label = label, .name = label.substr(0, label.find(':'))};
  for (std::size_t at = method.name.size(); at < label.size();) {
    const std::size_t end = std::min(label.find(':', at + 1), label.size());
    method.options.push_back(label.substr(at + 1, end - at - 1));
    at = end;
  }
  return method;
}

template <class Names>
std::vector<AskedMethod> of_names(const Names& names) {
  std::vector<AskedMethod> found;
  found.reserve(names.size());
  for (const auto& name : names) found.push_back(of_method(std::string(name)));
  return found;
}

/// Is the value in the range of the function's parameter of that name?
bool takes(const ncp::CFunction& c, const Assignment& given) {
  if (!c.parameter || c.parameter->name != given.key) return false;
  double value = 0;
  const char* last = given.value.data() + given.value.size();
  const auto [end, error] = std::from_chars(given.value.data(), last, value);
  return error == std::errc() && end == last && value > c.parameter->low && value < c.parameter->high;
}

/// Of cfunctions:rho=0.01:rho=100:lu=klu: semismooth over all functions, those with a rho at the given ones; what is
/// the name of no parameter is an option of all.
std::vector<std::string> with_each_cfunction(const std::string& text) {
  const std::string source = fmt::format("{} {}", methods_flag, text);
  const auto functions = ncp::cfunctions();
  std::vector<Assignment> values;
  std::string options;
  for (const std::string& option : of_method(text).options) {
    const Assignment given = parse_assignment(option, source);
    if (std::ranges::none_of(functions, [&](const auto& c) { return c.parameter && c.parameter->name == given.key; }))
      options += ":" + option;
    else if (std::ranges::none_of(functions, [&](const auto& c) { return takes(c, given); }))
      throw input_error("{}: no C-function takes {}; 'perp cfunctions' has the ranges", source, option);
    else
      values.push_back(given);
  }
  std::vector<std::string> names;
  for (const ncp::CFunction& c : functions) {
    const std::string name = "semismooth:cfunction=" + c.name;
    const std::size_t before = names.size();
    for (const Assignment& given : values)
      if (takes(c, given)) names.push_back(fmt::format("{}:cfunction_parameter={}{}", name, given.value, options));
    if (names.size() == before) names.push_back(name + options);
  }
  return names;
}

std::vector<AskedMethod> methods_of(const Item& item) {
  const std::string& text = item.text;
  std::vector<std::string> names;
  if (text == "none") return {};
  if (text == "all") return of_names(method_names());
  if (text == "presets") {
    for (const ncp::Preset& preset : ncp::presets()) names.emplace_back(preset.name);
    return of_names(names);
  }
  if (text == "published") {
    for (const ncp::Preset& preset : ncp::published()) names.emplace_back(preset.name);
    return of_names(names);
  }
  if (text == "cfunctions" || text.starts_with("cfunctions:")) return of_names(with_each_cfunction(text));
  if (text == "cfunction-grid") {
    for (const ncp::CFunction& c : ncp::cfunction_grid())
      names.push_back(fmt::format("semismooth:cfunction={}:cfunction_parameter={:g}", c.name, c.parameter->value));
    return of_names(names);
  }
  const std::string name = text.substr(0, text.find(':'));
  const std::string rest = text.substr(name.size());
  for (const std::string_view method : method_names())
    if (method == name || (is_pattern(name) && matches(name, method))) names.push_back(std::string(method) + rest);
  if (!names.empty()) return of_names(names);
  if (const auto strategy = method_named(name)) return {of_method(std::string(ncp::name(*strategy)) + rest)};
  if (is_pattern(name)) throw input_error("{}: no method fits '{}'", methods_flag, name);
  std::vector<std::string_view> candidates = method_names();
  candidates.insert(candidates.end(), {"presets", "published", "all", "cfunctions", "cfunction-grid", "none"});
  throw input_error("{}: there is no method '{}'.{} 'perp methods' lists them.", methods_flag, name,
                    did_you_mean(name, candidates));
}

bool is_program(const std::string& word) {
  std::error_code ignored;
  const auto runs = [&](const std::string& path) {
    return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
  };
  if (word.find('/') != std::string::npos) return runs(word);
  const char* variable = std::getenv("PATH");
  const std::string path = variable != nullptr ? variable : "/usr/bin:/bin";
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find(':', begin), path.size());
    if (runs(path.substr(begin, end - begin) + "/" + word)) return true;
    begin = end + 1;
  }
  return false;
}

}  // namespace

std::vector<AskedProblem> select_problems(const std::string& list) {
  std::map<std::string, std::string> files;
  const auto expand = [&](const Item& item) {
    std::vector<AskedProblem> found = problems_of(item);
    for (const AskedProblem& problem : found)
      if (const std::string& known = files.try_emplace(problem.name, problem.file).first->second; known != problem.file)
        throw input_error("{}: '{}' is the name of two files, {} and {}", problems_flag, problem.name, known,
                          problem.file);
    return found;
  };
  std::vector<AskedProblem> problems = select(items_of(list, problems_flag), &AskedProblem::name, expand);
  if (problems.empty()) throw input_error("{} '{}': nothing is left", problems_flag, list);
  return problems;
}

std::vector<AskedMethod> select_methods(const std::string& list, double tol, std::vector<std::string>& notes) {
  std::vector<AskedMethod> methods = select(items_of(list, methods_flag), &AskedMethod::label, methods_of);
  for (AskedMethod& method : methods) {
    Applied applied = settings_of(method, tol);
    notes.insert(notes.end(), applied.notes.begin(), applied.notes.end());
    for (const ncp::Field& field : fields_of(applied.settings).options())
      if (const std::string value = value_text(field); value != "-" && field.key != "method")
        method.in_force.emplace_back(field.key, value);
  }
  return methods;
}

Applied settings_of(const AskedMethod& method, double tol) {
  const std::string source = fmt::format("{} {}", methods_flag, method.label);
  std::vector<Assignment> assignments{{"method", method.name, source},
                                      {"convergence_tolerance", fmt::format("{}", tol), source}};
  for (const std::string& option : method.options) {
    assignments.push_back(parse_assignment(option, source));
    if (assignments.back().key == "method") throw input_error("{}: the method is named before the first ':'", source);
  }
  return apply_options(assignments);
}

AskedMethod parse_external(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = trimmed(text.substr(0, equals));
  const std::string command = equals == std::string::npos ? "" : trimmed(text.substr(equals + 1));
  if (name.empty() || command.empty())
    throw input_error("--external '{}': NAME=COMMAND is asked for, as in path=./path_peer", text);
  if (name.find_first_of(",:/*?[ ") != std::string::npos || name.starts_with('-'))
    throw input_error("--external: '{}' is no NAME: letters, digits, _ and - make one", name);
  if (find_method(name) != nullptr) throw input_error("--external: '{}' is a method of perp's own", name);
  const std::string word = command.substr(0, command.find_first_of(" \t"));
  if (word.find_first_of("'\"$`\\(") == std::string::npos && !is_program(word))
    throw input_error("--external {}: '{}' is no program that can be run", name, word);
  return {.label = name, .name = name, .command = command};
}

}  // namespace perp::app::compare
