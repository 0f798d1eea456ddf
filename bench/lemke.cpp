/// Lemke's method on random sparse LCPs of the classes it is guaranteed for: solved, pivots, time a pivot. With a
/// second argument, the folder to write the first problem of each class to as a .dat file, for other codes.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "lcp/solve/solve.hpp"
#include "ncp/collection/random/random_lcps.hpp"

namespace {

using namespace perp;
using Clock = std::chrono::steady_clock;

void write_dat(const lcp::AffineMcp& p, const std::string& path) {  // dense, by columns
  std::ofstream out(path);
  out.precision(17);
  const Eigen::MatrixXd M(p.M);
  out << p.size() << "\n0\n" << p.size() << '\n' << p.size() << '\n' << p.size() << '\t' << p.size() << '\n';
  for (lcp::Index j = 0; j < p.size(); ++j) out << M.col(j).transpose() << '\n';
  out << p.q.transpose() << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  namespace c = ncp::collection;
  const lcp::Index n = argc > 1 ? std::atoi(argv[1]) : 2000;
  const unsigned count = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 200;
  struct Class {
    const char* name;
    c::RandomLcp (*make)(lcp::Index, unsigned);
  };
  bool all = true;
  for (const Class& k : {Class{"positive definite", c::random_positive_definite},
                         {"semidefinite, rank-deficient", c::random_semidefinite},
                         {"P, not positive definite", c::random_p_matrix},
                         {"strictly copositive", c::random_strictly_copositive},
                         {"copositive-plus", c::random_copositive_plus},
                         {"degenerate", c::random_degenerate},
                         {"Z", c::random_z_matrix}}) {
    unsigned solved = 0;
    long pivots = 0;
    double seconds = 0;
    double worst = 0;
    for (unsigned seed = 1; seed <= count; ++seed) {
      const lcp::AffineMcp p = k.make(n, seed).problem;
      if (seed == 1 && argc > 3) write_dat(p, std::string(argv[3]) + "/" + k.name + ".dat");
      const auto begin = Clock::now();
      const lcp::Result result = lcp::solve(p, lcp::Vec::Zero(n), lcp::Lemke{});
      seconds += std::chrono::duration<double>(Clock::now() - begin).count();
      pivots += result.iterations;
      solved += result.solved();
      worst = std::max(worst, result.residual / (1 + p.q.lpNorm<Eigen::Infinity>()));
      if (!result.solved()) std::printf("  %s, seed %u: %s\n", k.name, seed, result.message.c_str());
    }
    std::printf(
        "%-30s n = %ld: %u of %u solved, worst relative residual %.1e, %.0f pivots and %.4f s each, %.1f us a pivot\n",
        k.name, static_cast<long>(n), solved, count, worst, static_cast<double>(pivots) / count, seconds / count,
        1e6 * seconds / static_cast<double>(pivots));
    all = all && solved == count;
  }
  return all ? EXIT_SUCCESS : EXIT_FAILURE;
}
