// SPDX-License-Identifier: Apache-2.0
#include "path_library.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csetjmp>
#include <cstdlib>
#include <stdexcept>

// PATH's headers, C with macros for types: after all others.
extern "C" {
#include "MCP_Interface.h"
#include "Options.h"
#include "Output_Interface.h"
#include "Path.h"
#include "PathOptions.h"
}
#undef False
#undef True

namespace perp::bench {

namespace {

using ncp::Index;
using ncp::SpMat;
using ncp::Vec;

constexpr double path_infinity = 1e20;

/// The manual's figure 21; the headers do not declare it.
struct ErrorInterface {
  void* data;
  void (*error)(void*, char*);
  void (*warning)(void*, char*);
};

/// Where PATH's fatal errors go, which end the process otherwise. The library is global, and so is this.
struct Fatal {
  std::jmp_buf back;
  std::array<char, 256> message{};
};
Fatal fatal;

void on_error(void*, char* message) {
  std::snprintf(fatal.message.data(), fatal.message.size(), "%s", message == nullptr ? "" : message);
  std::longjmp(fatal.back, 1);  // NOLINT(cert-err52-cpp): over frames of C only
}
void on_warning(void*, char*) {}
void print_nothing(void*, int, char*) {}

/// What the callbacks see.
struct Problem {
  const ncp::Mcp& mcp;
  const Vec& x0;
  SpMat J;
  std::vector<bool> linear;
  Vec F;
  int F_evals = 0;
  int J_evals = 0;
};

Problem& problem(void* data) { return *static_cast<Problem*>(data); }

void problem_size(void* data, int* n, int* nonzeros) {
  *n = static_cast<int>(problem(data).mcp.size());
  *nonzeros = static_cast<int>(problem(data).J.nonZeros()) + 1;
}

void bounds(void* data, int n, double* x, double* lower, double* upper) {
  const ncp::Box& box = problem(data).mcp.box();
  for (int i = 0; i < n; ++i) {
    x[i] = problem(data).x0[i];
    lower[i] = std::max(box.lower[i], -path_infinity);
    upper[i] = std::min(box.upper[i], path_infinity);
  }
}

int function(void* data, int n, double* x, double* f) {
  Problem& p = problem(data);
  ++p.F_evals;
  const bool defined = p.mcp.eval(Eigen::Map<const Vec>(x, n), p.F) && p.F.allFinite();
  std::copy_n(p.F.data(), n, f);
  return defined ? 0 : 1;
}

int jacobian(void* data, int n, double* x, int want_f, double* f, int* nonzeros, int* column, int* length, int* row,
             double* value) {
  Problem& p = problem(data);
  int undefined = want_f != 0 ? function(data, n, x, f) : 0;
  ++p.J_evals;
  if (!p.mcp.jacobian(Eigen::Map<const Vec>(x, n), p.J)) ++undefined;
  for (int j = 0; j < n; ++j) {
    column[j] = p.J.outerIndexPtr()[j] + 1;
    length[j] = p.J.outerIndexPtr()[j + 1] - p.J.outerIndexPtr()[j];
  }
  *nonzeros = static_cast<int>(p.J.nonZeros());
  for (int k = 0; k < *nonzeros; ++k) {
    row[k] = p.J.innerIndexPtr()[k] + 1;
    value[k] = p.J.valuePtr()[k];
    if (!std::isfinite(value[k])) ++undefined;
  }
  return undefined;
}

void entry_types(void* data, int nonzeros, int* type) {
  const std::vector<bool>& linear = problem(data).linear;
  for (int k = 0; k < nonzeros; ++k) {
    const auto place = static_cast<std::size_t>(k);
    type[k] = place < linear.size() && linear[place] ? PRESOLVE_LINEAR : PRESOLVE_NONLINEAR;
  }
}

const char* status_name(int termination) {
  constexpr std::array names{"?",         "Solved",          "NoProgress",   "MajorLimit",  "MinorLimit",
                             "TimeLimit", "Interrupted",     "BoundError",   "DomainError", "Infeasible",
                             "Error",     "PresolveReduced", "LicenseError", "PresolveOk"};
  return termination > 0 && static_cast<std::size_t>(termination) < names.size()
             ? names[static_cast<std::size_t>(termination)]
             : names[0];
}

void* load(const std::string& path) {
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  return library;
}

template <class Function>
void find(void* library, const char* name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name));
  if (function == nullptr) throw std::runtime_error(dlerror());
}

}  // namespace

std::string library_to_load(const char* built_with) {
  const char* own = std::getenv("PATH_LIBRARY");
  return own != nullptr ? own : built_with;
}

struct PathLibrary::Functions {
  void* stub = nullptr;
  void* library = nullptr;
  decltype(Path_Version)* version = nullptr;
  decltype(Path_CheckLicense)* check_license = nullptr;
  decltype(Path_AddOptions)* add_options = nullptr;
  decltype(Path_Solve)* solve = nullptr;
  decltype(Path_SetProblemClass)* set_class = nullptr;
  decltype(Options_Create)* options_create = nullptr;
  decltype(Options_Destroy)* options_destroy = nullptr;
  decltype(Options_Default)* options_default = nullptr;
  decltype(Options_Set)* options_set = nullptr;
  decltype(MCP_Create)* create = nullptr;
  decltype(MCP_Destroy)* destroy = nullptr;
  decltype(MCP_SetInterface)* set_interface = nullptr;
  decltype(MCP_SetPresolveInterface)* set_presolve = nullptr;
  decltype(MCP_Jacobian_Structure_Constant)* structure_constant = nullptr;
  decltype(MCP_Jacobian_Data_Contiguous)* data_contiguous = nullptr;
  decltype(MCP_GetX)* get_x = nullptr;
  decltype(Output_SetInterface)* set_output = nullptr;
  void (*set_error)(ErrorInterface*) = nullptr;
  bool licensed = false;
  Output_Interface output{nullptr, print_nothing, nullptr};
  ErrorInterface error{nullptr, on_error, on_warning};

