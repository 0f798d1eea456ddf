// SPDX-License-Identifier: Apache-2.0
/// `perp contact` in process: what it prints, answers and writes.
#include "app/contact/contact.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <sstream>

#include "app/contact/run/report.hpp"
#include "app/contact/run/run.hpp"
#include "app/json.hpp"
#include "contact/io/fclib.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using test::Answer;
using test::answer;
using test::Json;
using test::parse_json;
using testing::HasSubstr;
using testing::Not;

void expect_near(const Json& values, const std::vector<double>& expected, double tol) {
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(values[k].get<double>(), expected[k], tol) << k;
}

// W = 2^30 v v' of rank 1: the linearised problems of the NCP by norms end on bases that are singular afresh, and a
// chord step asked for their factors: an internal error, and no answer.
TEST(Contact, NormsOnASingularMatrix) {
  const test::Folder folder;
  const std::array<int, 6> v{1, -2, -3, -1, 2, -2};
  std::string text = "3\n2\n\n0\n6\n6\n\n6\n6\n\n";
  for (const int a : v) {
    for (const int b : v) text += fmt::format("{} ", 1073741824.0 * a * b);
    text += '\n';
  }
  text += "\n-80 169 252 81 -164 160\n\n0 0.5\n\n0\n";
  test::write(folder / "singular.dat", text);
  const Answer run = answer({.problems = {folder / "singular.dat"}, .variant = {.formulation = "ncp1"}});
  EXPECT_TRUE(run.code == exit_solved || run.code == exit_unsolved) << run.err;
  EXPECT_FALSE(run.result["status"].get<std::string>().empty());
}

// W of rank 1 again, small. A record of the NCP by norms is accepted by Coulomb's law, at which the run stops; the
// point that the NCP's own residual likes best is another one. The answer is the accepted one, and nobody interrupted.
TEST(Contact, NormsAnswerWithTheAcceptedPoint) {
  const test::Folder folder;
  const std::array<int, 4> v{1, 2, 2, -1};
  std::string text = "2\n2\n\n0\n4\n4\n\n4\n4\n\n";
  for (const int a : v) {
    for (const int b : v) text += fmt::format("{} ", std::ldexp(a * b, -30));
    text += '\n';
  }
  text += "\n6.620772103005379e-06 1.3240612883436143e-05 1.3241544206010758e-05 -6.625428715878456e-06\n";
  text += "\n9.5367431640625e-07 1024\n\n0\n";
  test::write(folder / "small.dat", text);
  const Answer run = answer({.problems = {folder / "small.dat"}, .variant = {.formulation = "ncp1"}});
  EXPECT_NE(run.result["status"], "Interrupted") << run.result["message"];
}

// The solution by hand (contact_app_support.hpp), by every formulation of Coulomb's law. Would catch components or
// contacts mixed up between formulation, table and JSON.
TEST(Contact, ThreeContactsByHand) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  for (const VariantRequest& variant :
       {VariantRequest{}, VariantRequest{.encoding = "B"}, VariantRequest{.method = "path"},
        VariantRequest{.method = "semismooth", .encoding = "B"}, VariantRequest{.method = "interior"}}) {
    const Answer run = answer({.problems = {folder / "three.dat"}, .variant = variant});
    EXPECT_EQ(run.code, exit_solved) << run.err;
    EXPECT_EQ(run.result["solved_by"],
              variant.encoding ? variant.method.value_or("path") : variant.method.value_or("sweeps"));
    const Json& contacts = run.result["contacts"];
    ASSERT_EQ(contacts.size(), 3U);
    EXPECT_EQ(contacts[0]["state"], "open");
    EXPECT_EQ(contacts[1]["state"], "stick");
    EXPECT_EQ(contacts[2]["state"], "slip");
    expect_near(contacts[0]["r"], {0, 0, 0}, 1e-7);
    expect_near(contacts[1]["r"], {1, -0.3, 0}, 1e-7);
    expect_near(contacts[2]["r"], {1, -0.3, -0.4}, 1e-7);
    expect_near(contacts[2]["u"], {0, 0.9, 1.2}, 1e-7);
    EXPECT_NEAR(contacts[1]["margin"].get<double>(), 0.2, 1e-7);
    EXPECT_NEAR(contacts[2]["margin"].get<double>(), 1.5, 1e-7);
    EXPECT_EQ(contacts[1]["mu"], 0.5);
    EXPECT_EQ(contacts[2]["contact"], 3);
    EXPECT_EQ(run.result["states"]["slip"], 1);
    EXPECT_EQ(run.result["status"], "Solved");
    for (const char* key : {"natural", "siconos", "rr9118", "scaled", "cone", "normal", "slip"})
      EXPECT_LE(run.result["residual"][key].get<double>(), 1e-7) << key;
    EXPECT_TRUE(run.result["own_residual"].is_null());
    EXPECT_GE(run.result["stats"]["time_s"].get<double>(), 0);
  }
}

