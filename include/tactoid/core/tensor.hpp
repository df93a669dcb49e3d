#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include <tactoid/core/compiled.hpp>

namespace tactoid {

/// Index of a particle, a quadrature point, a facet or a cell.
using Index = std::uint32_t;

/// Point or vector of a D-dimensional cloud.
template <int D, class T = double>
using Point = Eigen::Matrix<T, D, 1>;

/// Vector and second-order tensor as the laws see them: always three-dimensional, whatever the
/// dimension of the body. T is a double, Lanes (several points at once) or Dual (with derivatives).
template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;
/// Second-order tensor, 3 × 3 in every dimension; see Vector.
template <class T>
using Tensor = Eigen::Matrix<T, 3, 3>;

using Vector3 = Vector<double>;  ///< a vector of doubles
using Tensor3 = Tensor<double>;  ///< a tensor of doubles

/// A vector padded to four lanes: what the hot loops load in one piece. The fourth component is zero.
using Vector4 = Eigen::Vector4d;

/// A vector field over the particles of a body, or over quadrature points.
using Field = std::vector<Vector4>;

/// A vector of one to four components, padded by zeros.
template <class Derived>
[[nodiscard]] inline Vector4 pad(const Eigen::MatrixBase<Derived>& v) {
  Vector4 padded = Vector4::Zero();
  padded.head(v.size()) = v;
  return padded;
}

}  // namespace tactoid
