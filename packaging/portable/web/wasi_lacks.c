/* SPDX-License-Identifier: Apache-2.0 */
/* What Perp and its libraries use, and zig has not for WebAssembly. */
#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

/* The tags of what C++ throws and of longjmp, which are compiler-rt's. */
__asm__(
    ".globl __cpp_exception\n"
    ".tagtype __cpp_exception i32\n"
    "__cpp_exception:\n"
    ".globl __c_longjmp\n"
    ".tagtype __c_longjmp i32\n"
    "__c_longjmp:\n");

/* A file without a name. Nobody else is there to take the name it has for a moment. */
FILE* tmpfile(void) {
  static const char name[] = "/tmp/without-a-name";
  const int descriptor = open(name, O_RDWR | O_CREAT | O_EXCL, 0600);
  if (descriptor < 0) return NULL;
  unlink(name);
  return fdopen(descriptor, "w+");
}

/* AMPL's library lends it to imported functions, of which there are none. */
char* tmpnam(char* name) { return NULL; }

/* The one thread ends where the module does, and what it owns with it. */
int __cxa_thread_atexit(void (*destroy)(void*), void* object, void* library) { return 0; }
