#pragma once

#include <tactoid/output/body_frame.hpp>
#include <tactoid/output/file.hpp>
#include <tactoid/output/history.hpp>
#include <tactoid/output/progress.hpp>
#include <tactoid/output/pvd.hpp>
#include <tactoid/output/summary.hpp>
#include <tactoid/output/vtu.hpp>
