/* SPDX-License-Identifier: Apache-2.0 */
/* Included before each source of AMPL's library, which opens the .nl file: fopen takes its name in UTF-8, as all of
   Perp has it, where Windows' own takes letters of the machine's code page. */
#ifndef PERP_PORTABLE_UTF8_FOPEN_H
#define PERP_PORTABLE_UTF8_FOPEN_H

#include <stdio.h>
#include <stdlib.h>
#include <wchar.h>

__declspec(dllimport) int __stdcall MultiByteToWideChar(unsigned, unsigned long, const char*, int, wchar_t*, int);

static inline FILE* perp_utf8_fopen(const char* name, const char* mode) {
  enum { utf8 = 65001 };
  wchar_t wide_mode[8] = {0};
  const int size = MultiByteToWideChar(utf8, 0, name, -1, NULL, 0);
  wchar_t* wide = (wchar_t*)calloc((size_t)size + 1, sizeof *wide);
  FILE* file = NULL;
  if (wide != NULL && size > 0 && MultiByteToWideChar(utf8, 0, mode, -1, wide_mode, 7) > 0) {
    MultiByteToWideChar(utf8, 0, name, -1, wide, size);
    file = _wfopen(wide, wide_mode);
  }
  free(wide);
  return file;
}
#define fopen perp_utf8_fopen

#endif
