#pragma once

#include <tactoid/material/equation_of_state.hpp>
#include <tactoid/material/graded.hpp>
#include <tactoid/material/history.hpp>
#include <tactoid/material/material.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/material/nematic_gel.hpp>
#include <tactoid/material/neo_hookean.hpp>
#include <tactoid/material/regions.hpp>
#include <tactoid/material/tangent.hpp>
#include <tactoid/material/yang_visco.hpp>
