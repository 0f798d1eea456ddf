// SPDX-License-Identifier: Apache-2.0
#include "ncp/ampl/asl_problem.hpp"

#include <cerrno>
#include <cfenv>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <new>
#ifdef __x86_64__
#include <xmmintrin.h>
#endif

#include "ncp/ampl/memory_stream.hpp"
#include "ncp/ampl/model.hpp"

// Last: it defines macros with everyday names.
#include <asl.h>
#undef n_con
#undef n_cc
#undef n_obj
#undef n_var

namespace perp::ncp::ampl {
namespace {

std::mutex& library_lock() {
  static constinit std::mutex lock;  // the one guard of the library's globals
  return lock;
}

/// The floating-point environment of a call: no traps during it, and afterwards what it was (the library's start also
/// sets the x87 precision).
class WholeEnvironment {
 public:
  WholeEnvironment() { std::feholdexcept(&environment_); }
  WholeEnvironment(const WholeEnvironment&) = delete;
  WholeEnvironment& operator=(const WholeEnvironment&) = delete;
  ~WholeEnvironment() { std::fesetenv(&environment_); }

 private:
  std::fenv_t environment_{};
};

/// The same of a call that only computes with doubles. The x87 part of the whole takes longer than a small problem.
#ifdef __x86_64__
class EnvironmentOfDoubles {
 public:
  EnvironmentOfDoubles() : control_(_mm_getcsr()) {
    _mm_setcsr((control_ | _MM_MASK_MASK) & ~static_cast<unsigned>(_MM_EXCEPT_MASK));
  }
  EnvironmentOfDoubles(const EnvironmentOfDoubles&) = delete;
  EnvironmentOfDoubles& operator=(const EnvironmentOfDoubles&) = delete;
  ~EnvironmentOfDoubles() { _mm_setcsr(control_); }

 private:
  unsigned control_;
};
#else
using EnvironmentOfDoubles = WholeEnvironment;
#endif

/// For the length of a call: the lock, the library's globals, errno and the floating-point environment.
template <class Environment = WholeEnvironment>
class LibraryCall {
 public:
  LibraryCall(ASL* asl, std::FILE* messages)
      : guard_(library_lock()), errno_(errno), cur_asl_(cur_ASL), stderr_(Stderr) {
    if (asl != nullptr) cur_ASL = asl;
    Stderr = messages;
  }
  LibraryCall(const LibraryCall&) = delete;
  LibraryCall& operator=(const LibraryCall&) = delete;
  ~LibraryCall() {
    cur_ASL = cur_asl_;
    Stderr = stderr_ != nullptr ? stderr_ : stderr;
    errno = errno_;
  }

 private:
  std::lock_guard<std::mutex> guard_;
  Environment environment_{};
  int errno_;
  ASL* cur_asl_;
  std::FILE* stderr_;
};

// The functions below call the library with its error jump set. A jump passes over their frames, which therefore hold
// nothing that has a destructor.

std::FILE* open_guarded(ASL* asl, const char* stub) {
  Jmp_buf jump;
  asl->i.return_nofile_ = 1;
  asl->i.err_jmp_ = &jump;
  std::FILE* nl = nullptr;
  if (setjmp(jump.jb) == 0) nl = jac0dim_ASL(asl, const_cast<char*>(stub), 0);
  asl->i.err_jmp_ = nullptr;
  return nl;
}

bool read_guarded(ASL* asl, std::FILE* body) {
  Jmp_buf jump;
  asl->i.err_jmp_ = &jump;
  const int outcome = setjmp(jump.jb) == 0 ? fg_read_ASL(asl, body, ASL_no_linear_cc_rhs_adjust) : -1;
  asl->i.err_jmp_ = nullptr;
  return outcome == 0;
}

// After an error the library takes the same x for one whose defined variables it already knows; it does not.
void forget_x(ASL* asl) {
  asl->i.x0kind_ = ASL_first_x;
  asl->i.cv_index_ = 0;
  asl->i.x_known = 0;
}

template <class Call>
bool evaluate_guarded(ASL* asl, Call call) {
  Jmp_buf jump;
  asl->i.err_jmp1_ = &jump;  // for errors outside the library's own handling
  volatile fint error = 1;
  if (setjmp(jump.jb) == 0) {
    fint raised = 0;
    call(&raised);
    error = raised;
  }
  asl->i.err_jmp1_ = nullptr;
  asl->i.err_jmp_ = nullptr;
  return error == 0;
}

}  // namespace

struct AslProblem::State {
  explicit State(const Sizes& s) : sizes(s) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    const LibraryCall<> call(nullptr, messages.stream());
    ASL_free(&asl);
  }
  Messages messages;
  ASL* asl = nullptr;
  Sizes sizes;
};

