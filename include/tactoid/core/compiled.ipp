#pragma once

#include <tactoid/core/compiled.hpp>

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {

template <int Alignment, std::size_t Vector>
LibraryForTheSameProcessor<Alignment, Vector>::LibraryForTheSameProcessor() noexcept = default;

template struct LibraryForTheSameProcessor<EIGEN_MAX_ALIGN_BYTES, alignof(Quad) + alignof(Octet)>;

}  // namespace tactoid::detail
#endif
