#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/contact/first_touch.hpp>

namespace tactoid {

TACTOID_INLINE std::vector<Index> FirstTouch::update(std::span<const double> gaps) {
  touched.resize(gaps.size(), 0);
  std::vector<Index> first;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (touched[i] || !(gaps[i] <= capture_distance)) continue;
    touched[i] = 1;
    first.push_back(static_cast<Index>(i));
  }
  return first;
}

}  // namespace tactoid
