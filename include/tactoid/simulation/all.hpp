#pragma once

#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/contact_anchoring.hpp>
#include <tactoid/simulation/decomposition.hpp>
#include <tactoid/simulation/implicit_problem.hpp>
#include <tactoid/simulation/observer.hpp>
#include <tactoid/simulation/placement.hpp>
#include <tactoid/simulation/redistribution.hpp>
#include <tactoid/simulation/simulation.hpp>
#include <tactoid/simulation/static_problem.hpp>
#include <tactoid/simulation/stiffness.hpp>
