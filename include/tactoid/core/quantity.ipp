#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/core/quantity.hpp>

namespace tactoid::detail {

TACTOID_INLINE std::size_t number_length(std::string_view text, std::size_t& exponent_at) {
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

}  // namespace tactoid::detail

namespace tactoid {

TACTOID_INLINE double parse_quantity(std::string_view text, const Quantity& quantity, std::string_view name) {
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

TACTOID_INLINE std::string format_quantity(double value, const Quantity& quantity, int digits) {
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
