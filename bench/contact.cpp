/// bench_contact FILES...: contact::solve on recorded problems, beside Siconos where it is, each run in a process of
/// its own. README.md says how to read it.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "contact/io/read.hpp"
#include "contact/solvers/solve.hpp"
#include "contact_peers.hpp"
#include "ncp/strategy/presets.hpp"

namespace {

using namespace perp;
using contact::Index;
using contact::Problem;
using contact::SpMat;
using contact::Vec;

/// What a run in a process of its own sends back, before r.
struct Outcome {
  double seconds = 0;
  int iterations = 0;
  int sweeps = 0;
  int extra = 0;  // Newton steps
  int proximal = 0;
  int attempts = 0;
  char end = 'T';  // T out of time, C crashed, E returned
  contact::Origin by = contact::Origin::Zero;
};

struct Run {
  Outcome outcome;
  contact::Residual residual;
  bool solved = false;
};

void write_all(int fd, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = write(fd, bytes, size);
    if (sent <= 0) _exit(9);
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

/// `work` fills outcome and r, in a child that is killed at the limit.
Run in_process(const Problem& problem, double limit, double tol, bool both,
               const std::function<void(Outcome&, Vec&)>& work) {
  Run run;
  int ends[2];
  if (pipe(ends) != 0) return run;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, 1);
    dup2(nowhere, 2);
    Outcome outcome{.end = 'E'};
    Vec r = Vec::Zero(problem.q.size());
    work(outcome, r);
    write_all(ends[1], &outcome, sizeof outcome);
    write_all(ends[1], r.data(), sizeof(double) * static_cast<std::size_t>(r.size()));
    _exit(0);
  }
  close(ends[1]);
  Vec r = Vec::Zero(problem.q.size());
  std::vector<char> got;
  const std::size_t all = sizeof(Outcome) + sizeof(double) * static_cast<std::size_t>(r.size());
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit + 0.5);
  char buffer[1 << 16];
  char end = 'C';
  while (got.size() < all) {
    const double left = std::chrono::duration<double>(deadline - std::chrono::steady_clock::now()).count();
    pollfd ready{.fd = ends[0], .events = POLLIN, .revents = 0};
    if (left <= 0 || poll(&ready, 1, static_cast<int>(1000 * left) + 1) == 0) {
      end = 'T';
      kill(child, SIGKILL);
      break;
    }
    const ssize_t n = read(ends[0], buffer, sizeof buffer);
    if (n <= 0) break;
    got.insert(got.end(), buffer, buffer + n);
  }
  close(ends[0]);
  waitpid(child, nullptr, 0);
  run.outcome.end = end;
  run.outcome.seconds = limit;
  if (got.size() == all) {
    std::copy_n(got.data(), sizeof(Outcome), reinterpret_cast<char*>(&run.outcome));
    std::copy_n(got.data() + sizeof(Outcome), all - sizeof(Outcome), reinterpret_cast<char*>(r.data()));
  }
  if (!r.allFinite()) r.setZero();
  run.residual = contact::residual(problem, r);
  run.solved = both ? contact::accepted(run.residual, tol) : run.residual.siconos <= tol * (1 + 1e-6);
  return run;
}

struct Case {
  std::string name;
  Problem problem;
};

std::string base_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// Tangent frames turned by random angles: W, q in other coordinates of the same problem.
Problem turned(const Problem& problem, std::mt19937& random) {
  Problem out = problem;
  std::vector<Eigen::Triplet<double>> entries;
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const auto i = static_cast<int>(3 * a);
    const double t = angle(random);
    entries.emplace_back(i, i, 1);
    entries.emplace_back(i + 1, i + 1, std::cos(t));
    entries.emplace_back(i + 1, i + 2, -std::sin(t));
    entries.emplace_back(i + 2, i + 1, std::sin(t));
    entries.emplace_back(i + 2, i + 2, std::cos(t));
  }
  SpMat Q(problem.q.size(), problem.q.size());
  Q.setFromTriplets(entries.begin(), entries.end());
  out.W = Q * problem.W * SpMat(Q.transpose());
  out.W.makeCompressed();
  out.q = Q * problem.q;
  return out;
}

