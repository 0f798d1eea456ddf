# SPDX-License-Identifier: Apache-2.0
# Installs the build tree to a temporary prefix, moves it, and builds and runs a project against it: by find_package and
# by pkg-config. Catches headers that are not installed, exports with paths of the build tree, missing link libraries.
#   cmake -DBUILD_DIR= -DSOURCE_DIR= -DWORK_DIR= -DLIBDIR= -DCXX= -DCXX_FLAGS= -P install_and_use.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${status}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# Prefix and project in paths with spaces; the prefix is moved, so nothing in it may know where it was installed.
set(prefix "${WORK_DIR}/pre fix")
set(consumer_build "${WORK_DIR}/consumer build")
set(consumer ${SOURCE_DIR}/tests/packaging/consumer)
set(model ${SOURCE_DIR}/data/models/cournot.nl)
file(REMOVE_RECURSE "${WORK_DIR}")
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix "${WORK_DIR}/first")
file(RENAME "${WORK_DIR}/first" "${prefix}")

if(EXISTS "${prefix}/bin/perp" AND NOT EXISTS "${prefix}/share/perp/schema/solve.json")
  message(FATAL_ERROR "the schemas are not installed")
endif()

# The headers that docs/stable.md promises.
file(READ ${SOURCE_DIR}/docs/stable.md page)
string(REGEX MATCHALL "`(lcp|ncp|collection|contact)/[a-z_/]+[.]hpp`" headers "${page}")
list(LENGTH headers promised)
if(promised LESS 20)
  message(FATAL_ERROR "docs/stable.md names ${promised} headers")
endif()
foreach(header IN LISTS headers)
  string(REPLACE "`" "" header ${header})
  if(NOT EXISTS "${prefix}/include/perp/${header}")
    message(FATAL_ERROR "docs/stable.md promises ${header}, which is not installed")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${consumer} -B "${consumer_build}" -G Ninja -DCMAKE_BUILD_TYPE=Debug
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})
run(${CMAKE_COMMAND} --build "${consumer_build}")
run("${consumer_build}/example")
if(NOT output MATCHES "x = 0.618034 +1.61803")  # x2 = x1 + 1, the golden ratio
  message(FATAL_ERROR "the example printed:\n${output}")
endif()
run("${consumer_build}/lcp")
if(NOT output MATCHES "z = 1.33333 +2.33333")  # 2 z1 + z2 = 5, z1 + 2 z2 = 6
  message(FATAL_ERROR "the LCP printed:\n${output}")
endif()
if(EXISTS "${consumer_build}/from_c")
  run("${consumer_build}/from_c")
  if(NOT output MATCHES "^Solved: .*x = 0.618034 1.61803")
    message(FATAL_ERROR "the example in C printed:\n${output}")
  endif()
endif()
run("${consumer_build}/parts" ${model})
if(NOT output MATCHES "output.hydro. 18")
  message(FATAL_ERROR "the model's solution is:\n${output}")
endif()
run("${consumer_build}/contact" ${SOURCE_DIR}/data/contact/arch-9.hdf5 glocker+path)
if(NOT output MATCHES "^Solved [0-9.]+e-(0[89]|1[0-9])\n$")
  message(FATAL_ERROR "the contact problem's answer is:\n${output}")
endif()
foreach(problem chain:glocker rod:coulomb+alart-curnier)
  string(REPLACE ":" ";" problem ${problem})
  run("${consumer_build}/nonlinear" ${problem})
  if(NOT output MATCHES "\n[0-9]+ (0|[0-9.]+e-[12][0-9]) (0|[0-9.]+e-[12][0-9]) 1\n$")  # both residuals of the last step, a whole one
    message(FATAL_ERROR "Newton's steps of ${problem} are:\n${output}")
  endif()
endforeach()

# The version asked for must be one with the same interface.
file(WRITE "${WORK_DIR}/next/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)\nproject(next LANGUAGES CXX)\n"
  "foreach(version IN ITEMS 0.1 1.99 2.0)\n  find_package(perp \${version} CONFIG QUIET)\n"
  "  if(perp_FOUND)\n    message(FATAL_ERROR \"\${version} was accepted\")\n  endif()\nendforeach()\n")
run(${CMAKE_COMMAND} -S "${WORK_DIR}/next" -B "${WORK_DIR}/next/build" -G Ninja -DCMAKE_PREFIX_PATH=${prefix}
  -DCMAKE_CXX_COMPILER=${CXX})

find_program(PKG_CONFIG pkg-config)
if(NOT PKG_CONFIG)
  message("pkg-config is not installed: perp.pc was not tried")
  return()
endif()
set(ENV{PKG_CONFIG_PATH} "${prefix}/${LIBDIR}/pkgconfig")
run(${PKG_CONFIG} --cflags --libs perp)
separate_arguments(flags UNIX_COMMAND "${output}")
separate_arguments(cxx_flags UNIX_COMMAND "${CXX_FLAGS}")
run(${CXX} ${cxx_flags} -std=c++20 ${consumer}/parts.cpp -o "${WORK_DIR}/by pkg-config" ${flags}
  "-Wl,-rpath,${prefix}/${LIBDIR}")
run("${WORK_DIR}/by pkg-config" ${model})
if(NOT output MATCHES "output.hydro. 18")
  message(FATAL_ERROR "the model's solution is:\n${output}")
endif()
if(EXISTS "${prefix}/${LIBDIR}/libperp.so")
  run(${PKG_CONFIG} --cflags --libs perp-c)
  separate_arguments(flags UNIX_COMMAND "${output}")
  run(${CXX} -x c -std=c99 ${consumer}/from_c.c -x none -o "${WORK_DIR}/c by pkg-config" ${flags} ${cxx_flags}
    "-Wl,-rpath,${prefix}/${LIBDIR}")
  run("${WORK_DIR}/c by pkg-config")
  if(NOT output MATCHES "x = 0.618034 1.61803")
    message(FATAL_ERROR "the example in C printed:\n${output}")
  endif()
endif()
file(REMOVE_RECURSE "${WORK_DIR}")
