// SPDX-License-Identifier: Apache-2.0
// The checker of .nl files: every rule of the format that a damaged file can break, with the line and the values in
// the message. Whatever would get past it reaches a library that crashes or ends the process.
#include "ncp/ampl/nl_expression.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

// A good model of 2 variables, its segments replaceable one by one.
struct Parts {
  std::string header = text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 3});
  std::string C0 = "C0\no2\nv0\nv1\n";
  std::string C1 = "C1\nn0\n";
  std::string x = "x1\n0 1\n";
  std::string r = "r\n5 1 1\n5 1 2\n";
  std::string b = "b\n2 0\n2 0\n";
  std::string k = "k1\n1\n";
  std::string J0 = "J0 2\n0 0\n1 0\n";
  std::string J1 = "J1 1\n1 1\n";
  std::string str() const { return header + C0 + C1 + x + r + b + k + J0 + J1; }
};

void expect_bad(const Parts& parts, const std::vector<std::string>& messages) {
  expect_refused(parts.str(), bad_file, messages);
}

TEST(Grammar, GoodModel) {
  EXPECT_EQ(read_text(Parts{}.str())->size(), 2);
  // Comments, the order of the segments, CR LF line ends and capital letters do not matter.
  Parts p;
  p.r = "r\t#2 ranges\n5 1 1\t# row\n5 1 2 # row\n";
  EXPECT_EQ(read_text(p.header + p.b + p.r + p.k + p.J1 + p.J0 + p.C1 + p.C0)->size(), 2);
  std::string crlf;
  for (char c : Parts{}.str()) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const auto dos = read_text(crlf);
  EXPECT_EQ(values(*dos, Vec{{2, 3}}), (Vec{{6, 3}}));
  EXPECT_EQ(dos->start(), (Vec{{1, 0}}));
  EXPECT_EQ(read_text("G" + Parts{}.str().substr(1))->size(), 2);
}

// Headers before 1997 have fewer numbers (Gay's table 2, by age).
TEST(Grammar, OldHeader) {
  const auto m = read_text(
      "g3 0 1 0\n 1 1 0\n 1 0\n 0 0\n 1 0\n 0 0\n 0 0\n 1 0\n 0 0\n 0 0 0 0 0\n"
      "C0\no44\nv0\nr\n4 2\nb\n3\nk0\nJ0 1\n0 0\n");
  EXPECT_EQ(values(*m, Vec{{0}}), (Vec{{-1}}));
}

TEST(Grammar, Header) {
  const auto with = [](const std::string& from, const std::string& to) {
    Parts p;
    p.header.replace(p.header.find(from), from.size(), to);
    return p;
  };
  expect_bad(with("g3", "q3"), {"model.nl:1: ", "not an .nl file", "\"q3 1 1 0"});
  expect_bad(with("g3", "z3"), {"format 'z' is not supported"});
  expect_bad(with("g3", "g12"), {"12 options, not in 0..9"});
  expect_bad(with("g3", "g7"), {"7 options announced, 3 found"});
  expect_bad(with(" 2 2 0 0 0\t", " 2 2\t"), {"model.nl:2: ", "expected 3 integers, found 2"});
  expect_bad(with(" 2 2 0 0 0\t", " 2 -2 0 0 0\t"), {"model.nl:2: ", "-2 is negative"});
  expect_bad(with(" 2 2 0 0 0\t", " 2 2x 0 0 0\t"), {"model.nl:2: ", "no integer"});
  expect_bad(with(" 2 2 0 0 0\t", " 0 2 0 0 0\t"), {"no variables"});
  expect_bad(with(" 2 2 0 0 0\t", " 2000000000 2 0 0 0\t"), {"2000000000 variables", "bytes"});
  expect_bad(with(" 2 2 0 0 0\t", " 2 2000000000 0 0 0\t"), {"2000000000 constraints", "bytes"});
  expect_bad(with(" 2 2 0 0 0\t", " 99999999999 2 0 0 0\t"), {"model.nl:2: "});
  expect_bad(with(" 3 0\t# nonzeros", " 2000000000 0\t# nonzeros"), {"2000000000 Jacobian nonzeros"});
  expect_bad(with(" 0 0 0 0 0\t# common", " 2000000000 2000000000 0 0 0\t# common"), {"defined variables"});
  expect_bad(with(" 2 0 0 2 0 0\t", " 2 0 2 2 0 0\t"), {"2 + 2 complementarity conditions among 2"});
  expect_bad(with(" 2 0 0 2 0 0\t", " 3 0 0 2 0 0\t"), {"3 nonlinear constraints of 2"});
  expect_bad(with(" 0 0 0 1\t", " 0 0 2 1\t"), {"model.nl:6: ", "big-endian"});
  expect_bad(with(" 0 0 0 1\t", " 0 0 7 1\t"), {"arithmetic kind 7"});
  expect_bad(with(" 0 0 0 0 0\t# discrete", " 0 0\t# discrete"), {"expected 5 integers, found 2"});
}

