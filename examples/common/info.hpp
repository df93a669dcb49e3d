#pragma once

#include <string>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <fmt/format.h>
#include <hdf5.h>
#include <nanoflann.hpp>
#include <toml++/impl/version.h>

#include <tactoid/core/parallel.hpp>
#include <tactoid/core/version.hpp>

namespace tactoid {

/// What --info prints: the versions of the library, of the compiler and of the dependencies, and the threads.
[[nodiscard]] inline std::string info_text() {
#if defined(__clang__)
  const std::string compiler = fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  const std::string compiler = fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  const std::string compiler = "unknown";
#endif
#if defined(__AVX512F__)
  const std::string vectors = "AVX-512";
#elif defined(__AVX2__)
  const std::string vectors = "AVX2";
#else
  const std::string vectors = "the compiler's default";
#endif
#ifdef _OPENMP
  const std::string threads = fmt::format("OpenMP {}, {} thread(s)", _OPENMP, thread_count());
#else
  const std::string threads = "no OpenMP, 1 thread";
#endif
  return fmt::format(
      "Tactoid    {}\ncompiler   {}\nvectors    {}\nthreads    {}\nEigen      {}.{}.{}\nnanoflann  {}.{}.{}\n"
      "fmt        {}.{}.{}\nCLI11      {}\ntoml++     {}.{}.{}\nHDF5       {}.{}.{}\n",
      version, compiler, vectors, threads, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
      NANOFLANN_VERSION >> 8 & 15, NANOFLANN_VERSION >> 4 & 15, NANOFLANN_VERSION & 15, FMT_VERSION / 10000,
      FMT_VERSION / 100 % 100, FMT_VERSION % 100, CLI11_VERSION, TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH,
      H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
}

}  // namespace tactoid
