#pragma once

#include <tactoid/boundary/axis_condition.hpp>
#include <tactoid/boundary/body_force.hpp>
#include <tactoid/boundary/boundary.hpp>
#include <tactoid/boundary/curvature_surface_tension.hpp>
#include <tactoid/boundary/essential_conditions.hpp>
#include <tactoid/boundary/on_facets.hpp>
#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/boundary/pressure.hpp>
#include <tactoid/boundary/surface_tension.hpp>
