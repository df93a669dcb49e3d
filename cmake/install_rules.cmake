# install(): headers, the exported target, the package files for find_package(tactoid), and tactoid.pc for pkg-config.
include_guard()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(downloaded ${tactoid_fetched})
list(FILTER downloaded INCLUDE REGEX "^(Eigen3|nanoflann|fmt)$")
if(downloaded)
  list(JOIN downloaded ", " downloaded)
  message(STATUS "tactoid: no install target, because ${downloaded} came by download and is not installed itself")
  return()
endif()

set(tactoid_package_dir "${CMAKE_INSTALL_DATADIR}/cmake/tactoid")
install(
  TARGETS tactoid tactoid_precompiled
  EXPORT tactoidTargets
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILE_SET definitions DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILE_SET with_hdf5 DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILE_SET with_zlib DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILE_SET with_mpi DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
if(TACTOID_WITH_MPI)
  install(TARGETS tactoid_mpi EXPORT tactoidMpiTargets FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
  install(EXPORT tactoidMpiTargets NAMESPACE tactoid:: DESTINATION "${tactoid_package_dir}")
  install(FILES "${CMAKE_CURRENT_LIST_DIR}/FindMETIS.cmake" DESTINATION "${tactoid_package_dir}")
endif()
if(TACTOID_HAVE_SUITESPARSE)
  install(TARGETS tactoid_suitesparse EXPORT tactoidSuiteSparseTargets)
  install(EXPORT tactoidSuiteSparseTargets NAMESPACE tactoid:: DESTINATION "${tactoid_package_dir}")
  install(FILES "${CMAKE_CURRENT_LIST_DIR}/FindSuiteSparse.cmake" DESTINATION "${tactoid_package_dir}")
endif()
install(FILES "${CMAKE_CURRENT_LIST_DIR}/compiled.cmake" DESTINATION "${tactoid_package_dir}")
install(
  EXPORT tactoidTargets
  NAMESPACE tactoid::
  DESTINATION "${tactoid_package_dir}")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/tactoidConfig.cmake.in"
                              "${CMAKE_CURRENT_BINARY_DIR}/tactoidConfig.cmake"
                              INSTALL_DESTINATION "${tactoid_package_dir}" PATH_VARS CMAKE_INSTALL_INCLUDEDIR)
# Header-only, so the package fits every architecture. Before 1.0 a minor version may break.
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/tactoidConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/tactoidConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/tactoidConfigVersion.cmake"
        DESTINATION "${tactoid_package_dir}")
set(tactoid_openmp_flags "")
if(TACTOID_HAVE_OPENMP)
  list(JOIN OpenMP_CXX_FLAGS " " tactoid_openmp_flags)
endif()
configure_file("${CMAKE_CURRENT_LIST_DIR}/tactoid.pc.in" "${CMAKE_CURRENT_BINARY_DIR}/tactoid.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/tactoid.pc" DESTINATION "${CMAKE_INSTALL_DATADIR}/pkgconfig")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
