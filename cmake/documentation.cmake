# The reference by Doxygen, in <build folder>/docs/html: cmake --build … --target docs
include_guard()
find_package(Doxygen 1.9 QUIET)
find_program(TACTOID_AWK NAMES awk mawk gawk)
if(NOT DOXYGEN_FOUND OR NOT TACTOID_AWK)
  message(STATUS "tactoid: no target docs, because Doxygen (1.9 or newer) or awk was not found")
  return()
endif()

set(TACTOID_DOCS_DIR "${PROJECT_BINARY_DIR}/docs")
set(TACTOID_DOCS_FILTER "\\\"${TACTOID_AWK}\\\" -f \\\"${CMAKE_CURRENT_LIST_DIR}/doxygen_filter.awk\\\"")
# Pages name their pictures by the path from their own folder.
file(GLOB TACTOID_DOCS_IMAGES LIST_DIRECTORIES ON CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/*")
list(FILTER TACTOID_DOCS_IMAGES EXCLUDE REGEX "\\.[a-z]+$")
list(TRANSFORM TACTOID_DOCS_IMAGES REPLACE "(.+)" "\"\\1\"")
list(JOIN TACTOID_DOCS_IMAGES " " TACTOID_DOCS_IMAGES)
configure_file("${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in" "${TACTOID_DOCS_DIR}/Doxyfile" @ONLY)
set(TACTOID_DOCS_COMMAND
    ${CMAKE_COMMAND} -D "DOXYGEN=${DOXYGEN_EXECUTABLE}" -D "DOXYGEN_VERSION=${DOXYGEN_VERSION}" -D "FOLDER=${TACTOID_DOCS_DIR}" -D
    "HEADERS=${PROJECT_SOURCE_DIR}/include" -P "${CMAKE_CURRENT_LIST_DIR}/run_doxygen.cmake")
add_custom_target(docs COMMAND ${TACTOID_DOCS_COMMAND} USES_TERMINAL VERBATIM)
