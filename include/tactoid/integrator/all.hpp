#pragma once

#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/integrator/integrator.hpp>
