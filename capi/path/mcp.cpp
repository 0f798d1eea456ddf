// SPDX-License-Identifier: Apache-2.0
#include "capi/path/mcp.hpp"

#include <new>

namespace {

template <class T>
T* first(std::vector<T>& values) {
  return values.empty() ? nullptr : values.data();
}

template <class T>
void put(T* place, T value) {
  if (place != nullptr) *place = value;
}

}  // namespace

MCP* MCP_Create(int /*n*/, int /*nonzeros*/) { return new (std::nothrow) MCP; }
void MCP_Destroy(MCP* m) { delete m; }
void MCP_Size(MCP* /*m*/, int /*n*/, int /*nonzeros*/) {}

void MCP_SetInterface(MCP* m, MCP_Interface* i) {
  if (m != nullptr) m->client = i == nullptr ? MCP_Interface{} : *i;
}
void MCP_SetPresolveInterface(MCP* m, Presolve_Interface* i) {
  if (m == nullptr) return;
  m->has_presolve = i != nullptr;
  m->presolve = i == nullptr ? Presolve_Interface{} : *i;
}
void MCP_Jacobian_Structure_Constant(MCP* /*m*/, int /*yes*/) {}
void MCP_Jacobian_Data_Contiguous(MCP* /*m*/, int /*yes*/) {}
void MCP_Jacobian_Diagonal(MCP* /*m*/, int /*yes*/) {}
void MCP_Jacobian_Diagonal_First(MCP* /*m*/, int /*yes*/) {}

double* MCP_GetX(MCP* m) { return m == nullptr ? nullptr : first(m->x); }
double* MCP_GetL(MCP* m) { return m == nullptr ? nullptr : first(m->lower); }
double* MCP_GetU(MCP* m) { return m == nullptr ? nullptr : first(m->upper); }
double* MCP_GetF(MCP* m) { return m == nullptr ? nullptr : first(m->F); }
int* MCP_GetB(MCP* m) { return m == nullptr ? nullptr : first(m->basis); }
void MCP_GetJ(MCP* m, int* nonzeros, int** col, int** len, int** row, double** data) {
  if (m == nullptr) return;
  put(nonzeros, m->jacobian.nonzeros());
  put(col, m->jacobian.col());
  put(len, m->jacobian.len());
  put(row, m->jacobian.client_row());
  put(data, m->jacobian.data());
}

void Path_SetProblemClass(MCP* m, MCP_Type type) {
  if (m != nullptr) m->affine = type == MCP_LCP || type == MCP_QP || type == MCP_LP;
}