TEST(Grammar, Numbers) {
  Parts p;
  for (const char* bad :
       {"nan", "inf", "Infinity", "-inf", "0x10", "1.5.2", "1e", "1d3", "--1", "+-1", "1,5", "x", ""}) {
    p.C1 = std::string("C1\nn") + bad + "\n";
    expect_bad(p, {"model.nl:16: "});
  }
  p.C1 = "C1\nn1e400\n";
  expect_bad(p, {"a number is 1e400, not a finite number"});
  p.C1 = "C1\nn1.5 2\n";
  expect_bad(p, {"model.nl:16: ", "unexpected \"2\""});
  p.C1 = "C1\nn" + std::string(90, '1') + "\n";
  expect_bad(p, {"79th character"});
  for (const char* good : {"1e-400", "+1", ".5", "5.", "1E+2", "-0", "4.9e-324", "0.00000"}) {
    p.C1 = std::string("C1\nn") + good + "\n";
    EXPECT_EQ(values(*read_text(p.str()), Vec{{0, 0}})[1], std::strtod(good, nullptr)) << good;
  }
  p.C1 = "C1\nl-70000\n";
  EXPECT_EQ(values(*read_text(p.str()), Vec{{0, 0}})[1], -70000);
  p.C1 = "C1\ns5\n";  // AMPL's library ends the process over a short in a text file
  expect_bad(p, {"model.nl:16: ", "\"s\""});
}

TEST(Grammar, Segments) {
  Parts p;
  p.x = "Q1\n";
  expect_bad(p, {"model.nl:17: ", "expected a segment", "\"Q\""});
  p.x = "\n";
  expect_bad(p, {"model.nl:17: ", "blank line"});
  p.x = "x3\n0 1\n1 1\n1 1\n";
  expect_bad(p, {"number of initial values is 3, not in 0..2"});
  p.x = "x1\n2 1\n";
  expect_bad(p, {"model.nl:18: ", "variable is 2, not in 0..1"});
  p.x = "x1\n0 1\nx1\n0 1\n";
  expect_bad(p, {"second segment x"});
  p.x = "d1\n2 1\n";
  expect_bad(p, {"constraint is 2, not in 0..1"});
  p.x = "S8 1 s\n0 1\n";
  expect_bad(p, {"kind of the suffix is 8"});
  p.x = "S1 3 s\n0 1\n0 1\n0 1\n";
  expect_bad(p, {"number of suffix values is 3, not in 1..2"});
  p.x = "S0 1 s\n2 1\n";
  expect_bad(p, {"index of a suffix value is 2"});
  p.x = "S0 1\n0 1\n";
  expect_bad(p, {"expected name of the suffix"});
  p.x = "L0\nn1\n";
  expect_bad(p, {"logical constraint"});
  p.x = "F0 0 1 f\n";
  expect_bad(p, {"function is 0, but there is none"});
  p.x = "O0 0\nn1\n";
  expect_bad(p, {"objective is 0, but there is none"});
}

TEST(Grammar, MissingSegments) {
  for (const auto& [part, name] : {std::pair{&Parts::C0, "segment C0"},
                                   {&Parts::C1, "segment C1"},
                                   {&Parts::r, "segment r"},
                                   {&Parts::b, "segment b"}}) {
    Parts p;
    p.*part = "";
    expect_bad(p, {"ends without", name});
  }
  Parts p;
  p.J1 = "";
  expect_bad(p, {"header declares 3 Jacobian nonzeros, the J segments have 2"});
  p = {};
  p.k = "";
  expect_bad(p, {"model.nl:25: ", "segment J comes before segment k"});
  p = {};
  p.C1 = p.C0;
  expect_bad(p, {"second segment C0"});
  p = {};
  p.header = p.header.substr(0, 100);
  expect_refused(p.header, bad_file, {"early end of file"});
  p = {};
  expect_refused(p.str().substr(0, p.str().size() - 1), bad_file, {"model.nl:31: ", "early end of file"});
}

