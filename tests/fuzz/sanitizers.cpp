// SPDX-License-Identifier: Apache-2.0
/// What the sanitizers, where there are any, are told of every target. An allocation beyond 32 MB fails as if memory
/// had run out: inputs are of a few kB, so that only sizes they announce and nobody checked can ask for more; and
/// zeroing large vectors would take the time of thousands of inputs. Stacks of allocations are short, which is a sixth
/// faster; repeat a finding with ASAN_OPTIONS=malloc_context_size=30.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "allocator_may_return_null=1:max_allocation_size_mb=32:quarantine_size_mb=16:malloc_context_size=3";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1"; }
