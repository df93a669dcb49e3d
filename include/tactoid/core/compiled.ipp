#pragma once

#include <tactoid/core/compiled.hpp>

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {

template <int Alignment>
LibraryForTheSameProcessor<Alignment>::LibraryForTheSameProcessor() noexcept = default;

template struct LibraryForTheSameProcessor<EIGEN_MAX_ALIGN_BYTES>;

}  // namespace tactoid::detail
#endif