TEST(Grammar, Ranges) {
  Parts p;
  p.r = "r\n5 1 3\n5 1 2\n";
  expect_bad(p, {"model.nl:20: ", "complemented variable is 3, not in 1..2"});
  p.r = "r\n5 1 0\n5 1 2\n";
  expect_bad(p, {"complemented variable is 0"});
  p.r = "r\n5 4 1\n5 1 2\n";
  expect_bad(p, {"kind of complementarity is 4, not in 0..3"});
  p.r = "r\n5 1 1\n5 1 1\n";
  expect_bad(p, {"model.nl:21: ", "rows _scon[1] and _scon[2] both complement variable _svar[1]"});
  p.r = "r\n5 1 1\n4 0\n";
  expect_bad(p, {"declares 2 complementarity conditions, the rows have 1"});
  p.r = "r\n5 1 1\n";
  expect_bad(p, {"model.nl:21: ", "expected the bounds of a constraint (kind 0 to 5), found \"b\""});
  p.r = "r\n5 1 1\n0 1\n";
  expect_bad(p, {"expected upper bound"});
  p.r = "r 7\n5 1 1\n5 1 2\n";
  expect_bad(p, {"model.nl:19: ", "unexpected \"7\""});
  p = {};
  p.b = "b\n2 0\n5 1 1\n";
  expect_bad(p, {"expected the bounds of a variable (kind 0 to 4), found \"5\""});
  p.b = "b\n2 0\n2 inf\n";
  expect_bad(p, {"lower bound is inf"});
  p.b = "b\n2 0\n2 0\n2 0\n";
  expect_bad(p, {"model.nl:25: ", "expected a segment"});
}

TEST(Grammar, JacobianCounts) {
  Parts p;
  p.k = "k2\n1\n2\n";
  expect_bad(p, {"segment k has 2 columns, expected n_var - 1 = 1"});
  p.k = "k1\n2\n";
  expect_bad(p, {"segment k puts 2 nonzeros before variable 1, the J segments 1"});
  p.k = "k1\n-1\n";
  expect_bad(p, {"Jacobian column length is -1"});
  p.k = "k1\n4\n";
  expect_bad(p, {"Jacobian column length is 4, not in 0..3"});
  p = {};
  p.J1 = "J1 1\n2 1\n";
  expect_bad(p, {"variable is 2, not in 0..1"});
  p.J1 = "J2 1\n1 1\n";
  expect_bad(p, {"constraint is 2, not in 0..1"});
  p.J1 = "J1 0\n";
  expect_bad(p, {"number of Jacobian entries is 0"});
  p.J1 = "J0 1\n1 1\n";
  expect_bad(p, {"second segment J0"});
  p.J1 = "J1 2\n0 1\n1 1\n";
  expect_bad(p, {"more than the declared 3"});
  p = {};
  p.J0 = "J0 2\n1 0\n1 0\n";
  expect_bad(p, {"variable 1 occurs twice in segment J0"});
  // The library differentiates only with respect to the variables the row lists.
  p = {};
  p.C1 = "C1\no2\nv0\nv1\n";
  expect_bad(p, {"model.nl:15: ", "constraint 1 depends on variable 0, but segment J1 has no entry"});
  p.C1 = "C1\no35\no22\nv0\nn1\nv1\nn2\n";  // conditions have no derivative
  EXPECT_EQ(read_text(p.str())->size(), 2);
}

