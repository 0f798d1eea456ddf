// SPDX-License-Identifier: Apache-2.0
// What nearly every file includes, compiled once (CMakeLists.txt). Every file still names what it uses.
#include <Eigen/Core>
#include <Eigen/SparseCore>
//