TEST(Contact, PrintsTableVerdictAndJudge) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  test::Captured captured;
  EXPECT_EQ(solve_contact({.problems = {folder / "three.dat"}}, captured.streams), exit_solved);
  for (const char* part :
       {"3 contacts in 3 dimensions, mu 0.5", "of full rank", "symmetric", "glocker+auto", "Solved by",
        "contact  state", "1.5 m/s", "0.2 N s", "Solved by sweeps of Gauss-Seidel: Coulomb's law holds",
        "3 contacts: 1 open, 1 stick, 1 slip", "Siconos 4.4", "INRIA RR-9118", "outside of the cone",
        "normal complementarity", "friction against slip"})
    EXPECT_THAT(captured.out.str(), HasSubstr(part));
  EXPECT_EQ(captured.err.str(), "");
}

// W = I: sticks with r_T = -0.3 and rolls on with |m_R| = 0.25 r_N, w_R = -0.75; in 3D and in 2D. Catches a table or
// JSON without the second disk.
TEST(Contact, ShowsRollingFriction) {
  const test::Folder folder;
  test::write(folder / "space.dat", test::identity_dat(5, 1, "-1 0.3 0 -1 0", "0.5 0.25"));
  test::write(folder / "plane.dat", test::identity_dat(3, 1, "-1 0.3 -1", "0.5 0.25"));
  for (const auto& [file, space] : {std::pair("space.dat", 3), std::pair("plane.dat", 2)}) {
    test::Captured captured;
    EXPECT_EQ(solve_contact({.problems = {folder / file}}, captured.streams), exit_solved);
    const std::string dimensions = "1 contact in " + std::to_string(space) + " dimensions, mu 0.5, mu_r 0.25 m";
    for (const char* part : {dimensions.c_str(), "|m_R| [N m s]", "0.75 1/s", "0 stick, 0 slip, 1 roll"})
      EXPECT_THAT(captured.out.str(), HasSubstr(part));
    const test::Answer run = test::answer({.problems = {folder / file}});
    EXPECT_EQ(run.result["dimension"], space);
    EXPECT_EQ(run.result["states"]["roll"], 1);
    EXPECT_EQ(run.result["contacts"][0]["mu_r"], 0.25);
    EXPECT_EQ(run.result["contacts"][0]["r"].size(), 2U * static_cast<std::size_t>(space) - 1);
  }
}

// Each level adds to those before it.
TEST(Contact, LogLevels) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  std::size_t before = 0;
  for (const LogLevel level : {LogLevel::Quiet, LogLevel::Summary, LogLevel::Info, LogLevel::Debug}) {
    test::Captured captured;
    solve_contact({.problems = {folder / "three.dat"}, .log_level = level}, captured.streams);
    EXPECT_EQ(captured.out.str().empty(), level == LogLevel::Quiet);
    if (level != LogLevel::Quiet) {
      EXPECT_GT(captured.out.str().size(), before);
    }
    before = captured.out.str().size();
  }
}

// Who made each point that was judged, in words. Would catch a legend of letters that lacks some.
TEST(Contact, HistorySaysWhoMadeAPoint) {
  test::Captured captured;
  solve_contact({.problems = {"spheres:12"}, .variant = {.options = {"sweeps=4"}}, .log_level = LogLevel::Debug},
                captured.streams);
  for (const char* part : {"made by", "sweeps", "homotopy", "newton"}) EXPECT_THAT(captured.out.str(), HasSubstr(part));
}

// W = 0 and q_N < 0: no solution, by no formulation of Coulomb's law. Would catch a claim where r is huge.
TEST(Contact, NothingSolvesWhatHasNoSolution) {
  const test::Folder folder;
  test::write(folder / "w0.dat", "3\n1\n\n0\n3\n3\n\n3\n3\n\n0 0 0\n0 0 0\n0 0 0\n\n-1 0.5 0\n\n0.3\n\n0\n");
  for (const char* text : {"glocker", "glocker+homotopy", "glocker+path/B", "glocker+path/A", "glocker+interior/B",
                           "ncp1+path", "ncp1+semismooth", "ncp1+interior"}) {
    const Variant variant = parse_variant(std::string(text));
    VariantRequest request{.formulation = variant.formulation(), .method = variant.method};
    if (const contact::GlockerNcp* ncp = variant.as_ncp())
      request.encoding = ncp->formulation.encoding == contact::Encoding::A ? "A" : "B";
    const Answer run = answer({.problems = {folder / "w0.dat"}, .variant = request, .time_limit = 5});
    EXPECT_EQ(run.code, exit_unsolved) << text << run.err;
    EXPECT_TRUE(run.result["solved_by"].is_null()) << text;
  }
}

