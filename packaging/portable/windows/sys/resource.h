/* SPDX-License-Identifier: Apache-2.0 */
/* What the C tests ask of POSIX's <sys/resource.h>: Windows limits no address space, and the tests go without. */
#ifndef PERP_PORTABLE_RESOURCE_H
#define PERP_PORTABLE_RESOURCE_H

typedef unsigned long long rlim_t;
struct rlimit {
  rlim_t rlim_cur, rlim_max;
};
enum { RLIMIT_AS, _SC_PAGESIZE };

static inline int getrlimit(int what, struct rlimit* limit) {
  (void)what;
  limit->rlim_cur = limit->rlim_max = 0;
  return 0;
}
static inline int setrlimit(int what, const struct rlimit* limit) {
  (void)what;
  (void)limit;
  return -1;
}
static inline long sysconf(int what) {
  (void)what;
  return 4096;
}

#endif
