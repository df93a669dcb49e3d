#pragma once

namespace tactoid {

/// Literals that turn the units of the field into SI: `5.0_um`, `24.0_kPa`, `1.0_ns`.
inline namespace literals {

#define TACTOID_UNIT(suffix, factor)                                                                            \
  constexpr double operator""_##suffix(long double v) { return static_cast<double>(v) * (factor); }             \
  constexpr double operator""_##suffix(unsigned long long v) { return static_cast<double>(v) * (factor); }

///@{
/// A number with this unit, in SI: `5_um` is 5e-6. For real and for whole numbers.
TACTOID_UNIT(m, 1.0)
TACTOID_UNIT(mm, 1e-3)
TACTOID_UNIT(um, 1e-6)
TACTOID_UNIT(nm, 1e-9)
TACTOID_UNIT(s, 1.0)
TACTOID_UNIT(ms, 1e-3)
TACTOID_UNIT(us, 1e-6)
TACTOID_UNIT(ns, 1e-9)
TACTOID_UNIT(Pa, 1.0)
TACTOID_UNIT(kPa, 1e3)
TACTOID_UNIT(MPa, 1e6)
TACTOID_UNIT(N, 1.0)
TACTOID_UNIT(nN, 1e-9)
TACTOID_UNIT(pN, 1e-12)
TACTOID_UNIT(Pa_s, 1.0)
TACTOID_UNIT(mN_per_m, 1e-3)
TACTOID_UNIT(kg_per_m3, 1.0)
///@}

#undef TACTOID_UNIT

}  // namespace literals
}  // namespace tactoid
