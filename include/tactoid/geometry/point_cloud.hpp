#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <tactoid/core/tensor.hpp>

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

/// What of a cloud one of several processes (ranks) has: the particles that belong to it, and around them what its rows may touch (box_part, part_of). Particles are numbered anew.
struct CloudPart : Part {
  /// No particles yet, of a cloud of `particles`. Its facets are those of the whole where `surface`, and particles on them are the first ones, in the same order on every rank.
  CloudPart(const Part& wanted, std::size_t particles) : Part(wanted), whole(particles) {}

  std::size_t whole;            ///< particles of the whole cloud
  std::vector<Index> number;    ///< per particle: its number in the whole cloud
  std::vector<int> owner;       ///< per particle: the rank to which it belongs
  std::vector<double> spacing;  ///< per particle: its longest edge in the whole cloud, m
  std::vector<char> complete;   ///< per particle: 1 where all its cells are here
  std::vector<Index> own;       ///< particles that belong to this rank, ascending

  [[nodiscard]] bool is_own(std::size_t i) const { return owner[i] == rank; }  ///< particle i belongs to this rank
  /// One more particle.
  void add(Index number_in_whole, int rank_of, double longest_edge, bool has_all_cells) {
    if (rank_of == rank) own.push_back(static_cast<Index>(number.size()));
    number.push_back(number_in_whole);
    owner.push_back(rank_of);
    spacing.push_back(longest_edge);
    complete.push_back(has_all_cells ? 1 : 0);
  }
};

/// Particles of one body in its reference configuration, with the background cells that give them volumes,
/// quadrature cells, surface facets and pictures. The cells are no finite elements.
///
/// D = 1: lines and points, D = 2: quadrilaterals and lines, D = 3: hexahedra and quadrilaterals.
/// Vertices stand in tensor order: vertex i + 2 j + 4 k of a cell is the corner (i, j, k) of the unit cube,
/// and the Jacobian of the cell is positive. For a facet x(s, t) in that order, ∂x/∂s × ∂x/∂t points
/// outwards (D = 3); for a segment from a to b, the tangent turned by −90° does (D = 2).
///
/// A cloud of D = 2 may be the meridian section of a body of revolution: X[0] = R >= 0 is the distance from the axis,
/// X[1] = Z the place along it. Volumes, areas, masses, forces and energies are then those of the whole rings, 2πR times
/// those of the section, and the third direction of every tensor is that around the axis.
template <int D>
struct PointCloud {
  static_assert(D >= 1 && D <= 3, "A point cloud has 1, 2 or 3 dimensions.");
  static constexpr int dimension = D;                ///< D
  using Cell = std::array<Index, (1u << D)>;         ///< 2^D vertices, in tensor order
  using Facet = std::array<Index, (1u << (D - 1))>;  ///< 2^(D − 1) vertices, in tensor order

  std::vector<Point<D>> positions;                   ///< reference positions X, m
  std::vector<Cell> cells;                           ///< background cells
  std::vector<Index> cell_regions;                   ///< region of each cell, an index into `regions`
  std::vector<std::string> regions = {"body"};       ///< names of the regions
  std::vector<Facet> facets;                         ///< the boundary, oriented outwards
  Point<D> period = Point<D>::Zero();                ///< period in each direction, m; 0 where not periodic
  bool axisymmetric = false;                         ///< a meridian section, D = 2 only
  std::shared_ptr<const CloudPart> part;             ///< of the whole cloud, which one of several processes has; null: this is the whole

  [[nodiscard]] std::size_t size() const { return positions.size(); }  ///< number of particles
  /// Number of particle i in the whole cloud.
  [[nodiscard]] std::size_t number(std::size_t i) const { return part ? part->number[i] : i; }

  /// Length of the ring through X, 2πR, m; 1 where the cloud is no meridian section.
  [[nodiscard]] double circumference(const Point<D>& X) const {
    return axisymmetric ? 2.0 * std::numbers::pi * X[0] : 1.0;
  }
  /// Whether X lies on the axis of a meridian section.
  [[nodiscard]] bool on_axis(const Point<D>& X) const { return axisymmetric && X[0] == 0.0; }

  /// b − a by the shortest way around in periodic directions.
  [[nodiscard]] Point<D> difference(const Point<D>& a, const Point<D>& b) const {
    Point<D> d = b - a;
    for (int k = 0; k < D; ++k)
      if (period[k] > 0.0) d[k] -= period[k] * std::round(d[k] / period[k]);
    return d;
  }
};

/// Indices of the particles whose reference position satisfies `predicate`.
template <int D, class Predicate>
[[nodiscard]] std::vector<Index> select(const PointCloud<D>& cloud, const Predicate& predicate) {
  std::vector<Index> chosen;
  for (Index i = 0; i < cloud.size(); ++i)
    if (predicate(cloud.positions[i])) chosen.push_back(i);
  return chosen;
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/geometry/point_cloud.ipp>
#endif
