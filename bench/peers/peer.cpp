// SPDX-License-Identifier: Apache-2.0
#include "peer.hpp"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "lcp/box.hpp"
#include "ncp/ampl/model.hpp"

namespace perp::bench {

namespace {

static_assert(static_cast<int>(End::NotTaken) == ncp::ampl::not_applicable);

struct Call {
  std::string stub{};
  std::vector<std::string> words{};
  bool version = false;
  bool help = false;
};

/// The stub is the first argument that is neither an assignment nor begins with a dash; `-AMPL` and other flags of
/// AMPL's change nothing here. An assignment has a bare word before its `=`, so that a path may have one in it.
Call parse(int argc, const char* const* argv) {
  Call call;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    const std::size_t equals = argument.find('=');
    if (argument == "-v" || argument == "--version")
      call.version = true;
    else if (argument == "-=" || argument == "-?" || argument == "--help")
      call.help = true;
    else if (argument.starts_with('-'))
      continue;
    else if (equals != std::string::npos && argument.find_first_of("/.") > equals)
      call.words.push_back(argument);
    else if (call.stub.empty())
      call.stub = argument;
    else
      throw std::invalid_argument("'" + argument + "' is neither an option key=value nor the stub");
  }
  return call;
}

void print_help(const Peer& peer) {
  std::cout << "usage: " << peer.name << " [key=value]... stub -AMPL\n\nSolves stub.nl by " << peer.version
            << " and writes stub.sol.\nOptions, also from the environment variable " << peer.name << "_options:\n";
  for (const PeerOption& option : peer.options) {
    std::string values;
    for (const std::string& value : option.values) values += (values.empty() ? "" : " | ") + value;
    std::cout << "  " << option.key << '=' << option.initial << "  " << (values.empty() ? "a positive number" : values)
              << "\n      " << option.help << '\n';
  }
}

/// The driver itself could not do its work.
int refuse(const Peer& peer, const std::string& stub, int code, const std::string& why) {
  std::cerr << peer.name << ": " << why << '\n';
  try {
    if (!stub.empty()) ncp::ampl::write_failed_sol(stub, peer.name + ": " + why, code);
  } catch (const ncp::ampl::ModelError& error) {
    std::cerr << peer.name << ": " << error.what() << '\n';
  }
  return 2;
}

int solve_stub(const Peer& peer, const Call& call) {
  PeerOptions options(peer.options);
  if (const char* text = std::getenv((peer.name + "_options").c_str())) {
    std::istringstream words(text);
    for (std::string word; words >> word;) options.set(word);
  }
  for (const std::string& word : call.words) options.set(word);
  const auto model = ncp::ampl::read_model(call.stub);
  ncp::check_input(*model, model->start());
  const PeerAnswer answer = peer.solve(*model, model->start(), options);
  const std::string message = peer.version + ": " + answer.words;
  std::cout << message << '\n';
  const int code = static_cast<int>(answer.end);
  // A point that is not finite is no point, whatever the peer says of it; a claim without a point is told as such.
  if (answer.x.size() == model->size() && answer.x.allFinite())
    model->write_sol(message, answer.x.head(model->n_var()), code);
  else
    ncp::ampl::write_failed_sol(call.stub, message, code);
  return 0;
}

}  // namespace

PeerOptions::PeerOptions(std::vector<PeerOption> table) : table_(std::move(table)) {
  for (const PeerOption& option : table_) values_[option.key] = option.initial;
}

void PeerOptions::set(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string key(assignment.substr(0, equals));
  const std::string value(equals == std::string_view::npos ? "" : assignment.substr(equals + 1));
  const auto option = std::ranges::find(table_, key, &PeerOption::key);
  if (option == table_.end()) throw std::invalid_argument("there is no option '" + key + "'");
  if (option->values.empty() && value != option->initial) {
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    if (value.empty() || *end != '\0' || !(number > 0))
      throw std::invalid_argument(key + "=" + value + ": not a positive number");
  } else if (!option->values.empty() && std::ranges::find(option->values, value) == option->values.end()) {
    std::string all;
    for (const std::string& word : option->values) all += (all.empty() ? "" : ", ") + word;
    throw std::invalid_argument(key + "=" + value + ": not one of " + all);
  }
  values_[key] = value;
}

double PeerOptions::number(const std::string& key) const { return std::strtod(text(key).c_str(), nullptr); }

int run_peer(const Peer& peer, int argc, const char* const* argv) {
  Call call;
  try {
    call = parse(argc, argv);
    if (call.version) {
      std::cout << peer.name << " of " << peer.version << '\n';
      return 0;
    }
    if (call.help || call.stub.empty()) {
      print_help(peer);
      return call.help ? 0 : 2;
    }
    return solve_stub(peer, call);
  } catch (const ncp::ampl::ModelError& error) {
    return refuse(peer, call.stub, error.code(), error.what());
  } catch (const std::exception& error) {
    return refuse(peer, call.stub, static_cast<int>(End::Refused), error.what());
  }
}

double residual_at_projection(const ncp::Mcp& mcp, ncp::In x) {
  const ncp::Vec z = lcp::project(mcp.box(), x);
  ncp::Vec F(z.size());
  if (!z.allFinite() || !mcp.eval(z, F) || !F.allFinite()) return ncp::infinity;
  return z.size() == 0 ? 0 : (z - lcp::project(mcp.box(), z - F)).lpNorm<Eigen::Infinity>();
}

}  // namespace perp::bench
