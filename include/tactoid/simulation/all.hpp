#pragma once

#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/contact_anchoring.hpp>
#include <tactoid/simulation/observer.hpp>
#include <tactoid/simulation/placement.hpp>
#include <tactoid/simulation/simulation.hpp>
