#pragma once

#include <tactoid/kinematics/kinematics.hpp>
