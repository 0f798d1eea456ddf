/* SPDX-License-Identifier: Apache-2.0 */
/* What the C tests ask of POSIX's <dlfcn.h>, by Windows' own words. */
#ifndef PERP_PORTABLE_DLFCN_H
#define PERP_PORTABLE_DLFCN_H

/* Of windows.h, which defines `interface` and other words. */
__declspec(dllimport) void* __stdcall LoadLibraryA(const char*);
__declspec(dllimport) void* __stdcall GetProcAddress(void*, const char*);

enum { RTLD_NOW, RTLD_LOCAL, RTLD_GLOBAL };

static inline void* dlopen(const char* file, int flags) {
  (void)flags;
  return LoadLibraryA(file);
}
static inline void* dlsym(void* library, const char* name) { return GetProcAddress(library, name); }
static inline const char* dlerror(void) { return "the library, or its function, was not found"; }

#endif
