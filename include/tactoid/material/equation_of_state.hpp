#pragma once

#include <cmath>
#include <concepts>

#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// Pressure of a weakly compressible fluid as a function of J = (current volume)/(reference volume), and its energy.
///
/// static T pressure(const T& J, double reference_pressure, double bulk_modulus);   Pa, reference_pressure at J = 1
/// static T energy(const T& J, double reference_pressure, double bulk_modulus);     J per reference volume, 0 at J = 1,
///                                                                                 with dW/dJ = −p
/// Both generic over T = double, Lanes, Dual; −dp/dJ at J = 1 is the bulk modulus.
template <class S>
concept EquationOfState =
    (requires(const double& J) {
      { S::pressure(J, 1.0, 1.0) } -> std::same_as<double>;
    } || unsatisfied<"An EquationOfState has `static T pressure(const T& J, double reference_pressure, double "
                     "bulk_modulus)`.">) &&
    (requires(const double& J) {
      { S::energy(J, 1.0, 1.0) } -> std::same_as<double>;
    } || unsatisfied<"An EquationOfState has `static T energy(const T& J, double reference_pressure, double "
                     "bulk_modulus)`, with dW/dJ = -pressure.">);

/// p = p_ref + K (1 − J)/J,   W = −p_ref (J − 1) + K (J − 1 − ln J): pressure linear in the density. Tension is
/// bounded by K.
struct ReciprocalPressure {
  /// p at J > 0, Pa.
  template <class T>
  [[nodiscard]] static T pressure(const T& J, double reference_pressure, double bulk_modulus) {
    return T(reference_pressure) + T(bulk_modulus) * (T(1.0) - J) / J;
  }
  /// W at J > 0, J per reference volume; NaN for J < 0.
  template <class T>
  [[nodiscard]] static T energy(const T& J, double reference_pressure, double bulk_modulus) {
    using std::log;
    const T dilatation = J - T(1.0);
    return T(bulk_modulus) * (dilatation - log(J)) - T(reference_pressure) * dilatation;
  }
};

/// p = p_ref − K ln J / J,   W = −p_ref (J − 1) + ½ K (ln J)²: the volumetric law of the solids here, with K = 4 λ.
struct LogarithmicPressure {
  /// p at J > 0, Pa; NaN for J < 0.
  template <class T>
  [[nodiscard]] static T pressure(const T& J, double reference_pressure, double bulk_modulus) {
    using std::log;
    return T(reference_pressure) - T(bulk_modulus) * log(J) / J;
  }
  /// W at J > 0, J per reference volume; NaN for J < 0.
  template <class T>
  [[nodiscard]] static T energy(const T& J, double reference_pressure, double bulk_modulus) {
    using std::log;
    const T log_J = log(J);
    return T(0.5 * bulk_modulus) * log_J * log_J - T(reference_pressure) * (J - T(1.0));
  }
};

static_assert(EquationOfState<ReciprocalPressure> && EquationOfState<LogarithmicPressure>);

}  // namespace tactoid
