// SPDX-License-Identifier: Apache-2.0
/// Licences, of which none is needed; and the workspace, of which there is none.
#include <climits>
#include <cstring>
#include <string>

#include "capi/path/perp_path.h"
#include "capi/perp.h"

namespace {

constexpr int valid = 0;
constexpr int unreadable = 4;  // PATH's number for a string that it cannot parse

/// The last day there is.
int date(int* day, int* month, int* year) {
  if (day != nullptr) *day = 31;
  if (month != nullptr) *month = 12;
  if (year != nullptr) *year = 9999;
  return valid;
}

int nothing(char* text, int size) {
  if (text != nullptr && size > 0) *text = '\0';
  return valid;
}

int unlimited(int* n, int* nonzeros) {
  if (n != nullptr) *n = INT_MAX;
  if (nonzeros != nullptr) *nonzeros = INT_MAX;
  return valid;
}

}  // namespace

int License_SetString(const char* licence) {
  return licence != nullptr && std::strcmp(licence, "bad_license") == 0 ? unreadable : valid;
}
int Path_CheckLicense(int /*n*/, int /*nonzeros*/) { return 1; }
int License_GetAlgorithms(char* text, int size) { return nothing(text, size); }
int License_GetArchitectures(char* text, int size) { return nothing(text, size); }
int License_GetExpiration(int* day, int* month, int* year) { return date(day, month, year); }
int License_GetMaxVersion(int* version) { return unlimited(version, nullptr); }
int License_GetMaxBuild(int* day, int* month, int* year) { return date(day, month, year); }
int License_GetRestrictions(int* n, int* nonzeros) { return unlimited(n, nonzeros); }
int License_GetDemoRestrictions(int* n, int* nonzeros) { return unlimited(n, nonzeros); }
int License_GetTermination(void) { return valid; }
int License_GetDemoTermination(void) { return valid; }

const char* Path_Version(void) { return PERP_PATH_VERSION; }
void Path_Create(int /*n*/, int /*nonzeros*/) {}
void Path_Size(int /*n*/, int /*nonzeros*/) {}
void Path_Reference(void) {}
void Path_Destroy(void) {}
