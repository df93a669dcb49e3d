#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/text.hpp>

namespace tactoid {

/// A unit of a quantity: its symbol and its size in SI, 10^exponent × factor. Powers of ten are kept as exponents, so
/// that "5 us" and "5e-6" are the same number to the last bit.
struct Unit {
  std::string_view symbol;  ///< as it is written: "um"
  int exponent = 0;         ///< power of ten
  double factor = 1.0;      ///< 1 unless the unit is no power of ten of the SI unit (degrees)
};

/// A kind of physical quantity with the units in which it may be written; the first of them is the SI unit.
/// Programs may define their own beside those below.
struct Quantity {
  std::string_view name;        ///< in messages: "length"
  std::span<const Unit> units;  ///< empty for plain numbers

  /// Symbol of the SI unit, empty for plain numbers.
  [[nodiscard]] constexpr std::string_view si() const { return units.empty() ? std::string_view{} : units[0].symbol; }

  ///@{
  /// A kind of quantity whose units the library knows.
  static const Quantity dimensionless, time, length, area, pressure, density, viscosity, surface_tension, force, mass,
      velocity, acceleration, energy, frequency, number_density, angle;
  ///@}
};

/// The units in which each kind of quantity may be written, the SI unit first.
namespace quantity_units {
///@{
/// Units of the quantity of that name; a degree in rad.
inline constexpr double degree = 0.017453292519943295;
inline constexpr Unit time[] = {{"s"}, {"ms", -3}, {"us", -6}, {"ns", -9}, {"ps", -12}};
inline constexpr Unit length[] = {{"m"}, {"mm", -3}, {"um", -6}, {"nm", -9}};
inline constexpr Unit area[] = {{"m2"}, {"mm2", -6}, {"um2", -12}, {"nm2", -18}};
inline constexpr Unit pressure[] = {{"Pa"}, {"kPa", 3}, {"MPa", 6}, {"GPa", 9}};
inline constexpr Unit density[] = {{"kg/m3"}, {"g/cm3", 3}};
inline constexpr Unit viscosity[] = {{"Pa.s"}, {"mPa.s", -3}};
inline constexpr Unit surface_tension[] = {{"N/m"}, {"mN/m", -3}};
inline constexpr Unit force[] = {{"N"}, {"uN", -6}, {"nN", -9}, {"pN", -12}};
inline constexpr Unit mass[] = {{"kg"}, {"g", -3}, {"ng", -12}, {"pg", -15}};
inline constexpr Unit velocity[] = {{"m/s"}, {"mm/s", -3}, {"um/s", -6}};
inline constexpr Unit acceleration[] = {{"m/s2"}, {"N/kg"}};
inline constexpr Unit energy[] = {{"J"}, {"nJ", -9}, {"pJ", -12}, {"fJ", -15}, {"pN.um", -18}};
inline constexpr Unit frequency[] = {{"Hz"}, {"kHz", 3}, {"MHz", 6}, {"GHz", 9}};
inline constexpr Unit number_density[] = {{"1/m2"}, {"1/um2", 12}};
inline constexpr Unit angle[] = {{"rad"}, {"deg", 0, degree}};
///@}
}  // namespace quantity_units

inline constexpr Quantity Quantity::dimensionless{"a plain number", {}};
inline constexpr Quantity Quantity::time{"time", quantity_units::time};
inline constexpr Quantity Quantity::length{"length", quantity_units::length};
inline constexpr Quantity Quantity::area{"area", quantity_units::area};
inline constexpr Quantity Quantity::pressure{"pressure", quantity_units::pressure};
inline constexpr Quantity Quantity::density{"density", quantity_units::density};
inline constexpr Quantity Quantity::viscosity{"viscosity", quantity_units::viscosity};
inline constexpr Quantity Quantity::surface_tension{"surface tension", quantity_units::surface_tension};
inline constexpr Quantity Quantity::force{"force", quantity_units::force};
inline constexpr Quantity Quantity::mass{"mass", quantity_units::mass};
inline constexpr Quantity Quantity::velocity{"velocity", quantity_units::velocity};
inline constexpr Quantity Quantity::acceleration{"acceleration", quantity_units::acceleration};
inline constexpr Quantity Quantity::energy{"energy", quantity_units::energy};
inline constexpr Quantity Quantity::frequency{"frequency", quantity_units::frequency};
inline constexpr Quantity Quantity::number_density{"number per area", quantity_units::number_density};
inline constexpr Quantity Quantity::angle{"angle", quantity_units::angle};

namespace detail {

/// Length of the decimal number at the beginning of `text` (sign, digits, point, exponent), 0 where there is none.
/// `exponent_at` is where its exponent begins, or its length.
[[nodiscard]] std::size_t number_length(std::string_view text, std::size_t& exponent_at);

}  // namespace detail

/// Reads "5us", "5 us", "0.3", "10 kPa", "1e-9 s" into SI. A plain number is in the SI unit; "µ" is read as "u".
/// Throws ParameterError with one sentence that begins with `name`.
[[nodiscard]] double parse_quantity(std::string_view text, const Quantity& quantity, std::string_view name);

/// Writes `value` (SI) in the unit that gives one to three digits before the point: 5e-6 s becomes "5 us". With
/// `digits` > 0 it is rounded to that many digits; with 0, parse_quantity gives back exactly `value`.
[[nodiscard]] std::string format_quantity(double value, const Quantity& quantity, int digits = 0);

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/core/quantity.ipp>
#endif
