#include <doctest/doctest.h>

#include <string>

#include <tactoid/core/version.hpp>

namespace core_version_test {

TEST_CASE("the version as a text is the version in numbers") {
  CHECK(tactoid::version == std::to_string(TACTOID_VERSION_MAJOR) + "." + std::to_string(TACTOID_VERSION_MINOR) + "." +
                                std::to_string(TACTOID_VERSION_PATCH));
}

}  // namespace core_version_test
