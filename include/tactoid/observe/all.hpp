#pragma once

#include <tactoid/observe/contact_front.hpp>
#include <tactoid/observe/motion.hpp>
#include <tactoid/observe/probe.hpp>
#include <tactoid/observe/reaction.hpp>
#include <tactoid/observe/stress.hpp>
