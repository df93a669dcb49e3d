#pragma once

#include <tactoid/input/csv.hpp>
#include <tactoid/input/gmsh.hpp>
#include <tactoid/input/mesh.hpp>
#include <tactoid/input/points.hpp>
#include <tactoid/input/vtu.hpp>
