#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/neighbors/neighbor_table.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/quadrature/row_share.hpp>

namespace tactoid {

/// Points, and the particles that cover them: row k of the neighbours belongs to points[k].
struct RowsToMake {
  std::vector<Index> points;  ///< ascending
  NeighborTable neighbors;    ///< of them

  /// One more point, behind the others.
  void add(Index point, std::span<const Index> row) {
    points.push_back(point);
    neighbors.indices.insert(neighbors.indices.end(), row.begin(), row.end());
    neighbors.offsets.push_back(neighbors.indices.size());
  }
};

/// How the ranks build one table together. A quadrature that can takes it as the third argument of `build`.
class DividedBuild {
 public:
  /// `region_cost`: of a point of each region of the cloud beside its pairs, in pairs. `ranks` must outlive it.
  DividedBuild(Ranks& ranks, std::vector<double> region_cost) : ranks_(ranks), region_cost_(std::move(region_cost)) {}

  /// Particles that cover the given points.
  using Find = std::function<NeighborTable(std::span<const Index> points)>;

  /// Divides a table that has its points and chunks (cut_chunks) but no rows: colours the chunks, and returns which rows this rank has to make. Each rank searches
  /// around a share of the points, and tells the others what it found. `supports` of the particles, m. Collective; throws ParameterError on all ranks where these have not made the
  /// same points and supports.
  [[nodiscard]] RowsToMake divide(PointTable& table, std::span<const double> supports, const Find& find);

  /// Of a table that has the points of a part of a cloud, but no rows: which rows this rank has to make, those that touch its own particles. Collective; throws ParameterError on all
  /// ranks where these have not the parts of one cloud.
  [[nodiscard]] RowsToMake rows_of(const PointTable& table, const CloudPart& part, const Find& find) const;
  /// Takes note of the share of this rank when the table has its rows: colours its chunks. Collective.
  void share_part(PointTable& table, std::shared_ptr<const CloudPart> part, std::size_t points_per_chunk);

  /// Does what each rank does for itself, as Ranks::together().
  template <class F>
  void together(const F& work) const { ranks_.together(work); }

  [[nodiscard]] const std::shared_ptr<RowShare>& share() const { return share_; }  ///< of this rank, after divide() or share_part()

 private:
  void require_same_points(const PointTable& table, std::span<const double> supports) const;
  /// What all chunks touch, and their costs.
  [[nodiscard]] TableOutline outline(const PointTable& table, const Find& find) const;

  Ranks& ranks_;
  std::vector<double> region_cost_;
  std::shared_ptr<RowShare> share_;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/divided_build.ipp>
#endif
