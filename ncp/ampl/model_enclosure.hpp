// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ranges of a model's F and J over boxes, from the expressions of its .nl file.
#include <memory>

#include "ncp/ampl/nl_check.hpp"
#include "ncp/ampl/pairing.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/interval/expression.hpp"

namespace perp::ncp::ampl {

/// F of the model's unknowns, written down.
Expressions model_expressions(const NlModel& model, const Pairing& pairing);

/// All three outlive the enclosure.
std::unique_ptr<Enclosure> model_enclosure(const NlModel& model, const Pairing& pairing, const JacobianMap& map);

}  // namespace perp::ncp::ampl
