#pragma once

#include <tactoid/neighbors/neighbor_search.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/neighbors/part_of.hpp>
