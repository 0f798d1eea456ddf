// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/shared_options.hpp"

namespace perp::lcp {

void describe_lu(LuBackend& lu, Fields& f) {
  f.choice("lu", &lu,
           {{to_string(LuBackend::General), LuBackend::General},
            {"klu", LuBackend::Klu},
            {"eigen", LuBackend::Eigen},
            {"dense", LuBackend::Dense},
            {"auto", LuBackend::Auto}},
           "the sparse LU factorization used");
}

void describe_memory(int& memory, Fields& f) {
  f.add("nms_memory_size", &memory, between(1, 1e6),
        "non-monotone search: merits remembered, the largest of which must be beaten; 1 is monotone", "memory");
}

void describe_iterations(Index& limit, Fields& f) {
  f.add("affine_iteration_limit", &limit, at_least(0), "pivots, rounds or steps after which to give up");
}

}  // namespace perp::lcp