  /// Path_Solve; false where it met a fatal error.
  bool run(MCP* mcp, Information& information, MCP_Termination& termination) const {
    if (setjmp(fatal.back) != 0) return false;  // NOLINT(cert-err52-cpp)
    termination = solve(mcp, &information);
    return true;
  }
};

PathLibrary::PathLibrary(const std::string& library, const std::string& stub) : path_(std::make_unique<Functions>()) {
  Functions& path = *path_;
  if (!stub.empty()) path.stub = load(stub);
  path.library = load(library);
  find(path.library, "Path_Version", path.version);
  find(path.library, "Path_CheckLicense", path.check_license);
  find(path.library, "Path_AddOptions", path.add_options);
  find(path.library, "Path_Solve", path.solve);
  find(path.library, "Path_SetProblemClass", path.set_class);
  find(path.library, "Options_Create", path.options_create);
  find(path.library, "Options_Destroy", path.options_destroy);
  find(path.library, "Options_Default", path.options_default);
  find(path.library, "Options_Set", path.options_set);
  find(path.library, "MCP_Create", path.create);
  find(path.library, "MCP_Destroy", path.destroy);
  find(path.library, "MCP_SetInterface", path.set_interface);
  find(path.library, "MCP_SetPresolveInterface", path.set_presolve);
  find(path.library, "MCP_Jacobian_Structure_Constant", path.structure_constant);
  find(path.library, "MCP_Jacobian_Data_Contiguous", path.data_contiguous);
  find(path.library, "MCP_GetX", path.get_x);
  find(path.library, "Output_SetInterface", path.set_output);
  find(path.library, "Error_SetInterface", path.set_error);
  path.set_output(&path.output);
  path.set_error(&path.error);
  if (const char* licence = std::getenv("PATH_LICENSE_STRING")) {
    int (*set_licence)(const char*) = nullptr;  // no header declares it
    find(path.library, "License_SetString", set_licence);
    set_licence(licence);
    path.licensed = true;
  }
}

PathLibrary::~PathLibrary() = default;  // the libraries stay loaded: PATH does not expect to be unloaded

std::string PathLibrary::version() const { return path_->version(); }

bool PathLibrary::takes(ncp::Index n, ncp::Index nonzeros) const {
  return (path_->licensed || (n <= 300 && nonzeros <= 2000)) &&
         path_->check_license(static_cast<int>(n), static_cast<int>(nonzeros)) != 0;
}

PathAnswer PathLibrary::solve(const ncp::Mcp& mcp, ncp::In x0, const PathOptions& options) const {
  const auto begin = std::chrono::steady_clock::now();
  const Functions& path = *path_;
  const Vec start = x0;
  Problem p{mcp, start, mcp.jacobian_pattern(), mcp.linear_entries(), Vec::Zero(mcp.size())};

  Options_Interface* settings = path.options_create();
  path.add_options(settings);
  path.options_default(settings);
  for (const auto& [name, value] : options) {
    std::string setting = name;
    setting.append(" ").append(value);
    if (path.options_set(settings, setting.c_str()) != 0)
      throw std::runtime_error("PATH refuses the option " + setting);
  }

  MCP_Interface callbacks{};
  callbacks.interface_data = &p;
  callbacks.problem_size = problem_size;
  callbacks.bounds = bounds;
  callbacks.function_evaluation = function;
  callbacks.jacobian_evaluation = jacobian;
  Presolve_Interface presolve{};
  presolve.presolve_data = &p;
  presolve.jac_typ = entry_types;
  MCP* problem = path.create(static_cast<int>(mcp.size()), static_cast<int>(p.J.nonZeros()) + 1);
  path.set_interface(problem, &callbacks);
  path.structure_constant(problem, 1);
  path.data_contiguous(problem, 1);
  if (!p.linear.empty()) path.set_presolve(problem, &presolve);
  if (mcp.is_affine()) path.set_class(problem, MCP_LCP);

  Information information{};
  information.use_start = 1;
  MCP_Termination termination = MCP_Error;
  if (!path.run(problem, information, termination))
    throw std::runtime_error(std::string("PATH: ") + fatal.message.data());

  PathAnswer answer;
  answer.claimed = termination == MCP_Solved;
  answer.status = status_name(termination);
  answer.x = Eigen::Map<const Vec>(path.get_x(problem), mcp.size());
  answer.majors = information.major_iterations;
  answer.minors = information.minor_iterations;
  answer.crash = information.crash_iterations;
  answer.gradient_steps = information.gradient_steps;
  answer.restarts = information.restarts;
  answer.F_evals = p.F_evals;
  answer.J_evals = p.J_evals;
  path.destroy(problem);
  path.options_destroy(settings);
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return answer;
}

}  // namespace perp::bench
