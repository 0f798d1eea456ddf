// SPDX-License-Identifier: Apache-2.0
#include "nl_text.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "ncp/interval/graph_enclosure.hpp"

namespace perp::ncp::ampl {
namespace fs = std::filesystem;

TempFolder::TempFolder() {
  std::string name = (fs::temp_directory_path() / "perp-ampl-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TempFolder::write(const std::string& name, const std::string& content) const {
  const std::string file = path_ + "/" + name;
  fs::remove(file);  // some file systems flush a file that is cut and written again
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

std::string text(const Header& h) {
  std::ostringstream out;
  out << "g3 1 1 0\t# problem test\n" << ' ' << h.vars << ' ' << h.cons << ' ' << h.objs << " 0 " << h.eqns;
  if (h.logical > 0) out << ' ' << h.logical;
  out << "\t# vars, constraints, objectives, ranges, eqns\n"
      << ' ' << h.cons << ' ' << h.objs << " 0 " << h.cc << " 0 0\t# nonlinear constraints, objectives; ccons\n"
      << " 0 0\t# network constraints\n"
      << (h.nonlinear.empty() ? ' ' + std::to_string(h.vars) + ' ' + std::to_string(h.objs > 0 ? h.vars : 0) + ' ' +
                                    std::to_string(h.objs > 0 ? h.vars : 0)
                              : h.nonlinear)
      << "\t# nonlinear vars in constraints, objectives, both\n"
      << " 0 " << h.functions << " 0 1\t# linear network variables; functions; arith, flags\n"
      << (h.discrete.empty() ? " 0 " + std::to_string(h.integers) + " 0 0 0" : h.discrete) << "\t# discrete variables\n"
      << ' ' << h.nonzeros << ' ' << h.gradient << "\t# nonzeros in Jacobian, gradients\n"
      << " 0 0\t# max name lengths\n"
      << ' ' << h.both << ' ' << h.con << ' ' << h.obj << ' ' << h.con1 << ' ' << h.obj1 << "\t# common exprs\n";
  return out.str();
}

namespace {

/// Turns one line of text after the other into packed numbers.
class Twin {
 public:
  explicit Twin(std::istream& in) : in_(in) {}

  std::string run() {
    int n_var = 0;
    int n_con = 0;
    for (int i = 0; i < 10; ++i) {
      const std::string line = next();
      if (i == 1) std::istringstream(line) >> n_var >> n_con;
      out_.append(i == 0 ? "b" : "").append(line.substr(i == 0 ? 1 : 0)).append("\n");
    }
    for (std::string line = next(); !line.empty(); line = next()) segment(line, n_var, n_con);
    return std::move(out_);
  }

 private:
  std::string next() {
    std::string line;
    std::getline(in_, line);
    return line.substr(0, line.find_first_of("#\t"));
  }
  template <class T>
  void put(T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out_.append(bytes, sizeof value);
  }
  // Copies the fields: i integer, r real.
  void fields(const std::string& line, const char* kinds) {
    std::istringstream in(line);
    for (; *kinds != 0; ++kinds) {
      std::string token;
      in >> token;
      if (*kinds == 'i')
        put(std::stoi(token));
      else
        put(std::stod(token));
    }
  }
  void lines(int n, const char* kinds) {
    for (int i = 0; i < n; ++i) fields(next(), kinds);
  }
  void segment(const std::string& line, int n_var, int n_con) {
    const char kind = line[0];
    const std::string rest = line.substr(1);
    int a = 0, b = 0;
    std::istringstream(rest) >> a >> b;
    if (kind >= '0' && kind <= '9') return fields(line, "i");  // a number of operands
    out_ += kind;
    switch (kind) {
      case 'n':
        return fields(rest, "r");
      case 'r':
      case 'b':
        for (int i = 0; i < (kind == 'r' ? n_con : n_var); ++i) range(next());
        return;
      case 'O':
        return fields(rest, "ii");
      case 'V':
        fields(rest, "iii");
        return lines(b, "ir");
      case 'J':
      case 'G':
        fields(rest, "ii");
        return lines(b, "ir");
      case 'x':
      case 'd':
        fields(rest, "i");
        return lines(a, "ir");
      case 'k':
      case 'K':
        fields(rest, "i");
        return lines(a, "i");
      case 'S': {
        std::string name;
        std::istringstream(rest) >> a >> b >> name;
        put(a);
        put(b);
        put(static_cast<int>(name.size()));
        out_ += name;
        return lines(b, (a & 4) != 0 ? "ir" : "ii");
      }
      default:
        return fields(rest, "i");
    }
  }
  void range(const std::string& line) {
    out_ += line[0];
    static const char* const kinds[] = {"rr", "r", "r", "", "r", "ii"};
    fields(line.substr(1), kinds[line[0] - '0']);
  }

  std::istream& in_;
  std::string out_;
};

}  // namespace

std::string binary_twin(const std::string& text) {
  std::istringstream in(text);
  return Twin(in).run();
}

std::string read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::unique_ptr<Model> read_text(const std::string& content) {
  const TempFolder folder;
  return read_model(folder.write("model.nl", content));
}

void expect_refused(const std::string& content, int code, const std::vector<std::string>& parts) {
  const TempFolder folder;
  const std::string path = folder.write("model.nl", content);
  try {
    read_model(path);
    ADD_FAILURE() << "accepted:\n" << content;
  } catch (const ModelError& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    EXPECT_THAT(e.what(), testing::StartsWith(path));
    for (const std::string& part : parts) EXPECT_THAT(e.what(), testing::HasSubstr(part));
  }
}

std::vector<std::string> samples() {
  const fs::path folder = fs::path(PERP_SOURCE_DIR) / ".." / "shared" / "data" / "nl";
  std::vector<std::string> paths;
  std::error_code absent;
  for (const auto& entry : fs::directory_iterator(folder, absent))
    if (entry.path().extension() == ".nl") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

const std::vector<std::string>& rich_models() {
  static const std::vector<std::string> models = {
      // Defined variables of all five kinds, an objective, a gradient, suffixes, dual values and a guess:
      //   v3 = 2 x0 + x1^2 (both), v4 = v3 + sin(x2) (constraints), v5 = x0 x1 (objectives), v6 = exp(v4) (row 0),
      //   v7 = v5^2 (objective).
      text({.vars = 3,
            .cons = 3,
            .objs = 1,
            .eqns = 1,
            .cc = 2,
            .nonzeros = 8,
            .gradient = 2,
            .both = 1,
            .con = 1,
            .obj = 1,
            .con1 = 1,
            .obj1 = 1}) +
          "S0 2 priority\n0 1\n2 3\nS5 1 ref\n1 0.5\n"
          "V3 1 0\n0 2\no5\nv1\nn2\nV4 0 0\no0\nv3\no41\nv2\nV5 0 0\no2\nv0\nv1\n"
          "V6 0 1\no44\nv4\nC0\no0\nv6\nv3\n"
          "C1\no2\nv4\nv0\nC2\nn1.5\n"
          "V7 0 4\no5\nv5\nn2\nO0 1\no0\nv7\nv3\nG0 2\n0 0\n1 1\n"
          "d2\n0 1\n2 -1\nx2\n0 0.25\n2 -0.5\n"
          "r\n4 3\n5 1 3\n5 3 1\nb\n0 -1 1\n3\n2 -2\nk2\n3\n6\n"
          "J0 3\n0 1\n1 0\n2 0\nJ1 3\n0 0\n1 0\n2 1\nJ2 2\n0 1\n1 -1\n",
      // Conditions, lists and piecewise-linear terms, side inequalities of rows and variables, a free row, K:
      //   C0 = min(x0, x1, 3) + max(x1, 2 x0) + count(x0 > 0, x1 > 0) + numberof(1, x0, x1)
      //   C1 = if x0 >= 1 and not x1 < 0 then x0^2 else (if x0 < -1 or x1 > 5 then x1 else 2)
      //   C2 = << 0, 2: 1, 2, 4 >> x1 + floor(x0) + round(x1, 2) + (x0 div 2)
      //   C3 = (free row) sqrt(x0),  C4 = if atleast 1 (x0 > 0, x1 > 0) then 1 else x0
      text({.vars = 2, .cons = 5, .eqns = 1, .cc = 1, .nonzeros = 8}) +
          "C0\no54\n4\no11\n3\nv0\nv1\nn3\no12\n2\nv1\no2\nn2\nv0\no59\n2\no29\nv0\nn0\no29\nv1\nn0\no60\n3\nn1\nv0\nv1"
          "\n"
          "C1\no35\no21\no28\nv0\nn1\no34\no22\nv1\nn0\no5\nv0\nn2\no35\no20\no22\nv0\nn-1\no29\nv1\nn5\nv1\nn2\n"
          "C2\no54\n4\no64\n3\nn1\nn0\nn2\nn2\nn4\nv1\no13\nv0\no57\nv1\nn2\no55\nv0\nn2\n"
          "C3\no39\nv0\n"
          "C4\no35\no62\nn1\no59\n2\no29\nv0\nn0\no29\nv1\nn0\nn1\nv0\n"
          "x2\n0 1.25\n1 0.75\nr\n5 1 1\n4 1\n0 -1 20\n3\n1 7\nb\n2 0\n0 -3 3\nK1\n5\n"
          "J0 2\n0 0\n1 0\nJ1 2\n0 0\n1 0\nJ2 2\n0 0\n1 0\nJ3 1\n0 0\nJ4 1\n0 0\n",
  };
  return models;
}

Vec values(const Model& model, const Vec& x) {
  Vec F(model.size());
  EXPECT_TRUE(model.eval(x, F));
  // Catches rows that are written down otherwise than the library evaluates them.
  std::vector<Interval> X(x.begin(), x.end()), written(X.size());
  const std::optional<Expressions> f = model.expressions();
  GraphEnclosure(*f, model.jacobian_pattern()).values(X, written);
  for (Index i = 0; i < model.size(); ++i) {
    const Interval row = written[lcp::at(i)];
    const double slack = 1e-12 * std::max(1.0, std::abs(F[i]));  // of the library's own rounding
    EXPECT_TRUE(row.is_empty() || Interval(row.lower - slack, row.upper + slack).contains(F[i]))
        << "row " << i << ": " << F[i] << " is not in [" << row.lower << ", " << row.upper << "]";
  }
  return F;
}

Eigen::MatrixXd jacobian(const Model& model, const Vec& x) {
  SpMat J = model.jacobian_pattern();
  EXPECT_TRUE(model.jacobian(x, J));
  return J;
}

}  // namespace perp::ncp::ampl
