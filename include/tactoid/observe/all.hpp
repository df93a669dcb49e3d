#pragma once

#include <tactoid/observe/contact_front.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/observe/stress.hpp>
