// SPDX-License-Identifier: Apache-2.0
// Links what the example does not: the reader of .nl files (AMPL's library), the collection, an LCP by Lemke's method
// (UMFPACK), contact problems (HDF5). Prints the solution of the model named on the command line.
#include <iostream>

#include "collection/collection.hpp"
#include "contact/fclib.hpp"
#include "contact/residual.hpp"
#include "lcp/file_error.hpp"
#include "lcp/lemke.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/solve.hpp"

int main(int, char** argv) {
  using namespace perp;
  lcp::SpMat M(2, 2);
  M.insert(0, 0) = M.insert(1, 1) = 2;
  M.insert(0, 1) = M.insert(1, 0) = 1;
  M.makeCompressed();
  // LCP(q, M) of Cottle, Pang & Stone's kind: z = (4/3, 7/3).
  const lcp::PivotResult pivots = lcp::lemke(lcp::standard_lcp(M, lcp::Vec{{-5, -6}}), lcp::Vec::Zero(2));
  if (!pivots.solved() || !pivots.z.isApprox(lcp::Vec{{4. / 3, 7. / 3}}, 1e-12)) return 1;

  // A mass of 1 kg thrown at 1 m/s against a wall, sliding at 3 m/s, mu = 1/2: r = (1, -1/2), u = (0, 2.5).
  contact::Problem wall;
  wall.dimension = 2;
  wall.W = lcp::SpMat(2, 2);
  wall.W.given().setIdentity();
  wall.q = lcp::Vec{{-1, 3}};
  wall.mu = lcp::Vec{{0.5}};
  if (contact::residual(wall, lcp::Vec{{1, -0.5}}).siconos > 1e-15) return 1;
  try {
    contact::parse_fclib("no HDF5", "none.hdf5");
    return 1;
  } catch (const lcp::FileError&) {
  }

  const auto model = ncp::ampl::read_model(argv[1]);
  const ncp::Result result = ncp::solve(*model, model->start(), ncp::SemismoothNewton{});
  std::cout << result << '\n';
  for (ncp::Index i = 0; i < model->n_var(); ++i) std::cout << model->variable_name(i) << ' ' << result.x[i] << '\n';

  return result.solved() && ncp::collection::find("kojshin") ? 0 : 1;
}
