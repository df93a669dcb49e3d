#pragma once

#include <tactoid/mpi/chunk_graph.hpp>
#include <tactoid/mpi/divided_bodies.hpp>
#include <tactoid/mpi/owned_values.hpp>
#include <tactoid/mpi/parcels.hpp>
#include <tactoid/mpi/part_of_body.hpp>
#include <tactoid/mpi/session.hpp>