// Two facets are exact in the plane: every formulation with friction gives the solution by hand.
TEST(Contact, PlaneProblem) {
  const test::Folder folder;
  test::write(folder / "two.dat", test::two_plane_contacts());
  for (const char* formulation : {"glocker", "ncp1", "inner:8", "outer:8"}) {
    const Answer run = answer({.problems = {folder / "two.dat"}, .variant = {.formulation = formulation}});
    EXPECT_EQ(run.code, exit_solved) << formulation << run.err;
    expect_near(run.result["contacts"][0]["r"], {1, -0.5}, 1e-7);
    expect_near(run.result["contacts"][1]["r"], {1, 0.2}, 1e-7);
    EXPECT_EQ(run.result["contacts"][0]["state"], "slip");
    EXPECT_LE(run.result["residual"]["siconos"].get<double>(), 1e-7);
  }
}

// The projection of (-1.2, -1.6) on the square with the vertices (+-0.5, 0), (0, +-0.5) is (-0.05, -0.45). Would catch
// a polygon's solution that passes for Coulomb's, and a state by the disk: |r_T| < mu r_N there, though the contact
// slips.
TEST(Contact, FacetedLawIsJudgedByItsOwn) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  const ContactRequest request{.problems = {folder / "three.dat"}, .variant = {.formulation = "inner:4"}};
  const Answer run = answer(request);
  EXPECT_EQ(run.code, exit_solved);
  expect_near(run.result["contacts"][2]["r"], {1, -0.05, -0.45}, 1e-8);
  EXPECT_EQ(run.result["contacts"][2]["state"], "slip");
  EXPECT_LE(run.result["own_residual"].get<double>(), 1e-8);
  EXPECT_GT(run.result["residual"]["siconos"].get<double>(), 1e-2);
  EXPECT_EQ(run.result["residual"]["worst"], 3);
  EXPECT_EQ(run.result["exact"], false);
  test::Captured captured;
  solve_contact(request, captured.streams);
  EXPECT_THAT(captured.out.str(), testing::AllOf(HasSubstr("Solves its own problem (a polygon of 4 vertices"),
                                                 HasSubstr("exact law is violated"), Not(HasSubstr("Not solved"))));
}

TEST(Contact, FrictionlessAndNamedAffineMethods) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  for (const char* method : {"auto", "lemke", "block-pivoting"}) {
    const Answer run =
        answer({.problems = {folder / "three.dat"}, .variant = {.formulation = "frictionless", .method = method}});
    EXPECT_EQ(run.code, exit_solved) << run.err;
    expect_near(run.result["contacts"][2]["r"], {1, 0, 0}, 1e-8);
    expect_near(run.result["contacts"][2]["u"], {0, 1.2, 1.6}, 1e-8);
  }
  const Answer mixed =
      answer({.problems = {folder / "three.dat"}, .variant = {.formulation = "outer:6", .form = "mixed"}});
  EXPECT_EQ(mixed.code, exit_solved);
  EXPECT_EQ(mixed.result["form"], "mixed");
  EXPECT_EQ(mixed.result["unknowns"], 27);  // r_N, r_T, 6 kappa at 3 contacts
}

// The judge, not the method, says "solved": no solver reaches 1e-30 on a pile of spheres.
TEST(Contact, UnsolvedIsExitOne) {
  for (const char* formulation : {"glocker", "ncp1"}) {
    const Answer run =
        answer({.generated = {"spheres:20"}, .variant = {.formulation = formulation}, .tol = 1e-30, .time_limit = 0.3});
    EXPECT_EQ(run.code, exit_unsolved);
    EXPECT_NE(run.result["status"], "Solved");
    EXPECT_EQ(run.result["exit_code"], 1);
    EXPECT_FALSE(run.result["message"].get<std::string>().empty());
    EXPECT_THAT(run.err, testing::AllOf(HasSubstr("Not solved"), testing::ContainsRegex("Try:[ \n]")));
  }
}

TEST(Contact, InterruptEndsTheRun) {
  const std::atomic<bool> interrupt{true};
  test::Captured captured;
  EXPECT_EQ(solve_contact({.problems = {"spheres:20", "stack:8"}}, captured.streams, &interrupt), exit_unsolved);
}

