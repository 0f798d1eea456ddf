// SPDX-License-Identifier: Apache-2.0
/// Options by PATH's names and ours.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string_view>

#include "capi/path/thread_state.hpp"
#include "lcp/io/file_path.hpp"

struct _Options_Interface {  // NOLINT(bugprone-reserved-identifier): as its clients declare it
  std::shared_ptr<perp::path::OptionSet> set = std::make_shared<perp::path::OptionSet>();
};

namespace perp::path {

OptionSet::OptionSet() {
  perp_solver* solver = nullptr;
  if (perp_solver_create(PERP_INTERFACE, &solver, nullptr) != PERP_OK) throw std::bad_alloc();
  solver_.reset(solver);
}

std::string OptionSet::set(const std::string& key, const std::string& value) {
  perp_error error{};
  return perp_solver_set(solver(), key.c_str(), value.c_str(), &error) == PERP_OK ? "" : error.message;
}

std::string OptionSet::get(const std::string& key) const {
  std::array<char, 256> value{};
  return perp_solver_get(solver(), key.c_str(), value.data(), value.size(), nullptr) == PERP_OK ? value.data() : "-";
}

void OptionSet::clear() { perp_solver_clear_options(solver(), nullptr); }

namespace {

/// The options of a handle, which from now on are the thread's; null of null.
OptionSet* touched(const Options_Interface* o) {
  if (o == nullptr) return nullptr;
  this_thread().options = o->set;
  return o->set.get();
}

constexpr std::string_view space = " \t\r\n;=";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(space);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(space) - first + 1);
}

int set(const Options_Interface* o, const std::string& key, const std::string& value) {
  OptionSet* options = touched(o);
  if (options == nullptr) return 1;
  const std::string refusal = options->set(key, value);
  if (refusal.empty()) return 0;
  warn(" ** " + refusal);
  return 1;
}

/// "key value" or "key = value".
int set_line(const Options_Interface* o, std::string_view line) {
  line = trimmed(line);
  const std::size_t end = line.find_first_of(space);
  const std::string_view value = end == std::string_view::npos ? std::string_view{} : trimmed(line.substr(end));
  return set(o, std::string(line.substr(0, end)), std::string(value));
}

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '*' || line.front() == '#';
}

int read(const Options_Interface* o, const char* path) {
  std::ifstream file(lcp::file_path(path));
  if (!file) {
    tell(Output_Log, std::string("Options file ") + path + " cannot be read.\n");
    return 1;
  }
  tell(Output_Log, std::string("Options of file ") + path + ":\n");
  int failed = 0;
  for (std::string line; std::getline(file, line);) {
    if (is_comment(line)) continue;
    tell(Output_Log, " > " + line + "\n");
    failed |= set_line(o, line);
  }
  return failed;
}

void display(const OptionSet& options) {
  if (!options.on("output_options")) return;
  perp_result* list = nullptr;
  perp_list(PERP_INTERFACE, "options", &list, nullptr);
  for (std::int64_t i = 0; i < perp_result_length(list, "items"); ++i) {
    const char* key = perp_result_text(perp_result_part(list, "items", i), "key", 0);
    if (const std::string value = options.get(key); value != "-")
      tell(Output_Log, std::string(key) + " " + value + "\n");
  }
  perp_result_free(list);
}

template <class Number, class Convert>
Number number(const Options_Interface* o, const char* key, Convert convert) {
  const OptionSet* options = touched(o);
  if (options == nullptr || key == nullptr) return 0;
  return convert(options->get(key).c_str());
}

/// Nothing is thrown across the wall.
template <class Answer, class Body>
Answer safely(Answer otherwise, Body body) {
  try {
    return body();
  } catch (const std::exception&) {
    return otherwise;
  }
}

}  // namespace

}  // namespace perp::path

using namespace perp::path;  // NOLINT(google-build-using-namespace): what follows is the interface of C

Options_Interface* Options_Create(void) {
  return safely<Options_Interface*>(nullptr, [] {
    auto made = std::make_unique<Options_Interface>();
    touched(made.get());
    return made.release();
  });
}
void Options_Destroy(Options_Interface* o) { delete o; }
void Path_AddOptions(Options_Interface* o) { touched(o); }
void Options_Default(const Options_Interface* o) {
  if (OptionSet* options = touched(o)) options->clear();
}
void Options_Display(const Options_Interface* o) {
  safely(0, [&] {
    if (const OptionSet* options = touched(o)) display(*options);
    return 0;
  });
}
int Options_Read(const Options_Interface* o, const char* file) {
  return safely(1, [&] { return file == nullptr || touched(o) == nullptr ? 1 : read(o, file); });
}
int Options_Set(const Options_Interface* o, const char* key_and_value) {
  return safely(1, [&] { return key_and_value == nullptr ? 1 : set_line(o, key_and_value); });
}
int Options_SetBoolean(const Options_Interface* o, const char* key, int value) {
  return safely(1, [&] { return key == nullptr ? 1 : set(o, key, value != 0 ? "yes" : "no"); });
}
int Options_SetInt(const Options_Interface* o, const char* key, int value) {
  return safely(1, [&] { return key == nullptr ? 1 : set(o, key, std::to_string(value)); });
}
int Options_SetDouble(const Options_Interface* o, const char* key, double value) {
  return safely(1, [&] {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.17g", value);
    return key == nullptr ? 1 : set(o, key, text.data());
  });
}
int Options_SetOther(const Options_Interface* /*o*/, const char* key, int /*value*/) {
  return safely(1, [&] {
    warn(std::string(" ** ") + (key == nullptr ? "an option" : key) + ": its words have no numbers here");
    return 1;
  });
}
int Options_GetBoolean(const Options_Interface* o, const char* key) {
  return safely(0, [&] { return number<int>(o, key, [](std::string_view text) { return text == "yes" ? 1 : 0; }); });
}
int Options_GetInt(const Options_Interface* o, const char* key) {
  return safely(0, [&] { return number<int>(o, key, [](const char* text) { return std::atoi(text); }); });
}
double Options_GetDouble(const Options_Interface* o, const char* key) {
  return safely(0.0,
                [&] { return number<double>(o, key, [](const char* text) { return std::strtod(text, nullptr); }); });
}
int Options_GetOther(const Options_Interface* /*o*/, const char* /*key*/) { return 0; }
