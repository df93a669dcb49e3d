#pragma once

/// How functions are defined that depend on no type of the user's (the *.ipp beside the headers): inline, at the end of the
/// header that declares them; or once, in tactoid::compiled, for programs that define TACTOID_COMPILED and link it.
#if !defined(TACTOID_COMPILED)
#define TACTOID_INLINE inline
#else
#define TACTOID_INLINE

#include <cstddef>

#include <Eigen/Core>

#include <tactoid/core/quad.hpp>

namespace tactoid::detail {

/// Vectors lie in memory as the processor wants them that a program is compiled for. Where the compiled library was compiled
/// for another one, the linker does not find this.
template <int Alignment, std::size_t Vector>
struct LibraryForTheSameProcessor {
  LibraryForTheSameProcessor() noexcept;
};
inline const LibraryForTheSameProcessor<EIGEN_MAX_ALIGN_BYTES, alignof(Quad) + alignof(Octet)> library_for_the_same_processor;

}  // namespace tactoid::detail
#endif
