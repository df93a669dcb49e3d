# tactoid::mpi, for programs that run on several processes.
include_guard()
find_package(MPI QUIET COMPONENTS CXX)
find_package(METIS QUIET)
if(NOT MPI_CXX_FOUND OR NOT METIS_FOUND)
  message(FATAL_ERROR "tactoid: TACTOID_WITH_MPI needs MPI and METIS (MPI found: ${MPI_CXX_FOUND}, METIS found: ${METIS_FOUND}). Install them (Debian/Ubuntu: "
                      "apt-get install libopenmpi-dev openmpi-bin libmetis-dev), or give -DCMAKE_PREFIX_PATH=<where they are installed>.")
endif()
add_library(tactoid_mpi INTERFACE)
add_library(tactoid::mpi ALIAS tactoid_mpi)
set_target_properties(tactoid_mpi PROPERTIES EXPORT_NAME mpi VERIFY_INTERFACE_HEADER_SETS ${PROJECT_IS_TOP_LEVEL})
target_link_libraries(tactoid_mpi INTERFACE tactoid MPI::MPI_CXX METIS::METIS)
target_compile_definitions(tactoid_mpi INTERFACE TACTOID_WITH_MPI)
target_sources(tactoid_mpi INTERFACE FILE_SET HEADERS BASE_DIRS "${CMAKE_CURRENT_SOURCE_DIR}/include" FILES ${tactoid_headers_with_mpi})
