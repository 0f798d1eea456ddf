// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What `perp contact --compare` was asked to do, DIR/campaign.json: written before the first cell, never changed.
#include <string>
#include <vector>

#include "app/campaign/campaign_file.hpp"
#include "app/contact/run/variant.hpp"

namespace perp::app::contacts {

struct CampaignProblem {
  std::string name{};  ///< as it was given
  std::string file{};  ///< with its whole path; empty of a made one
  std::string crc{};   ///< CRC-32 of the file's content, 8 hex digits
  /// As a command line has it.
  const std::string& argument() const { return file.empty() ? name : file; }

  static void fields(auto& f, auto& problem) {
    f("name", problem.name);
    f.optional("file", problem.file);
    f.optional("crc", problem.crc);
  }
};
/// Of a file that there is, or NAME:SIZE[:SEED].
CampaignProblem campaign_problem(const std::string& argument);

struct Campaign {
  std::vector<std::string> variants{};  ///< labels
  std::vector<CampaignProblem> problems{};
  double tol = 1e-8;
  double time_limit = 30;      ///< s, wall clock, of a run
  long long memory_mb = 4096;  ///< resident, of a run
  std::string version{};       ///< of perp

  std::size_t cells() const { return variants.size() * problems.size(); }

  static constexpr const char* format = "contact_campaign";
  static constexpr const char* command = "perp contact --compare";
  static void fields(auto& f, auto& campaign) {
    f("version", campaign.version);
    f("tol", campaign.tol);
    f("time_limit", campaign.time_limit);
    f("memory_limit_mb", campaign.memory_mb);
    f("variants", campaign.variants);
    f("problems", campaign.problems);
  }
};

/// What cells of `now` would not fit beside those of `before`, one line a difference: "--tol: 1e-08 there, 1e-06 here".
std::vector<std::string> differences(const Campaign& before, const Campaign& now);

}  // namespace perp::app::contacts
