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
[[nodiscard]] inline std::size_t number_length(std::string_view text, std::size_t& exponent_at) {
  const auto digits_from = [&](std::size_t i) {
    std::size_t n = 0;
    while (i + n < text.size() && text[i + n] >= '0' && text[i + n] <= '9') ++n;
    return n;
  };
  std::size_t i = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  const std::size_t whole = digits_from(i);
  i += whole;
  std::size_t fraction = 0;
  if (i < text.size() && text[i] == '.') fraction = digits_from(i + 1), i += (whole + fraction > 0) ? 1 + fraction : 0;
  if (whole + fraction == 0) return exponent_at = 0;
  exponent_at = i;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t j = i + 1;
    if (j < text.size() && (text[j] == '-' || text[j] == '+')) ++j;
    if (const std::size_t n = digits_from(j); n > 0) i = j + n;
  }
  return i;
}

}  // namespace detail

/// Reads "5us", "5 us", "0.3", "10 kPa", "1e-9 s" into SI. A plain number is in the SI unit; "µ" is read as "u".
/// Throws ParameterError with one sentence that begins with `name`.
[[nodiscard]] inline double parse_quantity(std::string_view text, const Quantity& quantity, std::string_view name) {
  const std::string_view given = trimmed(text);
  if (given.empty())
    throw ParameterError(fmt::format("{}: the value is empty; {} is needed.", name,
                                     quantity.units.empty() ? "a number" : quantity.name));

  std::size_t exponent_at = 0;
  const std::size_t length = detail::number_length(given, exponent_at);
  if (length == 0) {
    throw ParameterError(fmt::format("{}: {} is not a finite number{}.", name, in_quotes(given),
                                     quantity.units.empty() ? "" : fmt::format(" with a unit of {}", quantity.name)));
  }
  std::string symbol{trimmed(given.substr(length))};
  for (const std::string_view mu : {"\xC2\xB5", "\xCE\xBC"})
    if (symbol.starts_with(mu)) symbol.replace(0, mu.size(), "u");

  Unit unit;
  if (!symbol.empty()) {
    if (quantity.units.empty())
      throw ParameterError(fmt::format("{}: {} has a unit, but a plain number is needed.", name, in_quotes(given)));
    bool known = false;
    std::string allowed;
    for (const Unit& candidate : quantity.units) {
      if (candidate.symbol == symbol) unit = candidate, known = true;
      allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", candidate.symbol);
    }
    if (!known) {
      throw ParameterError(
          fmt::format("{}: {} has an unknown unit {}; allowed units of {} are {} (or a plain number in {}).", name,
                      in_quotes(given), in_quotes(symbol), quantity.name, allowed, quantity.si()));
    }
  }

  // The unit's power of ten joins the number's exponent before the one conversion that rounds.
  long exponent = unit.exponent;
  if (exponent_at < length) {
    std::string_view written = given.substr(exponent_at + 1, length - exponent_at - 1);
    if (written[0] == '+') written.remove_prefix(1);
    long own = 0;
    const auto read = std::from_chars(written.data(), written.data() + written.size(), own);
    exponent +=
        read.ec == std::errc{} ? std::min(std::max(own, -100000L), 100000L) : (written[0] == '-' ? -100000L : 100000L);
  }
  std::string_view mantissa = given.substr(0, exponent_at);
  if (mantissa[0] == '+') mantissa.remove_prefix(1);
  const std::string number = fmt::format("{}e{}", mantissa, exponent);
  double value = 0.0;
  const auto read = std::from_chars(number.data(), number.data() + number.size(), value);
  if (read.ec != std::errc{} || !std::isfinite(value))
    throw ParameterError(fmt::format("{}: {} is outside the range of numbers.", name, in_quotes(given)));
  return value * unit.factor;
}

/// Writes `value` (SI) in the unit that gives one to three digits before the point: 5e-6 s becomes "5 us". With
/// `digits` > 0 it is rounded to that many digits; with 0, parse_quantity gives back exactly `value`.
[[nodiscard]] inline std::string format_quantity(double value, const Quantity& quantity, int digits = 0) {
  const auto with = [](std::string number, std::string_view symbol) {
    return symbol.empty() ? number : fmt::format("{} {}", number, symbol);
  };
  if (value == 0.0 || !std::isfinite(value) || quantity.units.empty())
    return with(digits > 0 ? fmt::format("{:.{}g}", value, digits) : fmt::format("{}", value), quantity.si());

  // Shortest decimal form d.ddd × 10^power that reads back as the same number.
  char buffer[64];
  const auto written =
      digits > 0 ? std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific, digits - 1)
                 : std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific);
  const std::string_view text(buffer, static_cast<std::size_t>(written.ptr - buffer));
  const std::size_t e = text.find('e');
  std::string_view power_text = text.substr(e + 1);
  if (power_text[0] == '+') power_text.remove_prefix(1);
  int power = 0;
  std::from_chars(power_text.data(), power_text.data() + power_text.size(), power);
  std::string figures;
  for (const char c : text.substr(0, e))
    if (c >= '0' && c <= '9') figures += c;
  while (figures.size() > 1 && figures.back() == '0') figures.pop_back();

  const Unit* best = nullptr;
  for (const Unit& unit : quantity.units) {
    if (unit.factor != 1.0) continue;
    const int shifted = power - unit.exponent;
    if (shifted >= 0 && shifted < 3 && best == nullptr) best = &unit;
  }
  if (best == nullptr) {
    std::string number = fmt::format("{}{}", value < 0 ? "-" : "", figures.substr(0, 1));
    if (figures.size() > 1) number += "." + figures.substr(1);
    if (power != 0) number += fmt::format("e{}", power);
    return with(number, quantity.si());
  }
  const auto before = static_cast<std::size_t>(power - best->exponent + 1);
  if (figures.size() < before) figures.append(before - figures.size(), '0');
  std::string number = (value < 0 ? "-" : "") + figures.substr(0, before);
  if (figures.size() > before) number += "." + figures.substr(before);
  return with(number, best->symbol);
}

}  // namespace tactoid
