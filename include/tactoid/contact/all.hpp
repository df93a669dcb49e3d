#pragma once

#include <tactoid/contact/closest_point.hpp>
#include <tactoid/contact/combined.hpp>
#include <tactoid/contact/contact.hpp>
#include <tactoid/contact/first_touch.hpp>
#include <tactoid/contact/gap_law.hpp>
#include <tactoid/contact/gaps.hpp>
#include <tactoid/contact/ligand_receptor.hpp>
#include <tactoid/contact/on_rigid.hpp>
#include <tactoid/contact/per_dimension.hpp>
#include <tactoid/contact/repulsive_wall.hpp>
#include <tactoid/contact/rigid_surface.hpp>
#include <tactoid/contact/surface.hpp>
#include <tactoid/contact/surface_contact.hpp>
#include <tactoid/contact/tethered_bonds.hpp>
#include <tactoid/contact/tracking.hpp>
#include <tactoid/contact/van_der_waals.hpp>
