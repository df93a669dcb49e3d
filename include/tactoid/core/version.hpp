#pragma once

/// The one source of the project's version; CMakeLists.txt reads it from here.
#define TACTOID_VERSION_MAJOR 0
#define TACTOID_VERSION_MINOR 1  ///< changes with interfaces, before 1.0
#define TACTOID_VERSION_PATCH 0  ///< changes when something is mended

namespace tactoid {

/// The version as text.
inline constexpr const char* version = "0.1.0";

}  // namespace tactoid
