#pragma once

#include <tactoid/core/dual.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/lanes.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/quantity.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/core/text.hpp>
#include <tactoid/core/units.hpp>
#include <tactoid/core/unsatisfied.hpp>
#include <tactoid/core/version.hpp>
