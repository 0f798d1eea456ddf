// SPDX-License-Identifier: Apache-2.0
/// bench_contact_scenes STEPS AMPLITUDE SCENE:CONTACTS...: steps of scenes as small as a simulator's, solved cold and
/// warm by Perp's default, cold by each of its methods, by Bullet's Dantzig solver and by Siconos, where these are.
/// README.md says how to read it.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "contact/scenes/shaken_scene.hpp"
#include "contact/solvers/sequence.hpp"
#include "timing.hpp"
#ifdef PERP_BULLET
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btLemkeSolver.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>
#endif
#ifdef PERP_SICONOS
#include "siconos_friction.hpp"
#endif

namespace {

using namespace perp;
using contact::Index;
using contact::Vec;
using lcp::at;

constexpr double tol = 1e-8;
constexpr int repetitions = 5;    // the least time of each step counts
constexpr double patience = 0.3;  // [s], after which nothing is repeated
constexpr double limit = 0.1;     // [s] of one solve by a method alone
constexpr double most = 1;        // [s] of all steps, after which who solves them is left out

/// Counts this thread alone, not other jobs on the machine.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Steps {
  std::vector<contact::Problem> problems;
  std::vector<Vec> starts;  ///< r of the step before; empty in the first
};

/// The path is that of warm steps of the default.
Steps steps_of(const std::string& text, int count, double amplitude) {
  const auto colon = text.find(':');
  contact::ShakenScene scene(contact::make_scene(text.substr(0, colon), std::stol(text.substr(colon + 1)), 1),
                             {.amplitude = amplitude});
  contact::Sequence sequence({.variant = contact::variant_of("glocker")});
  Steps out;
  Vec r;
  for (int k = 0; k < count; ++k) {
    out.problems.push_back(scene.problem());
    out.starts.push_back(r);
    r = sequence.step(out.problems.back()).solution.r;
    scene.advance(r);
  }
  return out;
}

/// Counts all steps but the first, which is always cold.
struct Times {
  double mean = 0, median = 0, largest = 0;  ///< [ms]
  int solved = 0;
  double error = 0;  ///< median of Residual::largest()
};

/// solve(step) returns r; begin() comes before each repetition of all steps.
Times times_of(const Steps& steps, const std::function<void()>& begin, const std::function<Vec(std::size_t)>& solve) {
  const std::size_t count = steps.problems.size();
  std::vector<double> least(count, lcp::infinity);
  std::vector<Vec> r(count);
  const double first = processor_seconds();
  for (int k = 0; k < repetitions && processor_seconds() - first < patience; ++k) {
    begin();
    for (std::size_t i = 0; i < count; ++i) {
      const double start = processor_seconds();
      if (start - first > most) return {};
      r[i] = solve(i);
      least[i] = std::min(least[i], processor_seconds() - start);
    }
  }
  Times out;
  std::vector<double> errors;
  for (std::size_t i = 1; i < count; ++i) {
    const contact::Residual residual = contact::residual(steps.problems[i], r[i]);
    out.solved += contact::accepted(residual, tol) ? 1 : 0;
    errors.push_back(residual.largest());
    out.mean += 1e3 * least[i] / static_cast<double>(count - 1);
    out.largest = std::max(out.largest, 1e3 * least[i]);
  }
  out.error = bench::median(errors);
  out.median = 1e3 * bench::median({least.begin() + 1, least.end()});
  return out;
}

#ifdef PERP_BULLET
/// Its law: both tangents by themselves within [-mu r_N, mu r_N]. Filling its arrays counts.
class Bullet {
 public:
  explicit Bullet(std::unique_ptr<btMLCPSolverInterface> solver) : solver_(std::move(solver)) {}
  Vec solve(const contact::Problem& problem) {
    const contact::SpMat& W = problem.W.matrix();
    const int n = static_cast<int>(W.rows());
    const int d = problem.dimension;
    A_.resize(n, n);
    A_.setZero();
    for (int j = 0; j < n; ++j)
      for (contact::SpMat::InnerIterator it(W, j); it; ++it)
        A_.setElem(static_cast<int>(it.row()), j, static_cast<btScalar>(it.value()));
    for (auto* v : {&x_, &b_, &lo_, &hi_}) {
      v->resize(n);
      v->setZero();
    }
    findex_.resize(n);
    for (int i = 0; i < n; ++i) {
      const bool normal = i % d == 0;
      b_[i] = static_cast<btScalar>(-problem.q[i]);
      hi_[i] = normal ? BT_INFINITY : static_cast<btScalar>(problem.mu[i / d]);
      lo_[i] = normal ? 0 : -hi_[i];
      findex_[i] = normal ? -1 : d * (i / d);
    }
    constexpr int iterations = 10;  // Bullet's default
    solver_->solveMLCP(A_, b_, x_, lo_, hi_, findex_, iterations);
    Vec r(n);
    for (int i = 0; i < n; ++i) r[i] = std::isfinite(x_[i]) ? static_cast<double>(x_[i]) : 0;
    return r;
  }

