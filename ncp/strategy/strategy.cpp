// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/strategy.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <stdexcept>
#include <utility>

#include "lcp/gpl.hpp"
#include "ncp/strategy/attempts.hpp"
#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/strategy_node.hpp"
#include "ncp/transforms/scale_transform.hpp"

namespace perp::ncp {
namespace {

using Kind = StrategyNode::Kind;

constexpr std::pair<std::string_view, Kind> words[] = {
    {"presolved", Kind::Presolved}, {"scaled", Kind::Scaled}, {"escape", Kind::Escaping}, {"first", Kind::FirstOf}};

std::string_view word_of(Kind kind) {
  return std::ranges::find(words, kind, &std::pair<std::string_view, Kind>::second)->first;
}

struct Named {
  std::string name;
  Method method;
};

Strategy made(Kind kind, std::vector<Named> parts, const Escape& escape = {}) {
  auto node = std::make_shared<StrategyNode>();
  node->kind = kind;
  node->escape = escape;
  node->text = std::string(word_of(kind)) + '(';
  for (Named& part : parts) {
    node->text += (node->methods.empty() ? "" : ", ") + part.name;
    node->names.push_back(std::move(part.name));
    node->methods.push_back(std::move(part.method));
  }
  node->text += ')';
  return {.stop = {}, .tree = std::move(node)};
}

Named named(Method method) {
  std::string of(name(method));
  return {std::move(of), std::move(method)};
}

/// Recursive descent over  METHOD = WORD '(' METHOD {',' METHOD} ')' | PRESET.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  Named whole() {
    Named method = next(0);
    if (at_ < text_.size()) refuse("'" + std::string(text_.substr(at_)) + "' follows the end");
    return method;
  }

 private:
  Named next(int depth) {
    constexpr int deepest = 20;
    if (depth > deepest) refuse("it is nested more than " + std::to_string(deepest) + " deep");
    const std::string word = read_word();
    const auto* found = std::ranges::find(words, word, &std::pair<std::string_view, Kind>::first);
    if (!take('(')) {
      if (found != std::end(words)) refuse("'" + word + "' needs methods in parentheses");
      const Preset* preset = find_preset(word);
      if (lcp::left_out(word)) refuse(lcp::not_in_this_build(word));
      if (preset == nullptr) refuse(word.empty() ? "a method is missing" : "there is no method '" + word + "'");
      return {word, preset->method};
    }
    if (found == std::end(words))
      refuse("'" + word + "' is none of presolved, scaled, escape and first, which take methods in parentheses");
    std::vector<Named> parts;
    do parts.push_back(next(depth + 1));
    while (take(','));
    if (!take(')')) refuse("a ')' is missing");
    if (found->second != Kind::FirstOf && parts.size() > 1) refuse("'" + word + "' takes one method");
    const Strategy strategy = made(found->second, std::move(parts));
    return {strategy.tree->text, strategy};
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
  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument("'" + std::string(text_) + "', character " + std::to_string(at_ + 1) + ": " + why);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

void run_scaled(Run& run, In x0, const Body& body) {
  const Vec start = lcp::project(run.box(), x0);
  if (const auto factors = factors_at(run, start)) {
    run.take(run.within(ScaleTransform(run.mcp(), *factors), {}, start, body));
  } else {
    body(run, x0);
    run.remark("not scaled: that brings no entries of J together");
  }
}

void run_first_of(Run& run, In x0, const StrategyNode& node) {
  Point start;
  if (!run.start(x0, start)) return;
  const std::vector<Attempt> list = first_list(node);
  Tried tried;
  in_turn(run, start, list, static_cast<int>(list.size()), tried);
  if (stuck(run)) run.replace_verdict(tried.verdicts.front());
  run.stats().restarts += static_cast<int>(tried.attempts.size()) - 1;
  std::string all = "tried " + tried.attempts.front()->name;
  for (std::size_t i = 1; i < tried.attempts.size(); ++i) all += ", then " + tried.attempts[i]->name;
  run.remark(all);
}

}  // namespace

Strategy presolved(Method method) { return made(Kind::Presolved, {named(std::move(method))}); }
Strategy scaled(Method method) { return made(Kind::Scaled, {named(std::move(method))}); }
Strategy escaping(Method method, const Escape& escape) {
  return made(Kind::Escaping, {named(std::move(method))}, escape);
}
Strategy first_of(std::vector<Method> methods) {
  if (methods.empty()) throw std::invalid_argument("first_of: no methods");
  std::vector<Named> parts;
  for (Method& method : methods) parts.push_back(named(std::move(method)));
  return made(Kind::FirstOf, std::move(parts));
}

Method method_of(std::string_view text) { return Reader(text).whole().method; }

std::string_view name_of(const Strategy& strategy) {
  return strategy.tree == nullptr ? std::string_view("strategy") : std::string_view(strategy.tree->text);
}

void describe(Strategy& strategy, Fields& f) {
  if (strategy.tree == nullptr) return f.check(false, "the strategy is empty");
  for (const Method& method : strategy.tree->methods)
    if (const auto why = invalid(method)) f.check(false, std::string(name(method)) + ": " + *why);
  Fields escapes;  // they are the tree's own
  Escape escape = strategy.tree->escape;
  describe(escape, escapes);
  if (const auto why = escapes.invalid()) f.check(false, *why);
}

std::vector<Attempt> first_list(const StrategyNode& node) {
  std::vector<Attempt> list;
  for (std::size_t i = 0; i < node.methods.size(); ++i) {
    const auto go = [method = node.methods[i], last = i + 1 == node.methods.size()](Run& run, const Point& start) {
      run.take(run.within(run.mcp(), part_of_left(run, last), start.x,
                          [&](Run& inner, In z) { run_method(inner, z, method); }));
    };
    list.push_back({.name = node.names[i], .what = node.names[i], .go = go});
  }
  return list;
}

void run_strategy(Run& run, In x0, const StrategyNode& node) {
  const Body body = [&](Run& inner, In z) { run_method(inner, z, node.methods.front()); };
  switch (node.kind) {
    case Kind::Presolved:
      return run_presolved(run, x0, {}, [&](Run& inner, In z, const auto&) { body(inner, z); });
    case Kind::Scaled:
      return run_scaled(run, x0, body);
    case Kind::Escaping:
      body(run, x0);
      return escape(run, node.escape, no_limit, body);
    case Kind::FirstOf:
      return run_first_of(run, x0, node);
  }
}

}  // namespace perp::ncp
