#pragma once

#include <concepts>

#include <tactoid/core/unsatisfied.hpp>

namespace tactoid {

/// A force between two surfaces that depends on their signed gap g (m, positive when apart) alone, per area.
///
///   double potential(double g) const;   energy per area, J/m²; zero for g ≥ reach(), continuous
///   double traction(double g) const;    −d potential/dg, Pa; positive pushes apart; finite for every g, also negative
///   double stiffness(double g) const;   |d traction/dg|, Pa/m: limits the time step
///   double reach() const;               the gap beyond which the law is zero, m (may be infinite)
///   void validate() const;              throws ParameterError
///
/// `SurfaceContact{.law = …}` makes a Contact of it, `OnRigid{.law = …, .surface = …}` a BoundaryTerm.
/// A law never allocates and never throws outside validate().
template <class L>
concept GapLaw =
    (requires(const L& l, double g) {
      { l.potential(g) } -> std::convertible_to<double>;
    } || unsatisfied<"A GapLaw has `double potential(double gap) const` (J/m^2).">) && (requires(const L& l, double g) {
      { l.traction(g) } -> std::convertible_to<double>;
    } || unsatisfied<"A GapLaw has `double traction(double gap) const` (Pa, positive pushes apart).">) &&
    (requires(const L& l, double g) {
      { l.stiffness(g) } -> std::convertible_to<double>;
    } || unsatisfied<"A GapLaw has `double stiffness(double gap) const` (|d traction/d gap|, Pa/m).">) &&
    (requires(const L& l) {
      { l.reach() } -> std::convertible_to<double>;
    } || unsatisfied<"A GapLaw has `double reach() const` (m): the gap beyond which it is zero.">) &&
    (requires(const L& l) { l.validate(); } ||
     unsatisfied<"A GapLaw has `void validate() const` that throws ParameterError.">);

}  // namespace tactoid