// Same name, same problem; another seed, another one.
TEST(Contact, GeneratedProblems) {
  const Loaded a = load("spheres:20:3");
  const Loaded b = generate("spheres:20:3");
  EXPECT_EQ(a.problem.q, b.problem.q);
  EXPECT_NE(generate("spheres:20:4").problem.q, a.problem.q);
  const Loaded smooth = generate("spheres:20:3:0.25");
  EXPECT_EQ(smooth.problem.q, a.problem.q);
  EXPECT_TRUE((smooth.problem.mu.array() == 0.25).all());
  EXPECT_EQ(with_friction("spheres:20", 0.4), "spheres:20:1:0.4");
  EXPECT_EQ(with_friction("spheres:20:3", 0.4), "spheres:20:3:0.4");
  EXPECT_THROW(with_friction("spheres:20:3:0.2", 0.4), InputError);
  EXPECT_THROW(with_friction("arch.hdf5", 0.4), InputError);
  for (const char* name : {"stack:8", "spheres:12", "arch:12", "chain:6", "wall:16", "incline:12"}) {
    const Answer run = answer({.problems = {name}});
    EXPECT_EQ(run.code, exit_solved) << name << ": " << run.err;
    EXPECT_EQ(run.result["problem"], name);
  }
}

// Every kind of input that makes no sense: said with file and reason, exit code 2, also in JSON. Would catch a crash,
// and an error that passes for a result.
TEST(Contact, BadInputIsRefused) {
  const test::Folder folder;
  const std::string good = test::read(PERP_SOURCE_DIR "/data/contact/arch-9.hdf5");
  ASSERT_GT(good.size(), 1000U);
  test::write(folder / "cut.hdf5", good.substr(0, good.size() / 2));
  test::write(folder / "renamed.dat", good);
  test::write(folder / "text.hdf5", test::three_contacts());
  test::write(folder / "negative.dat", test::identity_dat(3, 1, "-1 0 0", "-0.5"));
  test::write(folder / "nan.dat", test::identity_dat(3, 1, "-1 nan 0", "0.5"));
  test::write(folder / "short.dat", test::identity_dat(3, 1, "-1 0", ""));
  test::write(folder / "four.dat", test::identity_dat(4, 1, "-1 0 0 0", "0.5"));
  test::write(folder / "empty.dat", "");
  for (const char* name : {"cut.hdf5", "renamed.dat", "text.hdf5", "negative.dat", "nan.dat", "short.dat", "four.dat",
                           "empty.dat", "none.dat", ""}) {
    const Answer run = answer({.problems = {folder / name}});
    EXPECT_EQ(run.code, exit_input) << name;
    EXPECT_EQ(run.result["status"], "InputError") << name;
    EXPECT_THAT(run.err, testing::AllOf(HasSubstr(folder / name), HasSubstr(run.result["message"].get<std::string>())));
  }
  for (const char* name : {"cubes:10", "spheres", "spheres:", "spheres:0", "spheres:-3", "spheres:x", "spheres:10:y",
                           "spheres:99999999999999999999", "spheres:10:1:x", "spheres:10:1:-1", "spheres:10:1:nan",
                           "spheres:10:1:0.4:5", "spheres:10::0.4"}) {
    const Answer run = answer({.generated = {name}});
    EXPECT_EQ(run.code, exit_input) << name;
    EXPECT_THAT(run.err, HasSubstr(name));
  }
}

TEST(Contact, BadRequestsAreRefused) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  const std::string file = folder / "three.dat";
  const auto why = [&](const ContactRequest& request) {
    test::Captured captured;
    EXPECT_EQ(solve_contact(request, captured.streams), exit_input);
    return captured.err.str();
  };
  EXPECT_THAT(why({}), HasSubstr("which problem"));
  EXPECT_THAT(why({.problems = {file}, .tol = 0}), HasSubstr("--tol 0"));
  EXPECT_THAT(why({.problems = {file}, .tol = std::nan("")}), HasSubstr("--tol nan"));
  EXPECT_THAT(why({.problems = {file}, .time_limit = -1}), HasSubstr("--time-limit -1"));
  EXPECT_THAT(why({.problems = {file, "stack:4"}, .fclib_out = folder / "f.hdf5"}), HasSubstr("one problem"));
  EXPECT_THAT(why({.problems = {file}, .fclib_out = folder / "no/f.hdf5"}), HasSubstr("no/f.hdf5"));
  EXPECT_THAT(why({.problems = {file}, .json = folder / "no/f.json"}), HasSubstr("no/f.json"));
  EXPECT_THAT(why({.problems = {file}, .variant = {.formulation = "inner:2"}}), HasSubstr("inner:2"));
}

