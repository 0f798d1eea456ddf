// SPDX-License-Identifier: Apache-2.0
/// campaign.json of `perp compare` and `perp contact --compare`: what is read writes a text that reads back the same,
/// and the report's tables can be made of it.
#include "app/campaign/campaign.hpp"

#include "app/contact/compare/campaign.hpp"
#include "app/findings/campaign_data.hpp"
#include "app/program/program.hpp"
#include "fuzz/support.hpp"

namespace {

using namespace perp;
using fuzz::require;
namespace compare = app::compare;
namespace contacts = app::contacts;

void use(const compare::Campaign& campaign) {
  const std::string text = compare::campaign_json(campaign);
  const compare::Campaign again = compare::parse_campaign(text);
  require(compare::campaign_json(again) == text, "a campaign reads back as it was");
  compare::differences(campaign, again);
  const app::comparison::CampaignData tables(campaign, {});
  require(tables.pairs().size() * campaign.methods.size() == campaign.cells(), "a cell a method, problem and start");
}

void use(const contacts::Campaign& campaign) {
  const std::string text = compare::campaign_json(campaign);
  const contacts::Campaign again = compare::campaign_of<contacts::Campaign>(text);
  require(compare::campaign_json(again) == text, "a contact campaign reads back as it was");
  contacts::differences(campaign, again);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::view(data, size));
  fuzz::accepted<app::InputError>([&] { use(compare::parse_campaign(text)); });
  fuzz::accepted<app::InputError>([&] { use(compare::campaign_of<contacts::Campaign>(text)); });
  return 0;
}
