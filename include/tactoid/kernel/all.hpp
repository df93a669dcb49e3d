#pragma once

#include <tactoid/kernel/basis.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kernel/mls.hpp>
#include <tactoid/kernel/reproducing.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/kernel/shape_functions.hpp>
#include <tactoid/kernel/support.hpp>
#include <tactoid/kernel/windows.hpp>
