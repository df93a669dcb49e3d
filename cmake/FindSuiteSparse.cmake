# UMFPACK and CHOLMOD, which distributions install without package files: SuiteSparse_FOUND and the target SuiteSparse::SuiteSparse.
find_path(SuiteSparse_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_UMFPACK_LIBRARY umfpack)
find_library(SuiteSparse_CHOLMOD_LIBRARY cholmod)
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_UMFPACK_LIBRARY SuiteSparse_CHOLMOD_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_UMFPACK_LIBRARY SuiteSparse_CHOLMOD_LIBRARY SuiteSparse_INCLUDE_DIR)
if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::SuiteSparse)
  add_library(SuiteSparse::SuiteSparse UNKNOWN IMPORTED)
  set_target_properties(SuiteSparse::SuiteSparse PROPERTIES IMPORTED_LOCATION "${SuiteSparse_UMFPACK_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES
                        "${SuiteSparse_INCLUDE_DIR}" INTERFACE_LINK_LIBRARIES "${SuiteSparse_CHOLMOD_LIBRARY}")
endif()
