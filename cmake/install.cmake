# What `cmake --install` puts into the prefix: the public headers, the libraries (perp_library), the package for
# find_package(perp CONFIG) and perp.pc for pkg-config. The program installs itself (app/).
include(CMakePackageConfigHelpers)

# The public headers; those not listed are the folders' own.
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
  lcp/affine_mcp.hpp
  lcp/basis_factor.hpp
  lcp/block_pivoting.hpp
  lcp/blocks.hpp
  lcp/block_triangular.hpp
  lcp/bound_qp.hpp
  lcp/box.hpp
  lcp/cholesky.hpp
  lcp/enumeration.hpp
  lcp/classify.hpp
  lcp/fb_newton.hpp
  lcp/interior_point.hpp
  lcp/infeasible.hpp
  lcp/judge.hpp
  lcp/least_index.hpp
  lcp/lemke.hpp
  lcp/min_newton.hpp
  lcp/projected_sor.hpp
  lcp/mlcp.hpp
  lcp/principal_pivoting.hpp
  lcp/siconos_file.hpp
  lcp/file_error.hpp
  lcp/lemke_howson.hpp
  lcp/matrix_market.hpp
  lcp/output_file.hpp
  lcp/result.hpp
  lcp/solve.hpp
  lcp/kernel_clock.hpp
  lcp/memory.hpp
  lcp/sparse_lu.hpp
  lcp/sparse_vector.hpp
  lcp/structure.hpp
  lcp/types.hpp
  ncp/affine.hpp
  ncp/ampl/model.hpp
  ncp/auto.hpp
  ncp/cfunction.hpp
  ncp/collection/collection.hpp ncp/collection/generators.hpp ncp/collection/random_lcps.hpp
  ncp/deflation.hpp
  ncp/mcp.hpp
  ncp/interior_point.hpp
  ncp/min_newton.hpp
  ncp/multiroot.hpp
  ncp/newton_josephy.hpp
  ncp/newton_robinson.hpp
  ncp/observe.hpp
  ncp/options.hpp
  ncp/path_search.hpp
  ncp/pivot_limit.hpp
  ncp/presets.hpp
  ncp/presolve.hpp
  ncp/residual.hpp
  ncp/result.hpp
  ncp/scaling.hpp
  ncp/semismooth_newton.hpp
  ncp/sensitivity.hpp
  ncp/smoothing.hpp
  ncp/smoothing_function.hpp
  ncp/solve.hpp
  ncp/strategy.hpp
  ncp/structure_report.hpp)
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