AslProblem::AslProblem(const std::string& stub, std::string_view body, const Sizes& sizes)
    : state_(std::make_unique<State>(sizes)) {
  const auto refuse = [&](const std::string& why) {
    const std::string said = state_->messages.text();
    throw ModelError(bad_file, stub + ".nl: " + why + (said.empty() ? "" : ": " + said));
  };
  const LibraryCall<> call(nullptr, state_->messages.stream());
  ASL* asl = ASL_alloc(ASL_read_fg);
  if (asl == nullptr) throw std::bad_alloc();
  state_->asl = asl;
  asl->p.need_funcadd_ = 0;  // load no libraries of functions
  std::FILE* header = open_guarded(asl, stub.c_str());
  if (header == nullptr) refuse("AMPL's library cannot read the header");
  std::fclose(header);
  const Edaginfo& i = asl->i;
  if (i.n_var_ != sizes.n_var || i.n_con_ != sizes.n_con || i.n_obj_ != sizes.n_obj || i.n_cc_ != sizes.n_cc ||
      static_cast<int>(i.nZc_) != sizes.nonzeros || i.n_lcon_ != 0 || i.nfunc_ != 0 ||
      i.comb_ + i.comc_ + i.como_ + i.comc1_ + i.como1_ != sizes.defined || (i.binary_nl_ != 0) != sizes.binary)
    refuse("the file changed while it was being read");
  // The library looks for changes of x among the variables, and for errors of derivatives among the rows, that the
  // header calls nonlinear; it would trust a header that forgot some.
  asl->i.nlc_ = i.n_con_;
  asl->i.x0len_ = static_cast<std::size_t>(i.n_var_) * sizeof(real);
  asl->i.congrd_mode = 2;

  std::FILE* segments = stream_of(body);
  const bool read = read_guarded(asl, segments);
  if (!read) {
    std::fclose(segments);  // the library closes it only where all went well
    refuse("AMPL's library cannot read the file");
  }
}

AslProblem::~AslProblem() = default;

bool AslProblem::values(const double* x, double* c) const {
  ASL* asl = state_->asl;
  const LibraryCall<EnvironmentOfDoubles> call(asl, state_->messages.stream());
  const bool defined =
      evaluate_guarded(asl, [=](fint* error) { asl->p.Conval(asl, const_cast<double*>(x), c, error); });
  if (!defined) forget_x(asl);
  return defined;
}

bool AslProblem::jacobian(const double* x, double* nonzeros) const {
  ASL* asl = state_->asl;
  const LibraryCall<EnvironmentOfDoubles> call(asl, state_->messages.stream());
  const bool defined =
      evaluate_guarded(asl, [=](fint* error) { asl->p.Jacval(asl, const_cast<double*>(x), nonzeros, error); });
  if (!defined) forget_x(asl);
  return defined;
}

AslProblem::RowByRow AslProblem::values_by_row(const double* x, double* c) const {
  ASL* asl = state_->asl;
  const LibraryCall<> call(asl, state_->messages.stream());
  RowByRow result;
  result.defined.assign(static_cast<std::size_t>(state_->sizes.n_con), 0);
  result.overflow = result.defined;
  auto* point = const_cast<double*>(x);
  forget_x(asl);
  // The library says that there is no value, the processor why; WebAssembly keeps no flags.
#ifdef FE_OVERFLOW
  const auto overflowed = [] { return std::fetestexcept(FE_OVERFLOW | FE_INVALID | FE_DIVBYZERO) == FE_OVERFLOW; };
#else
  const auto overflowed = [] { return false; };
#endif
  std::feclearexcept(FE_ALL_EXCEPT);
  // Known once, so that the rows need not compare x.
  evaluate_guarded(asl, [=](fint* error) { asl->p.Xknown(asl, point, error); });
  for (int i = 0; i < state_->sizes.n_con && asl->i.cv_index_ == 0; ++i) {
    std::feclearexcept(FE_ALL_EXCEPT);
    const bool fine = evaluate_guarded(asl, [=](fint* error) { c[i] = asl->p.Conival(asl, i, point, error); });
    result.defined[static_cast<std::size_t>(i)] = fine ? 1 : 0;
    result.overflow[static_cast<std::size_t>(i)] = !fine && overflowed() ? 1 : 0;
  }
  if (const int index = asl->i.cv_index_; index > 0) {
    // Counted from 1; the library adds the number of shared ones twice to those of a single row.
    const int shared = asl->i.ncom0_;
    result.definition = index > shared ? index - shared - 1 : index - 1;
    result.evaluated = false;
    result.definition_overflow = overflowed();
  }
  forget_x(asl);
  return result;
}

bool AslProblem::jacobian_of(const std::vector<char>& rows, const double* x, double* nonzeros) const {
  ASL* asl = state_->asl;
  const LibraryCall<> call(asl, state_->messages.stream());
  auto* point = const_cast<double*>(x);
  forget_x(asl);
  bool defined = evaluate_guarded(asl, [=](fint* error) { asl->p.Xknown(asl, point, error); });
  for (int i = 0; i < state_->sizes.n_con && defined; ++i) {
    if (rows[static_cast<std::size_t>(i)])
      defined = evaluate_guarded(asl, [=](fint* error) { asl->p.Congrd(asl, i, point, nonzeros, error); });
  }
  forget_x(asl);
  return defined;
}

}  // namespace perp::ncp::ampl
