#pragma once

#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/consistency.hpp>
#include <tactoid/quadrature/divided_build.hpp>
#include <tactoid/quadrature/gauss_cells.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/quadrature/particle_values.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/quadrature/quadrature.hpp>
#include <tactoid/quadrature/row_share.hpp>
#include <tactoid/quadrature/stored.hpp>
