#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace tactoid {

/// Anything the library reports to its user.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A parameter, option or type that cannot be accepted; found before anything is computed.
/// Programs end with exit status 2.
struct ParameterError : Error {
  using Error::Error;
};

/// The point cloud, its cells or its supports do not allow the requested approximation.
/// Programs end with exit status 2.
struct GeometryError : Error {
  using Error::Error;
};

/// A computation that broke down: a NaN, an inverted point, a solver without convergence.
/// Programs end with exit status 3.
struct ComputationError : Error {
  using Error::Error;
};

/// Reads or writes that failed. Programs end with exit status 2.
struct FileError : Error {
  using Error::Error;
};

/// Throws ParameterError: "<name> = <value> <unit> is not allowed: it must be <allowed>."
[[noreturn]] inline void reject(std::string_view name, double value, std::string_view unit, std::string_view allowed) {
  throw ParameterError(
      fmt::format("{} = {:g}{}{} is not allowed: it must be {}.", name, value, unit.empty() ? "" : " ", unit, allowed));
}

/// Throws ParameterError unless `value` is finite and > 0.
inline void require_positive(std::string_view name, double value, std::string_view unit = "") {
  if (!(value > 0.0) || !std::isfinite(value)) reject(name, value, unit, "positive and finite");
}

/// Throws ParameterError unless `value` is finite and >= 0.
inline void require_non_negative(std::string_view name, double value, std::string_view unit = "") {
  if (!(value >= 0.0) || !std::isfinite(value)) reject(name, value, unit, "zero or positive, and finite");
}

/// Throws ParameterError unless `value` is finite.
inline void require_finite(std::string_view name, double value, std::string_view unit = "") {
  if (!std::isfinite(value)) reject(name, value, unit, "finite");
}

}  // namespace tactoid
