// SPDX-License-Identifier: Apache-2.0
// What reads and writes files, where a request for memory fails. Catches what was read in part and passed for whole,
// a target that is neither the old file nor the new one, and drafts left behind.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "contact/io/fclib.hpp"
#include "contact/io/read.hpp"
#include "contact/scenes/generators.hpp"
#include "faults/harness.hpp"
#include "lcp/io/matrix_market.hpp"
#include "lcp/io/output_file.hpp"
#include "lcp/io/siconos_file.hpp"
#include "ncp/ampl/model.hpp"
#include "support/matrices.hpp"

namespace perp::faults {
namespace {

namespace fs = std::filesystem;

class FileFaults : public testing::Test {
 protected:
  FileFaults() : folder_(fs::temp_directory_path() / ("perp-faults-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~FileFaults() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string made(const std::string& name, const std::string& content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

  fs::path folder_;
};

/// An error that names want of memory is one that a user can act on.
bool tells_of_memory(const std::string& what) {
  return what.find("memory") != std::string::npos || what.find("Cannot allocate") != std::string::npos;
}

/// `read` returns what it has read as a text.
template <class Read>
Scenario reading(Read read) {
  return [=, usual = std::string()](long k) mutable {
    Outcome outcome;
    try {
      decltype(read()) content;
      outcome.out_of_memory = !attempt(k, [&] { content = read(); });
      std::ostringstream all;
      all << std::hexfloat;
      if (!outcome.out_of_memory) content.print(all);
      outcome.all = all.str();
    } catch (const std::exception& error) {
      outcome.all = error.what();
      outcome.out_of_memory = tells_of_memory(error.what());
      if (!outcome.out_of_memory) return outcome;
    }
    if (usual.empty()) usual = outcome.all;
    outcome.right = !outcome.out_of_memory && outcome.all == usual;
    return outcome;
  };
}

void print(std::ostream& out, const lcp::SpMat& A) {
  out << A.rows() << 'x' << A.cols() << ':';
  for (lcp::Index j = 0; j < A.cols(); ++j)
    for (lcp::SpMat::InnerIterator it(A, j); it; ++it) out << it.row() << ',' << j << '=' << it.value() << ' ';
}
void print(std::ostream& out, const lcp::Vec& v) { out << v.transpose() << '\n'; }

struct Matrix {
  lcp::SpMat A{};
  void print(std::ostream& out) const { faults::print(out, A); }
};
struct Vector {
  lcp::Vec v{};
  void print(std::ostream& out) const { faults::print(out, v); }
};
struct Lcp {
  lcp::SiconosLcp lcp{};
  void print(std::ostream& out) const {
    faults::print(out, lcp.problem.M);
    faults::print(out, lcp.problem.q);
    faults::print(out, lcp.z);
  }
};
struct Contact {
  contact::Problem problem{};
  void print(std::ostream& out) const {
    out << problem.name;
    faults::print(out, problem.W.matrix());
    faults::print(out, problem.q);
    faults::print(out, problem.mu);
  }
};
struct Nl {
  std::unique_ptr<ncp::ampl::Model> model{};
  void print(std::ostream& out) const {
    faults::print(out, model->start());
    lcp::Vec F = lcp::Vec::Zero(model->size());
    out << model->eval(model->start(), F);
    faults::print(out, F);
    for (lcp::Index i = 0; i < model->size(); ++i) out << model->variable_name(i) << model->equation_name(i);
  }
};

lcp::SpMat some_matrix() {
  support::Random random(5);
  return support::random_sparse(30, 3, random);
}

TEST_F(FileFaults, MatrixMarket) {
  const lcp::SpMat A = some_matrix();
  const std::string general = made("general.mtx", lcp::matrix_text(A));
  const std::string symmetric = made("symmetric.mtx",
                                     "%%MatrixMarket matrix coordinate real symmetric\n3 3 4\n1 1 2\n"
                                     "2 1 -1\n2 2 2\n3 3 5\n");
  const std::string vector = made("vector.mtx", lcp::vector_text(lcp::Vec::LinSpaced(40, 0, 1)));
  const std::string plain = made("plain.txt", "1 2 3\n4 5 6\n");
  every_request_fails_once("read general.mtx", reading([=] { return Matrix{lcp::read_matrix(general)}; }));
  every_request_fails_once("read symmetric.mtx", reading([=] { return Matrix{lcp::read_matrix(symmetric)}; }));
  every_request_fails_once("read vector.mtx", reading([=] { return Vector{lcp::read_vector(vector)}; }));
  every_request_fails_once("read numbers", reading([=] { return Vector{lcp::read_vector(plain, true)}; }));
}

TEST_F(FileFaults, Siconos) {
  const std::string dense = made("lcp.dat", "2\n0\n2\n2\n2 2\n1 2\n3 4e0\n-5 +6\n");
  const std::string blocks =
      made("blocks.dat", "3\n1\n3 3\n3\n2 2\n1 3\n1 3\n3 3\n0 2 3\n0 1 1\n0 1\n1 2 3\n2 4 5 0 7\n-1 -2 -3\n");
  every_request_fails_once("read lcp.dat", reading([=] { return Lcp{lcp::read_siconos_lcp(dense)}; }));
  every_request_fails_once("read lcp.dat, blocks", reading([=] { return Lcp{lcp::read_siconos_lcp(blocks)}; }));
}

TEST_F(FileFaults, ContactText) {
  const std::string local = made("local.dat", "2\n1\n0\n2\n2\n2 2\n1 2\n3 4\n-5 6e0\n0.25\n");
  const std::string global = made("global.dat", "2 1\n0 2 2\n2 2\n2 0 0 4\n0 2 2\n2 2\n1 2 3 4\n2 4\n10 20\n0.5\n1\n");
  every_request_fails_once("read local.dat", reading([=] { return Contact{contact::read_problem(local)}; }));
  every_request_fails_once("read global.dat", reading([=] { return Contact{contact::read_problem(global)}; }));
}

TEST_F(FileFaults, Fclib) {
  const std::string arch = std::string(PERP_SOURCE_DIR) + "/data/contact/arch-9.hdf5";
  every_request_fails_once("read arch-9.hdf5", reading([=] { return Contact{contact::read_problem(arch)}; }));
}

TEST_F(FileFaults, Nl) {
  for (const char* name : {"cournot", "cases", "streets"}) {
    const std::string file = std::string(PERP_SOURCE_DIR) + "/data/models/" + name + ".nl";
    every_request_fails_once(std::string("read ") + name + ".nl",
                             reading([=] { return Nl{ncp::ampl::read_model(file)}; }));
  }
}

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// `write` writes the target of this path, which is there; `same` says whether two contents are.
template <class Write>
Scenario writing(const fs::path& folder, const std::string& target, Write write) {
  return [=, whole = std::string()](long k) mutable {
    const std::string old = "what was there";
    std::ofstream(target, std::ios::binary) << old;
    Outcome outcome;
    std::string what;
    try {
      outcome.out_of_memory = !attempt(k, write);
    } catch (const std::exception& error) {
      what = error.what();
      outcome.out_of_memory = tells_of_memory(what);
    }
    const std::string now = content_of(target);
    if (whole.empty()) whole = now;
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder)) {
      ++files;
      if (entry.path() != target) what += " left behind: " + entry.path().string();
    }
    outcome.all = what + (now == old ? "old" : now == whole ? "whole" : "torn: " + now);
    const bool fine = files == 1 && (now == whole || now == old);
    outcome.right = fine && !outcome.out_of_memory && now == whole && what.empty();
    outcome.out_of_memory = outcome.out_of_memory && fine;
    if (files != 1)
      for (const auto& entry : fs::directory_iterator(folder)) fs::remove(entry.path());
    return outcome;
  };
}

TEST_F(FileFaults, Writing) {
  const std::string target = path("out");
  const std::string text(100'000, 'x');
  const lcp::SpMat A = some_matrix();
  const lcp::Vec v = lcp::Vec::LinSpaced(40, 0, 1);
  every_request_fails_once("write_file", writing(folder_, target, [=] { lcp::write_file(target, text); }));
  every_request_fails_once("write_matrix", writing(folder_, target, [=] { lcp::write_matrix(target, A, "made"); }));
  every_request_fails_once("write_vector", writing(folder_, target, [=] { lcp::write_vector(target, v, "made"); }));
  fs::remove(target);
  const contact::Fclib fclib{.problem = contact::make_scene(contact::BoxStack{.boxes = 2}).problem()};
  every_request_fails_once("write_fclib", writing(folder_, target, [=] { contact::write_fclib(target, fclib); }));
}

TEST_F(FileFaults, Sol) {
  const fs::path folder = folder_ / "sol";
  fs::create_directories(folder);
  const std::string stub = std::string(PERP_SOURCE_DIR) + "/data/models/cournot.nl";
  fs::copy_file(stub, folder_ / "cournot.nl");
  const auto model = ncp::ampl::read_model(path("cournot.nl"));
  // Beside the stub: moved to a folder of its own after each call.
  const std::string written = path("cournot.sol");
  const std::string target = (folder / "cournot.sol").string();
  every_request_fails_once("write .sol", writing(folder, target, [&] {
                             fs::remove(written);
                             model->write_sol("made", model->start().head(model->n_var()), 0);
                             fs::rename(written, target);
                           }));
}

}  // namespace
}  // namespace perp::faults
