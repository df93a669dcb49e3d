#include <doctest/doctest.h>

#include <cmath>

#include <tactoid/core/dual.hpp>

#include "relative.hpp"

namespace core_dual_test {

using namespace tactoid;

TEST_CASE("Sine and cosine of dual numbers: first and second derivatives") {
  using Inner = Dual<double, 1>;
  using Outer = Dual<Inner, 1>;
  const Outer x = Outer::variable(Inner::variable(0.7, 0), 0);
  const Outer s = sin(x), c = cos(x);
  CHECK(s.value.value == std::sin(0.7));
  CHECK(s.derivative[0].value == test::relative(std::cos(0.7)));
  CHECK(s.derivative[0].derivative[0] == test::relative(-std::sin(0.7)));
  CHECK(c.value.value == std::cos(0.7));
  CHECK(c.derivative[0].value == test::relative(-std::sin(0.7)));
  CHECK(c.derivative[0].derivative[0] == test::relative(-std::cos(0.7)));
}

}  // namespace core_dual_test