TEST(Grammar, Expressions) {
  Parts p;
  const auto bad = [&](const std::string& expression, const std::vector<std::string>& messages) {
    p.C0 = "C0\n" + expression;
    expect_bad(p, messages);
  };
  bad("v2\n", {"model.nl:12: ", "variable is 2, not in 0..1"});
  bad("v-1\n", {"variable is -1"});
  bad("o7\nv0\n", {"operator o7: there is no such operator"});
  bad("o79\nv0\n", {"operator o79"});
  bad("o77\nv0\n", {"operator o77"});  // the library's own x^2
  bad("o2000000000\n", {"operator o2000000000"});
  bad("o54\n2\nv0\nv1\n", {"number of operands is 2, which is less than 3"});
  bad("o54\n2000000000\nv0\nv1\n", {"expected an expression"});
  bad("o11\n0\n", {"number of operands is 0"});
  bad("o59\n1\no22\nv0\nn1\n", {"number of operands is 1"});
  bad("o0\nv0\n", {"expected an expression (n, v or o), found \"C\""});
  bad("f0 1\nv0\n", {"imported function f0"});
  bad("h3:abc\n", {"string"});
  bad("o65\nn1\nh1:a\nh1:b\n", {"symbolic"});
  bad("o61\n2\nv0\nv1\n", {"symbolic"});
  bad("o22\nv0\nv1\n", {"o22 is a condition, expected a number"});
  bad("o35\no2\nv0\nv1\nv0\nv1\n", {"o2 has a number for its value, expected a condition"});
  bad("o35\nv0\nv0\nv1\n", {"unexpected variable"});
  bad("o35\no62\nn1\nn1\nv0\nv1\n", {"expected a count (o59)"});
  bad("o57\nv0\nv1\n", {"unexpected variable"});
  bad("o57\nv0\no2\nn1\nn1\n", {"number of digits has to be a constant"});
  bad("o57\nv0\nn1000\n", {"number of digits is 1000"});
  bad("o57\nv0\nn-1\n", {"number of digits is -1"});
  bad("o56\nv0\nn60\n", {"number of digits is 60"});  // would overrun the library's buffer
  bad("o64\n1\nn1\nv0\n", {"number of slopes is 1"});
  bad("o64\n3\nn1\nn2\nn1\nn2\nn3\nv0\n", {"breakpoint 2", "does not exceed the one before, 2"});
  // The library takes the slope left of -1 for -0.5, too.
  bad("o64\n2\nn1\nn-1\nn2\nv0\n", {"model.nl:15: ", "breakpoint -1", "is negative"});
  bad("o64\n2\nn1\nn0\nn2\nn5\n", {"the argument of a piecewise-linear term (o64) has to be a variable"});
  bad("o64\n2\nn1\nv0\nn2\nv0\n", {"expected breakpoint"});
}

TEST(Grammar, Depth) {
  Parts p;
  const auto nested = [](int levels) {
    std::string s = "C0\n";
    for (int i = 0; i < levels; ++i) s += "o16\n";
    return s + "o2\nv0\nv1\n";
  };
  p.C0 = nested(max_depth - 1);
  EXPECT_EQ(values(*read_text(p.str()), Vec{{2, 3}})[0], -6);
  p.C0 = nested(max_depth);
  expect_bad(p, {"nested deeper than 10000 levels"});
  p.C0 = nested(1000000);
  expect_bad(p, {"nested deeper than 10000 levels"});
  // Deep on the right as well, with derivatives, and in a thread's default stack.
  p.C0 = "C0\n";
  for (int i = 0; i < max_depth - 2; ++i) p.C0 += "o0\nv0\n";
  p.C0 += "o2\nv0\nv1\n";
  EXPECT_EQ(jacobian(*read_text(p.str()), Vec{{2, 3}})(0, 0), max_depth - 2 + 3);
}

