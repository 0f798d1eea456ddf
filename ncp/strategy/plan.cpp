// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/plan.hpp"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <stdexcept>

#include "lcp/gpl.hpp"
#include "ncp/problem/words.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::ncp {

Held::Held() : Held(Method{}) {}
struct Held::Shared {
  explicit Shared(Method m) : method(std::move(m)) {}
  Method method;
  std::atomic<bool> valid{false};  // checked already
};

Held::Held(Method method) : shared_(std::make_shared<Shared>(std::move(method))) {}
const Method& Held::operator*() const { return shared_->method; }
Method& Held::operator*() {
  if (shared_.use_count() > 1) shared_ = std::make_shared<Shared>(shared_->method);
  shared_->valid = false;
  return shared_->method;
}

namespace {

constexpr std::pair<std::string_view, Form> forms[] = {
    {"presolved", Form::Presolved}, {"scaled", Form::Scaled}, {"rescaled", Form::Rescaled}, {"blocks", Form::Blocks}};

const Form* form_named(std::string_view word) {
  const auto* found = std::ranges::find(forms, word, &std::pair<std::string_view, Form>::first);
  return found == std::end(forms) ? nullptr : &found->second;
}

std::string_view word_of(Form form) {
  return std::ranges::find(forms, form, &std::pair<std::string_view, Form>::second)->first;
}

std::string composed_name(const On& m) { return text_of("on(", word_of(m.form), ", ", name(*m.method), ')'); }
std::string composed_name(const Escaping& m) { return "escape(" + name(*m.method) + ')'; }
std::string composed_name(const First& m) {
  std::string text = "first(";
  for (const Entry& entry : m.entries) text += (text.ends_with('(') ? "" : ", ") + name(*entry.method);
  return text + ')';
}

/// Recursive descent over  METHOD = first(METHOD {, METHOD}) | on(FORM, METHOD) | FORM(METHOD) | escape(METHOD) |
/// PRESET.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  Method whole() {
    Method method = next(0);
    if (at_ < text_.size()) refuse("'" + std::string(text_.substr(at_)) + "' follows the end");
    return method;
  }

 private:
  Method next(int depth) {
    constexpr int deepest = 20;
    if (depth > deepest) refuse("it is nested more than " + std::to_string(deepest) + " deep");
    const std::string word = read_word();
    const Form* form = form_named(word);
    const bool composes = form != nullptr || word == "on" || word == "escape" || word == "first";
    if (!take('(')) return composes ? refuse("'" + word + "' needs methods in parentheses") : preset(word);
    if (!composes)
      refuse("'" + word +
             "' is none of first, on, escape, presolved, scaled, rescaled and blocks, which take methods "
             "in parentheses");
    if (word == "on") {
      const std::string of = read_word();
      form = form_named(of);
      if (form == nullptr) refuse("'" + of + "' is none of presolved, scaled, rescaled and blocks");
      if (!take(',')) refuse("a ',' and a method are missing");
    }
    std::vector<Method> parts;
    do parts.push_back(next(depth + 1));
    while (take(','));
    if (!take(')')) refuse("a ')' is missing");
    if (word == "first") return first(std::move(parts));
    if (parts.size() > 1) refuse("'" + word + "' takes one method");
    return form != nullptr ? on(*form, std::move(parts[0])) : escaping(std::move(parts[0]));
  }

  Method preset(const std::string& word) {
    if (lcp::left_out(word)) refuse(lcp::not_in_this_build(word));
    const Preset* preset = find_preset(word);
    if (preset == nullptr) refuse(word.empty() ? "a method is missing" : "there is no method '" + word + "'");
    return preset->method;
  }

  std::string read_word() {
    skip();
    std::string word;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '-'))
      word += text_[at_++];
    return word;
  }
  bool take(char c) {
    skip();
    const bool there = at_ < text_.size() && text_[at_] == c;
    if (there) ++at_;
    skip();
    return there;
  }
  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  [[noreturn]] Method refuse(const std::string& why) const {
    throw std::invalid_argument("'" + std::string(text_) + "', character " + std::to_string(at_ + 1) + ": " + why);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// The methods that a composition is made of; none of a kernel.
template <class M>
auto methods_in(M& method) {
  std::vector<decltype(&method)> inner;
  std::visit(
      [&inner](auto& m) {
        if constexpr (requires { m.method.operator*(); })
          inner.push_back(&*m.method);
        else if constexpr (requires { m.entries; })
          for (auto& entry : m.entries) inner.push_back(&*entry.method);
      },
      method);
  return inner;
}

/// The options of the method but for its limits.
void describe_own(Method& method, Fields& f);

void describe(On& m, Fields& f) {
  if (m.form == Form::Presolved)
    f.add("preprocess", &m.enabled, "presolve: remove what constant rows and columns decide");
  m.method.describe(f);
}

void describe(Escaping& m, Fields& f) {
  m.method.describe(f);
  describe(m.escape, f);
}

void describe(First& m, Fields& f) {
  if (m.entries.empty()) return f.check(false, "a list of methods is empty");
  for (Entry& entry : m.entries) entry.method.describe(f);
  if (m.restart_limit)
    f.add("restart_limit", &*m.restart_limit, at_least(0),
          "number of attempts after the first; 'perp methods --show' lists them");
}

void describe_own(Method& method, Fields& f) {
  std::visit([&](auto& m) { describe(m, f); }, method);
}

std::string joined(const std::vector<Condition>& conditions, From from) {
  std::string all;
  for (const Condition condition : conditions) {
    if (condition == Condition::Cold) continue;  // a warm basis is the user's wish
    all += text_of(all.empty() ? "if " : ", ", words_of(condition));
  }
  if (const std::string_view where = words_of(from); !where.empty()) all += text_of(all.empty() ? "" : "; ", where);
  return all;
}

/// The list of the methods for affine problems.
void add_lines(const lcp::Auto& list, int depth, std::vector<OutlineLine>& lines) {
  for (const lcp::Attempt& attempt : list.list) {
    std::string when;
    for (const lcp::Condition condition : attempt.when)
      when += text_of(when.empty() ? "if " : ", ", lcp::words_of(condition));
    lines.push_back({depth, std::string(attempt.title.empty() ? lcp::name(attempt.method) : attempt.title),
                     std::move(when), std::string(attempt.reason), std::string(attempt.worth)});
  }
}

void add_lines(const Method& method, int depth, std::vector<OutlineLine>& lines) {
  if (const auto* affine = std::get_if<Affine>(&method))
    if (const auto* list = std::get_if<lcp::Auto>(&affine->method)) return add_lines(*list, depth, lines);
  if (const auto* list = std::get_if<First>(&method)) {
    for (const Entry& entry : list->entries) {
      std::string what = name(*entry.method);
      if (!entry.title.empty()) what += text_of(": ", entry.title);
      lines.push_back({depth, std::move(what), joined(entry.when, entry.from), std::string(entry.reason),
                       std::string(entry.worth)});
      add_lines(*entry.method, depth + 1, lines);
    }
    return;
  }
  for (const Method* inner : methods_in(method)) add_lines(*inner, depth, lines);
}

}  // namespace

