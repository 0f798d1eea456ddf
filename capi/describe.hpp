// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The fields of results, described once: a field that an answer of the library gets is one line here, one in perp.h
/// and one in python/perp/_result.py.
#include "capi/callback_mcp.hpp"
#include "capi/record.hpp"
#include "contact/existence/existence.hpp"
#include "contact/solvers/run.hpp"
#include "contact/solvers/sensitivity.hpp"
#include "lcp/classes/classify.hpp"
#include "ncp/analysis/sensitivity.hpp"
#include "ncp/analysis/verify.hpp"
#include "ncp/run/observe.hpp"
#include "ncp/run/result.hpp"
#include "ncp/strategy/deflation.hpp"

namespace perp::capi {

/// The record as C sees it, of a problem of n variables; x is null, texts are the record's.
perp_iteration iteration_of(const ncp::Iteration& it, std::int64_t n);

// `callbacks` of the problem, or null: their calls are counted.
Part part_of(const ncp::Stats& stats, const CallbackMcp* callbacks);
Part part_of(ncp::Result result, const CallbackMcp* callbacks);
Part part_of(ncp::Verified found);
Part part_of(ncp::AllSolutions all, const CallbackMcp* callbacks);
Part part_of(const ncp::Sensitivity& found);
Part part_of(const ncp::Mcp& mcp, const ncp::JacobianCheck& check);
Part part_of(const contact::Residual& residual);
Part part_of(const contact::Verdict& verdict);
Part part_of(contact::Run run);
Part part_of(const contact::Sensitivity& found);

}  // namespace perp::capi
