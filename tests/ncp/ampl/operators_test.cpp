// SPDX-License-Identifier: Apache-2.0
// Every operator of the format, its value against the C++ library and its derivative against differences (Gay,
// "Writing .nl files", table 6). Would catch a wrong arity or opcode in the checker and misused operands.
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "ncp/interval/enclosure.hpp"
#include "nl_text.hpp"

namespace perp::ncp::ampl {
namespace {

using Function = std::function<double(double, double)>;

// F0 = f(x0, x1), F1 = x1.
std::string model_of(const std::string& expression) {
  return text({.vars = 2, .cons = 2, .cc = 2, .nonzeros = 3}) + "C0\n" + expression +
         "C1\nn0\nr\n5 0 1\n5 0 2\nb\n3\n3\nk1\n1\nJ0 2\n0 0\n1 0\nJ1 1\n1 1\n";
}

struct Case {
  const char* name;
  std::string expression;
  Function f;
  double x = 0.4, y = 0.7;
};

class Operators : public testing::TestWithParam<Case> {};

TEST_P(Operators, ValueAndDerivative) {
  const Case& c = GetParam();
  for (const std::string& content : {model_of(c.expression), binary_twin(model_of(c.expression))}) {
    const auto m = read_text(content);
    const Vec x{{c.x, c.y}};
    const double expected = c.f(c.x, c.y);
    EXPECT_NEAR(values(*m, x)[0], expected, 1e-14 * std::max(1.0, std::abs(expected)));
    EXPECT_EQ(describe(*m, check_jacobian(*m, x), 1e-7), "");
  }
}

// Over boxes about the point: every value and derivative lies in its range. Would catch an operator that the ranges
// take for another one, and a derivative of ranges that is not the library's.
TEST_P(Operators, RangesHoldValuesAndDerivatives) {
  const Case& c = GetParam();
  const auto m = read_text(model_of(c.expression));
  ASSERT_NE(m->enclosure(), nullptr);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> part(-1, 1);
  for (const double width : {0.0, 1e-6, 0.01, 0.2}) {
    const std::vector<Interval> X{{c.x - width, c.x + width}, {c.y - width, c.y + width}};
    std::vector<Interval> F(2), J(at(m->jacobian_pattern().nonZeros()));
    std::vector<char> known(2);
    m->enclosure()->values(X, F);
    m->enclosure()->jacobian(X, J, known);
    for (int k = 0; k < 20; ++k) {
      const Vec x{{c.x + width * part(random), c.y + width * part(random)}};
      const double f = values(*m, x)[0], slack = 1e-14 * std::max(1.0, std::abs(f));  // of the library's own rounding
      EXPECT_TRUE(Interval(F[0].lower - slack, F[0].upper + slack).contains(f)) << f;
      if (known[0] == 0) continue;
      SpMat there = m->jacobian_pattern();
      ASSERT_TRUE(m->jacobian(x, there));
      for (std::size_t e = 0; e < J.size(); ++e) {
        const double d = there.valuePtr()[e], near = 1e-13 * std::max(1.0, std::abs(d));
        EXPECT_TRUE(Interval(J[e].lower - near, J[e].upper + near).contains(d)) << d << " entry " << e;
      }
    }
  }
}

const std::string two = "v0\nv1\n";

INSTANTIATE_TEST_SUITE_P(
    All, Operators,
    testing::Values(Case{"plus", "o0\n" + two, [](double a, double b) { return a + b; }},
                    Case{"minus", "o1\n" + two, [](double a, double b) { return a - b; }},
                    Case{"times", "o2\n" + two, [](double a, double b) { return a * b; }},
                    Case{"divide", "o3\n" + two, [](double a, double b) { return a / b; }},
                    Case{"remainder", "o4\n" + two, [](double a, double b) { return std::fmod(a, b); }, 1.6},
                    Case{"power", "o5\n" + two, [](double a, double b) { return std::pow(a, b); }},
                    Case{"square", "o5\nv0\nn2\n", [](double a, double) { return a * a; }},
                    Case{"constant_power", "o5\nv0\nn-1.5\n", [](double a, double) { return std::pow(a, -1.5); }},
                    Case{"exponential", "o5\nn3\nv0\n", [](double a, double) { return std::pow(3, a); }},
                    Case{"less", "o6\nv1\nv0\n", [](double a, double b) { return std::max(b - a, 0.0); }},
                    Case{"less_cut", "o6\n" + two, [](double, double) { return 0.0; }},
                    Case{"min", "o11\n3\nv0\nv1\nn3\n", [](double a, double b) { return std::min(a, b); }},
                    Case{"max", "o12\n2\nv0\nv1\n", [](double a, double b) { return std::max(a, b); }},
                    Case{"min_of_one", "o11\n1\nv0\n", [](double a, double) { return a; }},
                    Case{"floor", "o13\nv0\n", [](double a, double) { return std::floor(a); }, -1.4},
                    Case{"ceil", "o14\nv0\n", [](double a, double) { return std::ceil(a); }},
                    Case{"abs", "o15\nv0\n", [](double a, double) { return std::abs(a); }, -0.4},
                    Case{"negate", "o16\nv0\n", [](double a, double) { return -a; }},
                    Case{"tanh", "o37\nv0\n", [](double a, double) { return std::tanh(a); }},
                    Case{"tan", "o38\nv0\n", [](double a, double) { return std::tan(a); }},
                    Case{"sqrt", "o39\nv0\n", [](double a, double) { return std::sqrt(a); }},
                    Case{"sinh", "o40\nv0\n", [](double a, double) { return std::sinh(a); }},
                    Case{"sin", "o41\nv0\n", [](double a, double) { return std::sin(a); }},
                    Case{"log10", "o42\nv0\n", [](double a, double) { return std::log10(a); }},
                    Case{"log", "o43\nv0\n", [](double a, double) { return std::log(a); }},
                    Case{"exp", "o44\nv0\n", [](double a, double) { return std::exp(a); }},
                    Case{"cosh", "o45\nv0\n", [](double a, double) { return std::cosh(a); }},
                    Case{"cos", "o46\nv0\n", [](double a, double) { return std::cos(a); }},
                    Case{"atanh", "o47\nv0\n", [](double a, double) { return std::atanh(a); }},
                    Case{"atan2", "o48\n" + two, [](double a, double b) { return std::atan2(a, b); }},
                    Case{"atan", "o49\nv0\n", [](double a, double) { return std::atan(a); }},
                    Case{"asinh", "o50\nv0\n", [](double a, double) { return std::asinh(a); }},
                    Case{"asin", "o51\nv0\n", [](double a, double) { return std::asin(a); }},
                    Case{"acosh", "o52\nv0\n", [](double a, double) { return std::acosh(a); }, 2.5},
                    Case{"acos", "o53\nv0\n", [](double a, double) { return std::acos(a); }},
                    Case{"sum", "o54\n3\nv0\nv1\no2\nv0\nv1\n", [](double a, double b) { return a + b + a * b; }}),
    [](const auto& given) { return given.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Discrete, Operators,
    testing::Values(
        Case{"div", "o55\nv0\nn2\n", [](double, double) { return 2.0; }, 5.5},
        Case{"precision", "o56\nv0\nn2\n", [](double, double) { return 0.12; }, 0.123},
        Case{"round", "o57\nv0\nn1\n", [](double, double) { return 1.3; }, 1.27},
        Case{"trunc", "o58\nv0\nn1\n", [](double, double) { return 1.2; }, 1.27},
        Case{"count", "o59\n2\no29\nv0\nn0\no22\nv1\nn0\n", [](double, double) { return 1.0; }},
        Case{"numberof", "o60\n4\nn2\nv0\nv1\nn2\n", [](double, double) { return 2.0; }, 2, 3},
        // << 0, 0.5: -2, 1, 3 >> x, which is 0 at 0.
        Case{"piecewise_right", "o64\n3\nn-2\nn0\nn1\nn0.5\nn3\nv0\n",
             [](double a, double) { return 0.5 + 3 * (a - 0.5); }, 2},
        Case{"piecewise_middle", "o64\n3\nn-2\nn0\nn1\nn0.5\nn3\nv0\n", [](double a, double) { return a; }, 0.25},
        Case{"piecewise_left", "o64\n3\nn-2\nn0\nn1\nn0.5\nn3\nv0\n", [](double a, double) { return -2 * a; }, -3},
        Case{"if_true", "o35\no22\nv0\nv1\no2\nv0\nv1\nv1\n", [](double a, double b) { return a * b; }},
        Case{"if_false", "o35\no22\nv1\nv0\no2\nv0\nv1\no5\nv1\nn2\n", [](double, double b) { return b * b; }}),
    [](const auto& given) { return given.param.name; });

// Conditions, as the value of "if condition then 1 else 0".
struct Condition {
  const char* name;
  std::string condition;
  bool truth;
};
class Conditions : public testing::TestWithParam<Condition> {};

TEST_P(Conditions, Truth) {
  const std::string content = model_of("o35\n" + GetParam().condition + "n1\nn0\n");
  for (const std::string& form : {content, binary_twin(content)})
    EXPECT_EQ(values(*read_text(form), Vec{{1, 2}})[0], GetParam().truth ? 1 : 0);
}

const std::string yes = "o22\nv0\nv1\n";  // 1 < 2
const std::string no = "o29\nv0\nv1\n";   // 1 > 2

INSTANTIATE_TEST_SUITE_P(
    All, Conditions,
    testing::Values(Condition{"lt", yes, true}, Condition{"gt", no, false}, Condition{"le", "o23\nv0\nn1\n", true},
                    Condition{"eq", "o24\nv0\nv1\n", false}, Condition{"ge", "o28\nv0\nv1\n", false},
                    Condition{"ne", "o30\nv0\nv1\n", true}, Condition{"or", "o20\n" + no + yes, true},
                    Condition{"and", "o21\n" + no + yes, false}, Condition{"not", "o34\n" + no, true},
                    Condition{"constant", "n1\n", true}, Condition{"forall", "o70\n3\n" + yes + yes + no, false},
                    Condition{"exists", "o71\n3\n" + no + yes + no, true},
                    Condition{"implies", "o72\n" + yes + no + yes, false}, Condition{"iff", "o73\n" + no + no, true},
                    Condition{"alldiff", "o74\n3\nv0\nv1\nn1\n", false},
                    Condition{"not_alldiff", "o75\n2\nv0\nn1\n", true},
                    Condition{"atleast", "o62\nn1\no59\n2\n" + yes + no, true},
                    Condition{"atmost", "o63\nn0\no59\n2\n" + yes + no, false},
                    Condition{"exactly", "o66\nn1\no59\n2\n" + yes + no, true},
                    Condition{"not_atleast", "o67\nn1\no59\n2\n" + yes + no, false},
                    Condition{"not_atmost", "o68\nn0\no59\n2\n" + yes + no, true},
                    Condition{"not_exactly", "o69\nn1\no59\n2\n" + yes + no, false}),
    [](const auto& given) { return given.param.name; });

}  // namespace
}  // namespace perp::ncp::ampl
