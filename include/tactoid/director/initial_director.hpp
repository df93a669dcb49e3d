#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/random.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// A function of the reference position X (m, three components in every dimension) that gives the director there.
template <class F>
concept InitialDirector =
    (requires(const F& f, const Vector3& X) {
      { f(X) } -> std::convertible_to<Vector3>;
    } || unsatisfied<"An InitialDirector is a function of the reference position: `Vector3 operator()(const "
                 "Vector3& X) const`.">);

/// The same direction everywhere, normalised to unit length.
class UniformDirector {
 public:
  /// Throws ParameterError for a zero or non-finite direction.
  explicit UniformDirector(const Vector3& direction) : director_(direction / direction.norm()) {
    if (!(direction.norm() > 0.0) || !std::isfinite(direction.norm()))
      reject("UniformDirector.direction", direction.norm(), "(its length)", "a finite vector that is not zero");
  }
  [[nodiscard]] Vector3 operator()(const Vector3&) const { return director_; }  ///< the direction

 private:
  Vector3 director_;
};

/// Away from a centre (m): a hedgehog. At the centre itself, its defect, the director is zero.
class RadialDirector {
 public:
  explicit RadialDirector(const Vector3& centre) : centre_(centre) {}  ///< m
  /// The unit vector from the centre to X, m.
  [[nodiscard]] Vector3 operator()(const Vector3& X) const {
    const Vector3 away = X - centre_;
    const double distance = away.norm();
    return distance > 0.0 ? Vector3(away / distance) : Vector3(Vector3::Zero());
  }

 private:
  Vector3 centre_;
};

/// Parameters of RandomDirector.
struct RandomDirectorOptions {
  double correlation_length = 2.0e-6;  ///< ℓ, m: before normalisation the correlation at a distance r is e^{−r²/(2ℓ²)}
  std::uint64_t seed = 1;              ///< another seed, another field; the same seed, the same field, on any machine
  int modes = 96;                      ///< Fourier modes per component, >= 1
};

/// A random, smooth, statistically uniform and isotropic field of unit length: a sum of random Fourier modes,
/// normalised at each point. It is a function of the position alone, so it does not depend on the cloud.
class RandomDirector {
 public:
  /// Throws ParameterError unless correlation_length > 0 and modes >= 1.
  explicit RandomDirector(const RandomDirectorOptions& options = {});

  /// The director at X, m; of unit length.
  [[nodiscard]] Vector3 operator()(const Vector3& X) const {
    Vector3 h = Vector3::Zero();
    for (const auto& mode : modes_)
      for (int k = 0; k < 3; ++k) h(k) += std::cos(mode[k].number.dot(X) + mode[k].phase);
    const double length = h.norm();
    return length > 0.0 ? Vector3(h / length) : Vector3(Vector3::UnitX());
  }

 private:
  struct Wave {
    Vector3 number;  // 1/m
    double phase;
  };
  struct Mode {
    Wave wave[3];
    Wave& operator[](int k) { return wave[k]; }
    const Wave& operator[](int k) const { return wave[k]; }
    Wave* begin() { return wave; }
    Wave* end() { return wave + 3; }
  };
  std::vector<Mode> modes_;
};

static_assert(InitialDirector<UniformDirector> && InitialDirector<RadialDirector> && InitialDirector<RandomDirector>);

/// The director at each particle of a cloud; the fourth component is zero.
template <int D, InitialDirector F>
[[nodiscard]] Field initial_director(const PointCloud<D>& cloud, const F& director) {
  Field h(cloud.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    Vector3 X = Vector3::Zero();
    X.template head<D>() = cloud.positions[i];
    h[i] = pad(Vector3(director(X)));
  }
  return h;
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/director/initial_director.ipp>
#endif
