# What `cmake --install` puts into the prefix: the public headers, the libraries (perp_library), the package for
# find_package(perp CONFIG) and perp.pc for pkg-config. The program installs itself (app/).
include(CMakePackageConfigHelpers)

# The public headers: these, and what they include. Those left are the folders' own.
set(perp_public_headers
  contact/affine_encoding.hpp
  contact/alart_curnier.hpp
  contact/ball.hpp
  contact/bilateral.hpp
  contact/dat_file.hpp
  contact/existence.hpp
  contact/facts.hpp
  contact/fclib.hpp
  contact/first_ncp.hpp
  contact/frictionless.hpp
  contact/gauss_seidel.hpp
  contact/generators.hpp
  contact/glocker.hpp
  contact/homotopy.hpp
  contact/infeasible.hpp
  contact/inner_faceting.hpp
  contact/moreau_jean.hpp
  contact/outer_faceting.hpp
  contact/polygon.hpp
  contact/problem.hpp
  contact/read.hpp
  contact/residual.hpp
  contact/rigid_bodies.hpp
  contact/run.hpp
  contact/scaling.hpp
  contact/solve.hpp
  contact/units.hpp
  contact/variant.hpp
  lcp/block_triangular.hpp
  lcp/blocks.hpp
  lcp/cholesky.hpp
  lcp/classify.hpp
  lcp/matrix_market.hpp
  lcp/output_file.hpp
  lcp/siconos_file.hpp
  ncp/affine.hpp
  ncp/ampl/model.hpp
  ncp/collection/generators.hpp
  ncp/deflation.hpp
  ncp/pivot_limit.hpp
  ncp/presets.hpp
  ncp/presolve.hpp
  ncp/scaling.hpp
  ncp/sensitivity.hpp
  ncp/structure_report.hpp)
set(perp_unread_headers ${perp_public_headers})
while(perp_unread_headers)
  list(POP_FRONT perp_unread_headers header)
  file(STRINGS ${PROJECT_SOURCE_DIR}/${header} includes REGEX "^#include \"(contact|lcp|ncp)/")
  list(TRANSFORM includes REPLACE "^#include \"([^\"]+)\".*" "\\1")
  list(REMOVE_ITEM includes ${perp_public_headers})
  list(APPEND perp_public_headers ${includes})
  list(APPEND perp_unread_headers ${includes})
endwhile()
foreach(header IN LISTS perp_public_headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/perp/${folder})
endforeach()

set(perp_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/perp)
install(EXPORT perpTargets NAMESPACE perp:: DESTINATION ${perp_package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/perpConfig.cmake.in ${PROJECT_BINARY_DIR}/perpConfig.cmake
  INSTALL_DESTINATION ${perp_package_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the interface.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(perp_compatibility SameMinorVersion)
else()
  set(perp_compatibility SameMajorVersion)
endif()
write_basic_package_version_file(${PROJECT_BINARY_DIR}/perpConfigVersion.cmake COMPATIBILITY ${perp_compatibility})
install(FILES ${PROJECT_BINARY_DIR}/perpConfig.cmake ${PROJECT_BINARY_DIR}/perpConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindSuiteSparse.cmake ${CMAKE_CURRENT_LIST_DIR}/FindASL.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindHDF5Serial.cmake
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
perp_link_flags(perp_pc_dependencies ${ASL_LIBRARY} ${SuiteSparse_UMFPACK_LIBRARY} ${SuiteSparse_KLU_LIBRARY}
  ${SuiteSparse_CHOLMOD_LIBRARY} ${GSL_LIBRARY} ${GSL_CBLAS_LIBRARY} ${HDF5Serial_LIBRARY})
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

# Shared libraries find each other, and the program finds them, wherever the prefix is.
if(BUILD_SHARED_LIBS)
  file(RELATIVE_PATH perp_bin_to_lib /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(perp_lcp perp_ncp perp_collection perp_contact PROPERTIES INSTALL_RPATH "$ORIGIN")
  if(TARGET perp)
    set_target_properties(perp PROPERTIES INSTALL_RPATH "$ORIGIN/${perp_bin_to_lib}")
  endif()
endif()
