#pragma once

/// The version alone, for `#if TACTOID_VERSION_MAJOR …`.
#include <tactoid/core/version.hpp>