/// q + 30 % of its size in a random direction of the range of W, so that existence is not lost.
Problem pushed(const Problem& problem, std::mt19937& random) {
  Problem out = problem;
  std::normal_distribution<double> normal;
  Vec y(problem.q.size());
  for (Index i = 0; i < y.size(); ++i) y[i] = normal(random);
  const Vec d = problem.W * y;
  out.q += 0.3 * problem.q.norm() / d.norm() * d;
  return out;
}

Problem with_friction(const Problem& problem, double mu) {
  Problem out = problem;
  out.mu.setConstant(mu);
  return out;
}

std::vector<Case> perturbed(const Case& original, unsigned seed, int rounds) {
  std::vector<Case> cases;
  std::mt19937 random(seed);
  for (int k = 1; k <= rounds; ++k) {
    cases.push_back({original.name + " turned " + std::to_string(k), turned(original.problem, random)});
    cases.push_back({original.name + " q+30% " + std::to_string(k), pushed(original.problem, random)});
  }
  cases.push_back({original.name + " mu=0.2", with_friction(original.problem, 0.2)});
  cases.push_back({original.name + " mu=0.9", with_friction(original.problem, 0.9)});
  return cases;
}

struct Total {
  int solved = 0;
  double seconds = 0;  // unsolved runs count as the limit
};

