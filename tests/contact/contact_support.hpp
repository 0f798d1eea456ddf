// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The recorded contact problems and their reference solutions, where they are at hand.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "contact/io/read.hpp"
#include "contact/model/residual.hpp"
#include "support/matrices.hpp"

namespace perp::contact {

inline const std::filesystem::path recorded_folder =
    std::filesystem::path(PERP_SOURCE_DIR) / ".." / "shared" / "data" / "contact";

#define SKIP_WITHOUT_RECORDED_PROBLEMS() \
  if (!std::filesystem::exists(recorded_folder)) GTEST_SKIP() << "there is no " << recorded_folder.string()

inline Problem recorded(const std::string& file) { return read_problem((recorded_folder / file).string()); }

/// One line of ref/INDEX.csv: what the solver that made the reference said of it.
struct Reference {
  std::string file{};
  Index contacts = 0;
  double siconos = 0;  ///< tol_reached_rel
  double natural = 0;  ///< abs_natmap
  Index open = 0, stick = 0, slip = 0;

  /// "r_i u_i" a line.
  Solution solution() const {
    std::ifstream in(recorded_folder / "ref" / (file + ".ru.txt"));
    std::vector<double> r;
    std::vector<double> u;
    double ri = 0;
    double ui = 0;
    while (in >> ri >> ui) {
      r.push_back(ri);
      u.push_back(ui);
    }
    return {Eigen::Map<const Vec>(r.data(), static_cast<Index>(r.size())),
            Eigen::Map<const Vec>(u.data(), static_cast<Index>(u.size()))};
  }
};

inline std::vector<Reference> references() {
  std::vector<Reference> out;
  std::ifstream in(recorded_folder / "ref" / "INDEX.csv");
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::vector<std::string> field;
    for (std::string text; std::getline(fields, text, ',');) field.push_back(text);
    if (field.size() < 8) continue;
    Reference ref;
    ref.file = field[0];
    ref.contacts = std::stol(field[1]);
    ref.siconos = std::stod(field[3]);
    ref.natural = std::stod(field[4]);
    ref.open = std::stol(field[5]);
    ref.stick = std::stol(field[6]);
    ref.slip = std::stol(field[7]);
    out.push_back(ref);
  }
  return out;
}

}  // namespace perp::contact