 private:
  std::unique_ptr<btMLCPSolverInterface> solver_;
  btMatrixXu A_;
  btVectorXu x_, b_, lo_, hi_;
  btAlignedObjectArray<int> findex_;
};
#endif

void print(const std::string& who, const Times& times, int steps) {
  if (times.mean == 0) {
    std::printf("| %s | too slow | | | | |\n", who.c_str());
    return;
  }
  std::printf("| %s | %d of %d | %.3f | %.3f | %.3f | %.1e |\n", who.c_str(), times.solved, steps - 1, times.median,
              times.mean, times.largest, times.error);
  std::fflush(stdout);
}

void measure(const std::string& name, int count, double amplitude) {
  const Steps steps = steps_of(name, count, amplitude);
  std::printf(
      "\n%s, %ld contacts\n\n| | solved | median ms | mean ms | largest ms | median error "
      "|\n|---|---|---|---|---|---|\n",
      name.c_str(), static_cast<long>(steps.problems.front().contacts()));
  const auto nothing = [] {};
  contact::Sequence sequence;
  print("default, warm",
        times_of(
            steps, [&] { sequence = contact::Sequence({.variant = contact::variant_of("glocker")}); },
            [&](std::size_t i) { return sequence.step(steps.problems[i]).solution.r; }),
        count);
  double of_default = 0;
  double of_best = lcp::infinity;
  std::string best;
  for (const contact::MethodEntry& entry : contact::methods()) {
    const bool automatic = entry.name == "auto";
    contact::Options options{.method = entry.method};
    if (!automatic) options.max_time = std::chrono::duration<double>(limit);
    const Times times =
        times_of(steps, nothing, [&](std::size_t i) { return contact::solve(steps.problems[i], options).solution.r; });
    if (times.solved == 0) continue;  // most methods, where contacts are redundant
    print(std::string(automatic ? "default" : entry.name) + ", cold", times, count);
    if (automatic)
      of_default = times.mean;
    else if (times.solved == count - 1 && times.mean < of_best) {
      of_best = times.mean;
      best = entry.name;
    }
  }
#ifdef PERP_BULLET
  const auto bullet = [&](const char* who, std::unique_ptr<btMLCPSolverInterface> solver) {
    Bullet one(std::move(solver));
    print(who, times_of(steps, nothing, [&](std::size_t i) { return one.solve(steps.problems[i]); }), count);
  };
  bullet("Bullet, Dantzig", std::make_unique<btDantzigSolver>());
  bullet("Bullet, Lemke", std::make_unique<btLemkeSolver>());
  bullet("Bullet, Gauss-Seidel, 10 sweeps", std::make_unique<btSolveProjectedGaussSeidel>());
#endif
#ifdef PERP_SICONOS
  for (const bench::SiconosSolver& solver : bench::siconos_solvers) {
    const std::string_view id = solver.name;
    if (id != "NSGS" && id != "NSN_AC_HYBRID") continue;  // the best ones (results/contact.md)
    bench::SiconosSolver limited = solver;
    limited.iterations = std::min(limited.iterations, 2000);
    for (const bool warm : {false, true}) {
      std::vector<std::unique_ptr<bench::SiconosProblem>> problems;
      const auto convert = [&] {
        problems.clear();
        for (const contact::Problem& problem : steps.problems)
          problems.push_back(std::make_unique<bench::SiconosProblem>(problem));
      };
      const Times times = times_of(steps, convert, [&](std::size_t i) {
        Vec r = warm && i > 0 ? steps.starts[i] : Vec(Vec::Zero(steps.problems[i].q.size()));
        problems[i]->solve(limited, tol / 10, r);  // its own error is not so strict
        return r;
      });
      print(std::string("Siconos ") + solver.name + (warm ? ", warm" : ", cold"), times, count);
    }
  }
#endif
  if (!best.empty())
    std::printf("\nthe default takes %.2f times the best single method that solves all, %s\n", of_default / of_best,
                best.c_str());
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::fputs("usage: bench_contact_scenes STEPS AMPLITUDE SCENE:CONTACTS...\n", stderr);
    return 2;
  }
  for (int k = 3; k < argc; ++k) measure(argv[k], std::atoi(argv[1]), std::atof(argv[2]));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_contact_scenes: %s\n", error.what());
  return 1;
}
