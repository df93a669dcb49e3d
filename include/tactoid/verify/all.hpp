#pragma once

#include <tactoid/verify/convergence.hpp>
#include <tactoid/verify/energy_watch.hpp>
#include <tactoid/verify/gate_report.hpp>
#include <tactoid/verify/material_gate.hpp>
#include <tactoid/verify/patch_test.hpp>