// A refused one among several does not keep the others from being solved; the worst code counts.
// Would catch a limit whose nanoseconds overflow, so that it is over before it begins.
TEST(Contact, HugeTimeLimits) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  for (const char* formulation : {"glocker", "ncp1", "inner:8", "frictionless"})
    for (const double limit : {1e10, 1e300, std::numeric_limits<double>::infinity()}) {
      const Answer run =
          answer({.problems = {folder / "three.dat"}, .variant = {.formulation = formulation}, .time_limit = limit});
      EXPECT_EQ(run.code, exit_solved) << formulation << ' ' << limit << run.result["status"];
    }
}

TEST(Contact, SeveralProblems) {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  test::write(folder / "nan.dat", test::identity_dat(3, 1, "-1 nan 0", "0.5"));
  const Answer run = answer({.problems = {folder / "three.dat", folder / "nan.dat"}, .generated = {"stack:4"}});
  EXPECT_EQ(run.code, exit_input);
  ASSERT_EQ(run.result["problems"].size(), 3U);
  EXPECT_EQ(run.result["problems"][0]["status"], "Solved");
  EXPECT_EQ(run.result["problems"][1]["status"], "InputError");
  EXPECT_EQ(run.result["problems"][2]["status"], "Solved");
  EXPECT_THAT(run.err, testing::AllOf(HasSubstr("own law"), HasSubstr("refused")));  // the closing table
}

// Would catch a solution that is not the one reported, a problem that changed on its way, and one that cannot be solved
// again.
TEST(Contact, FclibFileReadsBack) {
  const test::Folder folder;
  const std::string file = folder / "out.hdf5";
  const Answer run = answer({.generated = {"stack:8"}, .fclib_out = file});
  EXPECT_EQ(run.code, exit_solved);
  const contact::Fclib read = contact::read_fclib(file);
  const Loaded made = generate("stack:8");
  EXPECT_LT((read.problem.q - made.problem.q).lpNorm<Eigen::Infinity>(), 1e-14);
  EXPECT_EQ(read.problem.mu, made.problem.mu);
  ASSERT_TRUE(read.solution);
  for (lcp::Index a = 0; a < made.problem.contacts(); ++a)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(read.solution->r[3 * a + k],
                run.result["contacts"][static_cast<std::size_t>(a)]["r"][static_cast<std::size_t>(k)].get<double>());
  EXPECT_LE(contact::residual(read.problem, read.solution->r).siconos, 1e-8);
  ASSERT_TRUE(read.problem.global);  // the velocities of the bodies obey their equation of motion
  const contact::Global& global = *read.problem.global;
  const contact::FclibPoint& point = *read.solution;
  ASSERT_EQ(point.v.size(), global.f.size());
  const lcp::Vec momentum = global.H * point.r + global.f;
  EXPECT_LT((global.M * point.v - momentum).norm(), 1e-10 * momentum.norm());
  EXPECT_LT((global.H.transpose() * point.v + global.w - point.u).lpNorm<Eigen::Infinity>(), 1e-10);
  EXPECT_THAT(read.description, HasSubstr("glocker+auto"));
  EXPECT_EQ(answer({.problems = {file}}).code, exit_solved);
}

// 128 contacts: the table is cut in the middle and says so.
TEST(Contact, LongTablesAreShortened) {
  for (const bool full : {false, true}) {
    test::Captured captured;
    solve_contact({.problems = {"wall:100"}, .full = full}, captured.streams);
    EXPECT_EQ(captured.out.str().find("--full shows them") == std::string::npos, full);
  }
}

// A run that was left at its limit says nothing of its own problem. It said that the residual there was 0.
TEST(ContactReport, NothingIsSaidOfAProblemThatWasLeft) {
  const Loaded loaded = generate("spheres:5");
  contacts::Run left;
  left.variant = parse_variant(std::string("inner:8"));
  left.status = Status::TimeLimit;
  left.solution.r = lcp::Vec::Zero(loaded.problem.q.size());
  left.solution.u = loaded.problem.q;  // W 0 + q
  contact::judge(left, loaded.problem, left.variant);
  EXPECT_TRUE(parse_json(run_json(loaded, left, exit_unsolved))["own_residual"].is_null());
  std::ostringstream out;
  print_verdict(out, loaded.problem, left);
  EXPECT_THAT(out.str(), HasSubstr("Nothing is known of its own problem"));
  EXPECT_THAT(out.str(), Not(HasSubstr("natural residual 0")));
}

}  // namespace
}  // namespace perp::app::contacts
