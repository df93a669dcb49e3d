#pragma once

#include <doctest/doctest.h>

namespace tactoid::test {

/// A value to compare with by relative error alone. doctest::Approx as it comes also allows an absolute error of its
/// epsilon, and so finds any two lengths in metres or energies in joules equal.
inline doctest::Approx relative(double value) { return doctest::Approx(value).scale(0.0); }

}  // namespace tactoid::test
