#pragma once

#include <tactoid/kernel/shape_functions.hpp>

namespace tactoid::detail {

/// The neighbours of a point as a kernel takes them.
template <int D>
void gather(const PointCloud<D>& cloud, const Point<D>& x, std::span<const Index> row,
            const std::vector<double>& supports, const std::vector<double>& volumes,
            std::vector<KernelNeighbor<D>>& out) {
  out.clear();
  for (const Index i : row) out.push_back({cloud.difference(x, cloud.positions[i]), supports[i], volumes[i]});
}

template <int D>
ShapeFunctionTable<D> fill_table(const PointCloud<D>& cloud, const std::vector<Point<D>>& points, const ShapeFunctionOptions& options,
                                 const std::vector<double>& radii, double support, int basis_size, bool with_values,
                                 const EvaluateKernel<D>& evaluate) {
  options.validate();
  const std::vector<double> volumes = nodal_volumes(cloud);
  NeighborTable neighbors = neighbor_table(cloud, points, radii);
  ShapeFunctionTable<D> table;
  table.gradients.resize(neighbors.indices.size());
  if (with_values) table.values.resize(neighbors.indices.size());
  std::vector<double> conditions(points.size());
  parallel_for(points.size(), [&](std::size_t q) {
    thread_local std::vector<KernelNeighbor<D>> near;
    thread_local ShapeFunctions<D> shape;
    gather<D>(cloud, points[q], neighbors.row(q), radii, volumes, near);
    conditions[q] = evaluate(std::span<const KernelNeighbor<D>>(near), shape);
    const auto first = static_cast<std::ptrdiff_t>(neighbors.offsets[q]);
    std::copy(shape.gradient.begin(), shape.gradient.end(), table.gradients.begin() + first);
    if (with_values) std::copy(shape.value.begin(), shape.value.end(), table.values.begin() + first);
  });
  for (std::size_t q = 0; q < points.size(); ++q) {
    if (!(conditions[q] <= options.condition_limit))
      throw GeometryError(fmt::format(
          "Point {} at {} has {} particles in reach, and a moment matrix of condition number {:.3g} (allowed: {:.3g}) "
          "for {} basis functions: enlarge the support of the kernel ({:g} spacings), or mend the cloud there.",
          q, describe<D>(points[q]), neighbors.row(q).size(), conditions[q], options.condition_limit, basis_size,
          support));
    table.largest_condition = std::max(table.largest_condition, conditions[q]);
  }
  table.offsets = std::move(neighbors.offsets);
  table.indices = std::move(neighbors.indices);
  return table;
}

}  // namespace tactoid::detail

#if defined(TACTOID_COMPILED)
namespace tactoid::detail {
template ShapeFunctionTable<1> fill_table<1>(const PointCloud<1>&, const std::vector<Point<1>>&, const ShapeFunctionOptions&,
                                              const std::vector<double>&, double, int, bool, const EvaluateKernel<1>&);
template ShapeFunctionTable<2> fill_table<2>(const PointCloud<2>&, const std::vector<Point<2>>&, const ShapeFunctionOptions&,
                                              const std::vector<double>&, double, int, bool, const EvaluateKernel<2>&);
template ShapeFunctionTable<3> fill_table<3>(const PointCloud<3>&, const std::vector<Point<3>>&, const ShapeFunctionOptions&,
                                              const std::vector<double>&, double, int, bool, const EvaluateKernel<3>&);
}  // namespace tactoid::detail
#endif
