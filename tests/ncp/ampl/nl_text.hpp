// SPDX-License-Identifier: Apache-2.0
#pragma once
/// .nl texts for the tests, their binary twins, and a folder to put them into.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "ncp/ampl/model.hpp"

namespace perp::ncp::ampl {

/// A folder that goes away with the object.
class TempFolder {
 public:
  TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  ~TempFolder();
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The sizes in the header of a text model; the rest is zero.
struct Header {
  int vars = 1, cons = 1, objs = 0;
  int eqns = 0;
  int cc = 0;
  int nonzeros = 1, gradient = 0;
  int functions = 0;
  int both = 0, con = 0, obj = 0, con1 = 0, obj1 = 0;  ///< defined variables
  int logical = 0;
  int integers = 0;            ///< linear ones
  std::string nonlinear = "";  ///< line 5 instead of "all, 0, 0"
  std::string discrete = "";   ///< line 7 instead of "0 integers 0 0 0"
};
std::string text(const Header& header);

/// The same model in the binary format. Pre: a well-formed text without functions and strings.
std::string binary_twin(const std::string& text);

std::string read_bytes(const std::string& path);
/// Reads a model of the given content.
std::unique_ptr<Model> read_text(const std::string& content);
/// Expects a refusal whose message has all the parts.
void expect_refused(const std::string& content, int code, const std::vector<std::string>& parts);

/// The samples, or an empty list where they are absent.
std::vector<std::string> samples();

/// Models that between them have every kind of segment and expression.
const std::vector<std::string>& rich_models();

Vec values(const Model& model, const Vec& x);
Eigen::MatrixXd jacobian(const Model& model, const Vec& x);

}  // namespace perp::ncp::ampl
