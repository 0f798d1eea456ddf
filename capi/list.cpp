// SPDX-License-Identifier: Apache-2.0
/// perp_list().
#include <string>

#include "capi/guard.hpp"
#include "capi/record.hpp"
#include "collection/sized.hpp"
#include "contact/scenes/generators.hpp"
#include "ncp/settings/method_table.hpp"
#include "ncp/settings/settings.hpp"

namespace perp::capi {

namespace {

std::vector<Part> items_of(const std::string& what) {
  std::vector<Part> items;
  const auto item = [&]() -> perp_result& { return *items.emplace_back(std::make_unique<perp_result>()); };
  if (what == "methods") {
    for (const settings::MethodEntry& one : settings::methods())
      item().add("name", one.name).add("what", one.what).add("reference", one.reference);
  } else if (what == "options") {
    for (const settings::Option& one : settings::options())
      item().add("key", one.key).add("takes", one.takes).add("help", one.help);
  } else if (what == "collection") {
    for (const ncp::collection::Entry& one : ncp::collection::entries()) {
      const ncp::collection::Family* family = ncp::collection::find_family(one.name);
      item()
          .add("name", one.name)
          .add("problem_class", one.problem_class)
          .add("size", one.size)
          .add("source", one.source)
          .add("hard", one.hard)
          .add("sizes", family == nullptr ? std::string() : ncp::collection::syntax(*family));
    }
  } else if (what == "scenes") {
    for (const contact::GeneratorEntry& one : contact::generators()) item().add("name", one.name).add("what", one.what);
  } else {
    refuse("what", "'" + what + "' is neither \"methods\", \"options\", \"collection\" nor \"scenes\"");
  }
  return items;
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_list(int32_t interface_, const char* what, perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require_interface(interface_);
    require(what, "what");
    Part part = std::make_unique<perp_result>();
    part->add("items", items_of(what));
    return part;
  });
}
