// SPDX-License-Identifier: Apache-2.0
#pragma once
/// DIR/campaign.json of `perp compare` and of `perp contact --compare`: a campaign's fields() after the number of their
/// format, whose key is AnyCampaign::format.
#include <cmath>
#include <string>

#include "app/program/files.hpp"
#include "app/text/json_fields.hpp"

namespace perp::app::compare {

inline constexpr int campaign_format = 1;

template <class AnyCampaign>
std::string campaign_json(const AnyCampaign& campaign) {
  JsonWriter writer(json_header());
  writer(AnyCampaign::format, campaign_format);
  AnyCampaign::fields(writer, campaign);
  return json_text(writer.json);
}

/// Throws InputError saying what is missing or of another type.
template <class AnyCampaign>
AnyCampaign campaign_of(const std::string& text) {
  const Json json = json_object(text);
  if (!json.contains(AnyCampaign::format)) throw input_error("no campaign of {}", AnyCampaign::command);
  if (const int format = json_integer<int>(json[AnyCampaign::format], AnyCampaign::format); format != campaign_format)
    throw input_error("written in format {}, of another version", format);
  AnyCampaign campaign = row_of<AnyCampaign>(json);
  if (!std::isfinite(campaign.tol) || !std::isfinite(campaign.time_limit))
    throw InputError("'tol' or 'time_limit' is no number");
  return campaign;
}

/// Is there one in the folder?
bool holds_campaign(const std::string& dir);
/// What `parse` makes of DIR/campaign.json. Throws InputError naming the file.
template <class Parse>
auto campaign_in(const std::string& dir, Parse parse) {
  try {
    return parse(read_text(dir + "/campaign.json"));
  } catch (const InputError& error) {
    throw input_error("{}/campaign.json: {}", dir, error.what());
  }
}

// What keeps cells of two campaigns apart: lines such as "--tol: 1e-08 there, 1e-06 here".

/// Names that only one of them has.
void compare_names(const char* what, const std::vector<std::string>& before, const std::vector<std::string>& now,
                   std::vector<std::string>& found);

template <class T>
void compare_value(const std::string& what, const T& before, const T& now, std::vector<std::string>& found) {
  if (before != now) found.push_back(fmt::format("{}: {} there, {} here", what, before, now));
}

}  // namespace perp::app::compare
