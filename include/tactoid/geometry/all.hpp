#pragma once

#include <tactoid/geometry/ball.hpp>
#include <tactoid/geometry/box.hpp>
#include <tactoid/geometry/cell_map.hpp>
#include <tactoid/geometry/disc.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/jitter.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/meridian.hpp>
#include <tactoid/geometry/order.hpp>
#include <tactoid/geometry/part.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/geometry/pole_refinement.hpp>
#include <tactoid/geometry/validate.hpp>