TEST(Grammar, DefinedVariables) {
  const auto model = [](const std::string& V, const std::string& C, Header h) {
    h.vars = 2, h.cons = 2, h.cc = 2, h.nonzeros = 3;
    Parts p;
    p.header = text(h);
    p.C0 = V;
    p.C1 = C;
    return p;
  };
  const std::string C = "C0\nv2\nC1\nn0\n";
  EXPECT_EQ(values(*read_text(model("V2 1 0\n0 4\no2\nv0\nv1\n", C, {.con = 1}).str()), Vec{{2, 3}})[0], 14);
  expect_bad(model("V2 0 0\nv1\n", "C0\nv3\nC1\nn0\n", {.con = 1}), {"variable is 3, not in 0..2"});
  expect_bad(model("V2 0 0\nv2\n", C, {.con = 1}), {"defined variable v2 is used in the definition of one that"});
  expect_bad(model("V2 0 0\nv3\nV3 0 0\nv1\n", C, {.con = 2}), {"v3 is used in the definition"});
  expect_bad(model("V3 0 0\nv2\nV2 0 0\nv1\n", C, {.con = 2}), {"v2 is used before its V segment"});
  expect_bad(model(C, "V2 0 0\nv1\n", {.con = 1}), {"v2 is used before its V segment"});
  expect_bad(model("C1\nn0\nV2 0 0\nv1\n", "C0\nv2\n", {.con = 1}), {"comes after the first C or O segment"});
  expect_bad(model("V2 0 0\nv1\nV2 0 0\nv1\n", C, {.con = 1}), {"second definition of defined variable v2"});
  expect_bad(model("V2 1 0\n2 1\nv1\n", C, {.con = 1}), {"variable is 2, not in 0..1"});
  expect_bad(model("V2 -1 0\nv1\n", C, {.con = 1}), {"number of linear terms is -1"});
  expect_bad(model("V2 0 0\nv1\n", C, {.obj = 1}), {"v2 is for objectives only"});
  expect_bad(model("V2 0 0\nv1\n", C, {.con = 2}), {"ends without segment V3"});
  expect_bad(model("V2 0 1\nv1\n", C, {.con = 1}), {"v2 is for a single row, but not among"});
  expect_bad(model("V2 0 0\nv1\n", C, {.con1 = 1}), {"v2 is for several rows, but among"});
  EXPECT_EQ(read_text(model("V2 0 1\nv1\n", C, {.con1 = 1}).str())->size(), 2);
  expect_bad(model("V2 0 1\nv1\n", "C0\nv2\nC1\nv2\n", {.con1 = 1}), {"v2 is for another constraint"});
  expect_bad(model("V2 0 1\nv1\nx0\n", C, {.con1 = 1}), {"has to be followed by"});
  // A row that depends on a variable through a defined one has to list it too.
  expect_bad(model("V2 1 0\n0 1\nn0\n", "C0\nn0\nC1\nv2\n", {.con = 1}), {"constraint 1 depends on variable 0"});
}

TEST(Grammar, Objectives) {
  Header h{.vars = 2, .cons = 2, .objs = 1, .cc = 2, .nonzeros = 3, .gradient = 2};
  Parts p;
  p.header = text(h);
  const auto with = [&](const std::string& O) {
    p.x = O;
    return p;
  };
  EXPECT_TRUE(read_text(with("O0 1\no2\nv0\nv1\nG0 2\n0 0\n1 0\n").str())->has_objective());
  expect_bad(with(""), {"ends without segment O0"});
  expect_bad(with("O0 2\nn0\n"), {"sense of the objective is 2"});
  expect_bad(with("O0 0\nn0\nO0 0\nn0\n"), {"second segment O0"});
  expect_bad(with("O0 0\nn0\nG1 1\n0 1\n"), {"objective is 1, not in 0..0"});
  expect_bad(with("O0 0\nn0\nG0 2\n1 1\n0 1\n"), {"not in ascending order"});
  expect_bad(with("O0 0\nn0\nG0 1\n2 1\n"), {"variable is 2, not in 0..1"});
}

TEST(Grammar, BinaryNamesTheByte) {
  const std::string good = binary_twin(Parts{}.str());
  EXPECT_EQ(read_text(good)->size(), 2);
  const std::size_t body = good.find("C");
  std::string bad = good;
  bad[body + 1] = 7;
  expect_refused(bad, bad_file, {"model.nl: byte " + std::to_string(body) + ": constraint is 7, not in 0..1"});
  expect_refused(good.substr(0, body + 3), bad_file,
                 {"model.nl: byte " + std::to_string(body + 3), "early end of file"});
  std::string swapped = good;
  swapped.replace(swapped.find("\n 0 0 0 1\n"), 10, "\n 0 0 2 1\n");
  expect_refused(swapped, bad_file, {"model.nl:6: ", "big-endian"});
}

// Shorts and longs, which only binary files have.
TEST(Grammar, BinaryShortAndLong) {
  std::string s = binary_twin(Parts{}.str());
  const std::size_t at = s.find(std::string("n\0\0\0\0\0\0\0\0", 9));
  ASSERT_NE(at, std::string::npos);
  std::string with_short = s, with_long = s;
  with_short.replace(at, 9, std::string("s\xfe\xff", 3));
  with_long.replace(at, 9, std::string("l\x00\x00\x01\x00", 5));
  EXPECT_EQ(values(*read_text(with_short), Vec{{0, 0}})[1], -2);
  EXPECT_EQ(values(*read_text(with_long), Vec{{0, 0}})[1], 65536);
}

}  // namespace
}  // namespace perp::ncp::ampl
