#pragma once

#include <algorithm>
#include <cstddef>

#include <doctest/doctest.h>

#include <tactoid/core/tensor.hpp>

namespace tactoid::test {

/// The largest vector of a field.
inline double largest(const Field& a) {
  double length = 0.0;
  for (const Vector4& x : a) length = std::max(length, x.norm());
  return length;
}
/// The largest difference of two fields of one size.
inline double largest_difference(const Field& a, const Field& b) {
  REQUIRE(a.size() == b.size());
  double length = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) length = std::max(length, (a[i] - b[i]).norm());
  return length;
}

}  // namespace tactoid::test
