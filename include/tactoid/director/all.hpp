#pragma once

#include <tactoid/director/director.hpp>
#include <tactoid/director/director_field.hpp>
#include <tactoid/director/ginzburg_landau.hpp>
#include <tactoid/director/initial_director.hpp>
#include <tactoid/director/objective_rates.hpp>
