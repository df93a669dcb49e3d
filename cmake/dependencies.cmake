# Every dependency in one place: found on the machine (find_package), else downloaded as a pinned release.
include_guard()
include(FetchContent)

# Package; target it must give; oldest version that is accepted; release that is downloaded; Debian/Ubuntu package.
set(tactoid_dependency_Eigen3 Eigen3::Eigen 3.4 3.4.0 libeigen3-dev
    https://gitlab.com/libeigen/eigen/-/archive/3.4.0/eigen-3.4.0.tar.gz)
set(tactoid_dependency_nanoflann nanoflann::nanoflann 1.4 1.5.5 libnanoflann-dev
    https://github.com/jlblancoc/nanoflann/archive/refs/tags/v1.5.5.tar.gz)
set(tactoid_dependency_fmt fmt::fmt 9 10.2.1 libfmt-dev
    https://github.com/fmtlib/fmt/archive/refs/tags/10.2.1.tar.gz)
set(tactoid_dependency_doctest doctest::doctest 2.4 2.4.11 doctest-dev
    https://github.com/doctest/doctest/archive/refs/tags/v2.4.11.tar.gz)
set(tactoid_dependency_CLI11 CLI11::CLI11 2.1 2.4.2 libcli11-dev
    https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.4.2.tar.gz)
set(tactoid_dependency_tomlplusplus tomlplusplus::tomlplusplus 3.3 3.4.0 libtomlplusplus-dev
    https://github.com/marzer/tomlplusplus/archive/refs/tags/v3.4.0.tar.gz)
set(tactoid_dependency_benchmark benchmark::benchmark 1.7 1.8.4 libbenchmark-dev
    https://github.com/google/benchmark/archive/refs/tags/v1.8.4.tar.gz)

set(tactoid_fetched "" CACHE INTERNAL "Dependencies that were downloaded")

# Makes the target of `package` available, or stops with one message that says what to do.
macro(tactoid_require package)
  list(GET tactoid_dependency_${package} 0 tactoid_dependency_target)
  list(GET tactoid_dependency_${package} 1 tactoid_dependency_oldest)
  if(NOT TARGET ${tactoid_dependency_target})
    find_package(${package} ${tactoid_dependency_oldest} QUIET)
    if(NOT TARGET ${tactoid_dependency_target})
      # A package that only accepts its own major version (Eigen 5, fmt 11) says no to an older request.
      find_package(${package} QUIET)
      if(TARGET ${tactoid_dependency_target} AND ${package}_VERSION VERSION_LESS tactoid_dependency_oldest)
        message(FATAL_ERROR "tactoid: ${package} ${${package}_VERSION} is too old; "
                            "${tactoid_dependency_oldest} or newer is needed.")
      endif()
    endif()
    if(NOT TARGET ${tactoid_dependency_target})
      tactoid_fetch(${package})
    endif()
  endif()
endmacro()

function(tactoid_fetch package)
  set(row ${tactoid_dependency_${package}})
  list(GET row 0 target)
  list(GET row 1 oldest)
  list(GET row 2 release)
  list(GET row 3 debian)
  list(GET row 4 url)
  string(TOLOWER ${package} name)
  string(TOUPPER ${package} upper)
  set(advice "Install ${package} (Debian/Ubuntu: apt-get install ${debian}), or give -DCMAKE_PREFIX_PATH=<where it is "
             "installed>, or -DFETCHCONTENT_SOURCE_DIR_${upper}=<its unpacked sources>.")
  string(JOIN "" advice ${advice})
  if(FETCHCONTENT_SOURCE_DIR_${upper})
    FetchContent_Declare(${name} SOURCE_DIR "${FETCHCONTENT_SOURCE_DIR_${upper}}" SYSTEM)
  elseif(NOT TACTOID_FETCH)
    message(FATAL_ERROR "tactoid: ${package} ${oldest} or newer was not found on this machine. ${advice}")
  else()
    set(archive "${CMAKE_BINARY_DIR}/_deps/${name}-${release}.tar.gz")
    if(NOT EXISTS "${archive}")
      message(STATUS "tactoid: ${package} was not found on this machine; downloading ${url}")
      file(DOWNLOAD "${url}" "${archive}.part" STATUS status TIMEOUT 120 INACTIVITY_TIMEOUT 20)
      list(GET status 0 code)
      list(GET status 1 reason)
      if(NOT code EQUAL 0)
        file(REMOVE "${archive}.part")
        message(FATAL_ERROR "tactoid: ${package} ${oldest} or newer was not found on this machine, and release "
                            "${release} could not be downloaded from ${url} (${reason}). ${advice}")
      endif()
      file(RENAME "${archive}.part" "${archive}")
    endif()
    FetchContent_Declare(${name} URL "${archive}" DOWNLOAD_EXTRACT_TIMESTAMP ON SYSTEM)
  endif()

  # What the dependencies would build or install beside their library.
  foreach(off BUILD_TESTING EIGEN_BUILD_TESTING EIGEN_BUILD_DOC EIGEN_BUILD_PKGCONFIG EIGEN_LEAVE_TEST_IN_ALL_TARGET
              NANOFLANN_BUILD_EXAMPLES NANOFLANN_BUILD_TESTS FMT_DOC FMT_TEST FMT_INSTALL DOCTEST_WITH_TESTS
              CLI11_BUILD_TESTS CLI11_BUILD_EXAMPLES CLI11_BUILD_DOCS BENCHMARK_ENABLE_TESTING
              BENCHMARK_ENABLE_INSTALL BENCHMARK_ENABLE_GTEST_TESTS)
    set(${off} OFF)
  endforeach()
  set(DOCTEST_NO_INSTALL ON)
  set(CMAKE_POLICY_DEFAULT_CMP0077 NEW) # the variables above count as the options of their projects
  FetchContent_MakeAvailable(${name})

  string(REGEX REPLACE ".*::" "" plain ${target})
  if(NOT TARGET ${target} AND TARGET ${plain})
    add_library(${target} ALIAS ${plain})
  endif()
  if(NOT TARGET ${target})
    message(FATAL_ERROR "tactoid: the sources of ${package} do not give the target ${target}. ${advice}")
  endif()
  set(tactoid_fetched ${tactoid_fetched} ${package} CACHE INTERNAL "Dependencies that were downloaded")
endfunction()
