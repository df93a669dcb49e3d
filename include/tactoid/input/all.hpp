#pragma once

#include <tactoid/input/gmsh.hpp>
#include <tactoid/input/mesh.hpp>
