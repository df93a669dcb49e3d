#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/point_cloud.hpp>

namespace tactoid {

/// Whose part of a cloud is wanted:
///
///   mpi::Session session(argc, argv);
///   const Rkpm<3> kernel{};
///   const Part part{.rank = session.rank(), .ranks = session.size(), .support = kernel.support};
///   Body block{"block", box_part({.size = …, .cells = …}, part), kernel, …};
struct Part {
  int rank = 0;           ///< in [0, ranks)
  int ranks = 1;          ///< >= 1
  double support = 0.0;   ///< of the kernel, in spacings, > 0
  bool surface = false;   ///< with all facets and the particles on them: for a body that takes part in contacts, or in boundary terms other than prescribed motions
  void validate() const;  ///< throws ParameterError for a value that is not in its range
};

/// One rank's part of a cloud that it has as a whole, divided by recursive bisection along the longer direction; particles keep the numbers that they have in it. The whole may be
/// released before a body is made of the part. Throws ParameterError, also where there are more ranks than particles.
template <int D>
[[nodiscard]] PointCloud<D> part_of(const PointCloud<D>& cloud, const Part& part);

namespace detail {

/// The particles `kept` of a cloud, in that order, with the cells and facets of which all particles are kept.
template <int D>
[[nodiscard]] PointCloud<D> kept_of(const PointCloud<D>& cloud, const std::vector<Index>& kept);

/// By how far the particles that rows of a rank may touch lie beyond its own: two supports.
[[nodiscard]] inline double reach_of_part(const Part& part, double spacing) { return 2.0 * part.support * spacing * (1.0 + 1e-9); }

}  // namespace detail

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/cloud_part.ipp>
#endif