std::string_view words_of(From from) {
  switch (from) {
    case From::Start:
      return "";
    case From::Best:
      return "from the best point";
    case From::Origin:
      return "from the origin";
    case From::UnitBox:
      return "from a point of the unit box";
  }
  return "";
}

Method on(Form form, Method method) {
  const Stop limits = stop(method);
  return On{.stop = limits, .form = form, .method = std::move(method)};
}
Method escaping(Method method, const Escape& escape) {
  const Stop limits = stop(method);
  return Escaping{.stop = limits, .escape = escape, .method = std::move(method)};
}
Method first(std::vector<Method> methods) {
  if (methods.empty()) throw std::invalid_argument("first: no methods");
  First list;
  for (Method& method : methods) list.entries.push_back({.method = std::move(method)});
  return list;
}

Method method_of(std::string_view text) { return Reader(text).whole(); }

std::string name(const Method& method) {
  return std::visit(
      [](const auto& m) -> std::string {
        if constexpr (requires { m.name; })
          return m.name.empty() ? composed_name(m) : m.name;
        else
          return std::string(name_of(m));
      },
      method);
}

void Held::describe(Fields& fields) {
  if (!fields.checking()) return describe_own(**this, fields);
  if (shared_->valid) return;
  Fields own(Fields::Purpose::Check);
  Method copy = shared_->method;
  describe_own(copy, own);
  const auto why = own.invalid();
  shared_->valid = !why;
  if (why) fields.check(false, *why);
}

void describe(Method& method, Fields& fields) {
  describe(stop(method), fields);
  describe_own(method, fields);
  if (!std::holds_alternative<Affine>(method)) return;
  for (const char* of_iterations : {"major_iteration_limit", "stall_limit"})  // these count pivots, sweeps, ...
    fields.hide(of_iterations);
}

std::vector<Method*> parts_named(Method& method, std::string_view name) {
  std::vector<Method*> parts;
  if (ncp::name(method) == name) parts.push_back(&method);
  for (Method* inner : methods_in(method)) {
    const std::vector<Method*> there = parts_named(*inner, name);
    parts.insert(parts.end(), there.begin(), there.end());
  }
  return parts;
}

std::optional<std::string> invalid(const Method& method) {
  Method described = method;
  Fields fields(Fields::Purpose::Check);
  describe(described, fields);
  return fields.invalid();
}

const PathSearch* path_of(const Method& method) {
  if (const auto* path = std::get_if<PathSearch>(&method)) return path;
  for (const Method* inner : methods_in(method))
    if (const PathSearch* path = path_of(*inner)) return path;
  return nullptr;
}

const Stop& stop(const Method& method) {
  return std::visit([](const auto& m) -> const Stop& { return m.stop; }, method);
}

Stop& stop(Method& method) {
  return std::visit([](auto& m) -> Stop& { return m.stop; }, method);
}

std::vector<OutlineLine> outline(const Method& method) {
  std::vector<OutlineLine> lines;
  add_lines(method, 0, lines);
  if (lines.empty()) lines.push_back({.depth = 0, .method = name(method), .when = "", .reason = "", .worth = ""});
  return lines;
}

}  // namespace perp::ncp
