#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <tactoid/core/errors.hpp>

namespace tactoid {

/// Observed orders of convergence.
struct ConvergenceRates {
  std::vector<double> successive;  ///< log(e_i / e_{i+1}) / log(h_i / h_{i+1}) from one resolution to the next
  double fitted = 0.0;             ///< slope of the least-squares line through all points (log h, log e)

  /// Of the successive orders.
  [[nodiscard]] double lowest() const { return *std::min_element(successive.begin(), successive.end()); }
  [[nodiscard]] double last() const { return successive.back(); }  ///< order between the two finest
};

/// Orders at which errors fall with the size h of a discretisation: spacings, or time steps.
///
///   const auto rates = convergence_rates(std::array{0.1, 0.05, 0.025}, errors);
///   rates.fitted >= 1.9
///
/// Throws ParameterError for fewer than two sizes, another number of errors, a size or an error that is not positive
/// and finite, and for two equal sizes in succession.
[[nodiscard]] inline ConvergenceRates convergence_rates(std::span<const double> sizes, std::span<const double> errors) {
  if (sizes.size() < 2) reject("convergence_rates: sizes", static_cast<double>(sizes.size()), "", "two at least");
  if (errors.size() != sizes.size())
    throw ParameterError(
        fmt::format("convergence_rates: there are {} errors for {} sizes.", errors.size(), sizes.size()));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    require_positive(fmt::format("convergence_rates: sizes[{}]", i), sizes[i]);
    require_positive(fmt::format("convergence_rates: errors[{}]", i), errors[i]);
    if (i > 0 && sizes[i] == sizes[i - 1])
      reject(fmt::format("convergence_rates: sizes[{}]", i), sizes[i], "", "different from the one before");
  }
  ConvergenceRates rates;
  const auto n = static_cast<double>(sizes.size());
  double x_mean = 0.0, y_mean = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    x_mean += std::log(sizes[i]) / n;
    y_mean += std::log(errors[i]) / n;
    if (i > 0) rates.successive.push_back(std::log(errors[i - 1] / errors[i]) / std::log(sizes[i - 1] / sizes[i]));
  }
  double xy = 0.0, xx = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double x = std::log(sizes[i]) - x_mean;
    xy += x * (std::log(errors[i]) - y_mean);
    xx += x * x;
  }
  rates.fitted = xy / xx;
  return rates;
}

}  // namespace tactoid
