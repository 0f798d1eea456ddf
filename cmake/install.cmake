# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts into the prefix: the public headers, the libraries (perp_library), the package for
# find_package(perp CONFIG) and perp.pc for pkg-config. The program installs itself (app/).
include(CMakePackageConfigHelpers)

# The public headers: these, and what they include. Those left are the folders' own.
set(perp_public_headers
  contact/laws/affine_encoding.hpp
  contact/classics/alart_curnier.hpp
  contact/io/dat_file.hpp
  contact/existence/existence.hpp
  contact/model/facts.hpp
  contact/io/fclib.hpp
  contact/laws/first_ncp.hpp
  contact/laws/frictionless.hpp
  contact/classics/gauss_seidel.hpp
  contact/scenes/generators.hpp
  contact/laws/glocker.hpp
  contact/solvers/homotopy.hpp
  contact/existence/infeasible.hpp
  contact/laws/inner_faceting.hpp
  contact/scenes/moreau_jean.hpp
  contact/solvers/nonlinear.hpp
  contact/laws/outer_faceting.hpp
  contact/scenes/pendulum_chain.hpp
  contact/laws/polygon.hpp
  contact/model/problem.hpp
  contact/io/read.hpp
  contact/model/residual.hpp
  contact/scenes/elastic_rod.hpp
  contact/solvers/sensitivity.hpp
  contact/solvers/sequence.hpp
  contact/scenes/shaken_scene.hpp
  contact/scenes/rigid_bodies.hpp
  contact/solvers/run.hpp
  contact/model/scaling.hpp
  contact/solvers/solve.hpp
  contact/model/units.hpp
  contact/solvers/variant.hpp
  lcp/linalg/block_triangular.hpp
  lcp/linalg/blocks.hpp
  lcp/cholesky/cholesky.hpp
  lcp/classes/classify.hpp
  lcp/solve/dense.hpp
  lcp/vi/vi.hpp
  lcp/vi/batch.hpp
  lcp/io/matrix_market.hpp
  lcp/io/output_file.hpp
  lcp/io/siconos_file.hpp
  ncp/problem/affine.hpp
  ncp/problem/autodiff.hpp
  ncp/ampl/model.hpp
  ncp/ampl/nl_writer.hpp
  collection/collection.hpp
  collection/scalable/generators.hpp
  ncp/strategy/deflation.hpp
  ncp/strategy/kept.hpp
  ncp/strategy/vi.hpp
  ncp/interval/enclosure.hpp
  ncp/analysis/function_classes.hpp
  ncp/analysis/no_solution.hpp
  ncp/analysis/verify.hpp
  ncp/explain/explain.hpp
  ncp/path/pivot_limit.hpp
  ncp/strategy/presets.hpp
  ncp/transforms/presolve.hpp
  ncp/transforms/scaling.hpp
  ncp/analysis/sensitivity.hpp
  ncp/analysis/structure_report.hpp)
set(perp_unread_headers ${perp_public_headers})
while(perp_unread_headers)
  list(POP_FRONT perp_unread_headers header)
  file(STRINGS ${PROJECT_SOURCE_DIR}/${header} includes REGEX "^#include \"(collection|contact|lcp|ncp)/")
  list(TRANSFORM includes REPLACE "^#include \"([^\"]+)\".*" "\\1")
  list(REMOVE_ITEM includes ${perp_public_headers})
  list(APPEND perp_public_headers ${includes})
  list(APPEND perp_unread_headers ${includes})
endwhile()
# A header answers to its name without the folder, too: who includes "ncp/solve.hpp" need not know where it lies, nor
# notice when it moves.
foreach(header IN LISTS perp_public_headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/perp/${folder})
  if(header MATCHES "^ncp/ampl/[a-z_]+[.]hpp$")  # these have had no other name
    continue()
  endif()
  string(REGEX REPLACE "^(lcp|collection|ncp|contact)/[a-z]+/([a-z_]+[.]hpp)$" "\\1/\\2" name ${header})
  if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${name})
    file(CONFIGURE OUTPUT ${perp_short_names}/${name} CONTENT "#pragma once\n#include \"${header}\"\n" @ONLY)
    cmake_path(GET name PARENT_PATH folder)
    install(FILES ${perp_short_names}/${name} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/perp/${folder})
  endif()
endforeach()

set(perp_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/perp)
install(EXPORT perpTargets NAMESPACE perp:: DESTINATION ${perp_package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/perpConfig.cmake.in ${PROJECT_BINARY_DIR}/perpConfig.cmake
  INSTALL_DESTINATION ${perp_package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/perpConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/perpConfig.cmake ${PROJECT_BINARY_DIR}/perpConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindSuiteSparse.cmake ${CMAKE_CURRENT_LIST_DIR}/FindASL.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindMPFI.cmake
  DESTINATION ${perp_package_dir})

# pkg-config. Whoever links static libraries links what they use as well, hence Libs and not Libs.private.
function(perp_link_flags out)
  set(flags)
  foreach(library IN LISTS ARGN)
    cmake_path(GET library PARENT_PATH folder)
    if(NOT folder IN_LIST CMAKE_CXX_IMPLICIT_LINK_DIRECTORIES)
      list(APPEND flags -L${folder})
    endif()
    cmake_path(GET library STEM name)
    string(REGEX REPLACE "^lib" "-l" flag ${name})
    list(APPEND flags ${flag})
  endforeach()
  list(JOIN flags " " flags)
  set(${out} ${flags} PARENT_SCOPE)
endfunction()
list(TRANSFORM perp_suitesparse REPLACE "(.+)" "SuiteSparse_\\1_LIBRARY" OUTPUT_VARIABLE perp_pc_libraries)
if(PERP_GPL)
  list(APPEND perp_pc_libraries GSL_LIBRARY GSL_CBLAS_LIBRARY)
endif()
set(perp_pc_paths)
foreach(library IN LISTS perp_pc_libraries)
  list(APPEND perp_pc_paths ${${library}})
endforeach()
perp_link_flags(perp_pc_dependencies ${ASL_LIBRARY} ${perp_pc_paths} ${MPFI_LIBRARY} ${MPFI_MPFR_LIBRARY}
  ${MPFI_GMP_LIBRARY})
if(CMAKE_DL_LIBS)
  string(APPEND perp_pc_dependencies " -l${CMAKE_DL_LIBS}")
endif()
if(BUILD_SHARED_LIBS)
  set(perp_pc_libs "")
else()
  set(perp_pc_libs " ${perp_pc_dependencies}")
endif()
cmake_path(IS_ABSOLUTE CMAKE_INSTALL_LIBDIR perp_libdir_is_absolute)
if(perp_libdir_is_absolute)
  set(perp_pc_prefix ${CMAKE_INSTALL_PREFIX})
else()
  # From the folder of perp.pc, so that an installed tree can be moved.
  file(RELATIVE_PATH perp_pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" perp_pc_prefix \${pcfiledir}/${perp_pc_prefix})
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/perp.pc.in ${PROJECT_BINARY_DIR}/perp.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/perp.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
if(TARGET perp_c)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/perp-c.pc.in ${PROJECT_BINARY_DIR}/perp-c.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/perp-c.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

# Shared libraries find each other, and the program finds them, wherever the prefix is.
if(BUILD_SHARED_LIBS)
  file(RELATIVE_PATH perp_bin_to_lib /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(perp_lcp perp_ncp perp_collection perp_contact PROPERTIES INSTALL_RPATH "${perp_origin}")
  if(TARGET perp)
    set_target_properties(perp PROPERTIES INSTALL_RPATH "${perp_origin}/${perp_bin_to_lib}")
  endif()
endif()
