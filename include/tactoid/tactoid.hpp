#pragma once

/// Everything. Include the rooms that you need for a faster compilation.

#include <tactoid/boundary/all.hpp>
#include <tactoid/contact/all.hpp>
#include <tactoid/core/core.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/input/all.hpp>
#include <tactoid/integrator/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/kinematics/all.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/neighbors/all.hpp>
#include <tactoid/observe/all.hpp>
#include <tactoid/output/all.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/all.hpp>

/// Meshfree Galerkin simulation of soft matter. The rooms of the library are folders, not namespaces: everything a program
/// uses is here, what is internal to a room in `detail`.
namespace tactoid {}
