#pragma once

#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/integrator/implicit_dynamics.hpp>
#include <tactoid/integrator/integrator.hpp>
#include <tactoid/integrator/reference_update.hpp>
#include <tactoid/integrator/static_newton.hpp>
#include <tactoid/integrator/subcycled_central_difference.hpp>