void print(const std::string& solver, bool own, const Run& run, double limit, Total& total) {
  std::string how = run.solved ? "" : "  not solved";
  if (run.solved && own) how = "  by " + std::string(contact::to_string(run.outcome.by));
  if (run.outcome.end == 'T') how = "  out of time";
  if (run.outcome.end == 'C') how = "  crashed";
  std::printf("    %-14s %9.4f s  iterations %6d", solver.c_str(), run.outcome.seconds, run.outcome.iterations);
  if (run.outcome.sweeps > 0) std::printf(" + %d sweeps", run.outcome.sweeps);
  if (run.outcome.extra > 0 || run.outcome.proximal > 0)
    std::printf(" + %d Newton, %d proximal", run.outcome.extra, run.outcome.proximal);
  std::printf("  siconos %.1e  rr9118 %.1e%s\n", run.residual.siconos, run.residual.rr9118, how.c_str());
  total.solved += run.solved ? 1 : 0;
  total.seconds += run.solved ? run.outcome.seconds : limit;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"contact::solve on recorded problems, beside Siconos"};
  std::vector<std::string> files;
  bool perturb = false;
  bool peers = false;
  double tol = 1e-8;
  double limit = 30;
  int repeat = 1;
  int rounds = 1;
  Index least = 0;
  Index most = 1'000'000;
  unsigned seed = 1;
  std::string method;
  std::string encoding = "B";
  std::string row = "normalised";
  int stages = 4;
  bool homotopy = false;
  bool no_polish = false;
  bool no_sweeps = false;
  bool no_proximal = false;
  app.add_option("files", files, "problems, .dat or FCLIB")->required();
  app.add_flag("--perturbed", perturb, "the perturbed variants, too");
  app.add_flag("--siconos", peers, "Siconos' solvers, too");
  app.add_option("--tol", tol, "on both metrics; Siconos' solvers are asked for their own alone");
  app.add_option("--limit", limit, "seconds a run");
  app.add_option("--repeat", repeat, "runs of which the fastest counts");
  app.add_option("--rounds", rounds, "random variants of each kind");
  app.add_option("--seed", seed, "of the random variants");
  app.add_option("--least", least, "contacts at least");
  app.add_option("--most", most, "contacts at most");
  app.add_option("--method", method, "a preset of ncp/ on Glocker's NCP instead of contact::Auto");
  app.add_flag("--homotopy", homotopy, "the homotopy alone");
  app.add_option("--encoding", encoding, "A or B");
  app.add_option("--row", row, "normalised or original");
  app.add_option("--stages", stages, "of the continuation in delta");
  app.add_flag("--no-polish", no_polish, "no Newton steps on another equation");
  app.add_flag("--no-sweeps", no_sweeps, "no sweeps of Gauss-Seidel before the homotopy");
  app.add_flag("--no-proximal", no_proximal, "no proximal loop");
  CLI11_PARSE(app, argc, argv);

  contact::Options options{.tol = tol, .max_time = std::chrono::duration<double>(limit)};
  if (homotopy) {
    options.method = contact::GlockerHomotopy{};
  } else if (method.empty()) {
    options.method =
        contact::Auto{.sweeps = no_sweeps ? 0 : contact::Auto{}.sweeps, .polish = !no_polish, .proximal = !no_proximal};
  } else {
    const ncp::Preset* preset = ncp::find_preset(method);
    if (preset == nullptr) {
      std::cerr << "no method is called " << method << '\n';
      return 2;
    }
    contact::GlockerNcp ncp{.method = preset->method, .stages = stages};
    ncp.formulation.encoding = encoding == "A" ? contact::Encoding::A : contact::Encoding::B;
    ncp.formulation.row = row == "original" ? contact::DiskRow::Original : contact::DiskRow::Normalised;
    options.method = ncp;
  }
  const std::vector<std::string> solvers = peers ? bench::contact_peers() : std::vector<std::string>{};
  if (peers && solvers.empty()) std::cerr << "built without Siconos\n";

  std::map<std::string, Total> totals;
  int cases_run = 0;
  for (const std::string& file : files) {
    Case original{.name = base_name(file), .problem = contact::read_problem(file)};
    if (original.problem.contacts() < least || original.problem.contacts() > most) continue;
    std::vector<Case> cases{original};
    if (perturb)
      for (Case& variant : perturbed(original, seed, rounds)) cases.push_back(std::move(variant));
    for (const Case& one : cases) {
      ++cases_run;
      std::printf("%s: %ld contacts\n", one.name.c_str(), static_cast<long>(one.problem.contacts()));
      Run best;
      for (int k = 0; k < repeat; ++k) {
        const Run run = in_process(one.problem, limit, tol, true, [&](Outcome& outcome, Vec& r) {
          const contact::Result result = contact::solve(one.problem, options);
          outcome.seconds = result.stats.time.count();
          outcome.iterations = result.stats.iterations;
          outcome.sweeps = result.stats.sweeps;
          outcome.extra = result.stats.newton_steps;
          outcome.proximal = result.stats.proximal_steps;
          outcome.attempts = result.stats.attempts;
          outcome.by = result.by;
          r = result.solution.r;
        });
        if (k == 0 || run.outcome.seconds < best.outcome.seconds) best = run;
        if (run.outcome.seconds > 1) break;
      }
      print("perp", true, best, limit, totals["perp"]);
      for (const std::string& solver : solvers) {
        Run peer;
        for (int k = 0; k < repeat; ++k) {
          const Run run = in_process(one.problem, limit, tol, false, [&](Outcome& outcome, Vec& r) {
            bench::PeerRun peer_run = bench::run_contact_peer(solver, one.problem, tol);
            outcome.seconds = peer_run.seconds;
            outcome.iterations = peer_run.iterations;
            r = peer_run.r;
          });
          if (k == 0 || run.outcome.seconds < peer.outcome.seconds) peer = run;
          if (!run.solved || run.outcome.seconds > 1) break;
        }
        print(solver, false, peer, limit, totals[solver]);
      }
      std::fflush(stdout);
    }
  }
  std::printf("\n%d problems; unsolved ones count as %g s\n", cases_run, limit);
  for (const auto& [name, total] : totals)
    std::printf("    %-14s solved %4d  %10.3f s\n", name.c_str(), total.solved, total.seconds);
  return 0;
}
