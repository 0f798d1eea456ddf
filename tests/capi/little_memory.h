// SPDX-License-Identifier: Apache-2.0
/* A limit on what the program may take. Before it: #define _POSIX_C_SOURCE 200809L. */
#ifndef PERP_TESTS_LITTLE_MEMORY_H
#define PERP_TESTS_LITTLE_MEMORY_H

#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

/* 4 GB of address space more than there are, until setrlimit(RLIMIT_AS, before). 0: sanitizers need all of it. */
static int limit_memory(struct rlimit* before) {
  struct rlimit limit;
  long pages = 0;
  FILE* file = fopen("/proc/self/statm", "r");
  getrlimit(RLIMIT_AS, before);
  if (file == NULL) return 0;
  if (fscanf(file, "%ld", &pages) != 1) pages = 0;
  fclose(file);
#ifdef __SANITIZE_ADDRESS__
  pages = 0;
#endif
  if (pages == 0) return 0;
  limit = *before;
  limit.rlim_cur = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)4 << 30);
  return setrlimit(RLIMIT_AS, &limit) == 0;
}

#endif
