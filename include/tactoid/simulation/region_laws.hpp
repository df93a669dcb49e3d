#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include <tactoid/core/lanes.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/material/all.hpp>
#include <tactoid/material/history.hpp>
#include <tactoid/quadrature/quadrature.hpp>

namespace tactoid {

/// Lanes that the force loop evaluates a law on. Eight doubles are one register of the widest machines; narrower
/// machines take two or four registers.
using LoopLanes = Lanes<8>;

/// The law of one region, its histories and its stabilisation, as the force loop of a body needs them: points
/// [begin, end) of the table, in blocks of as many points as the scalar has lanes. A graded law differs from
/// point to point, so it is stored per point and evaluated one point at a time.
template <class M>
struct RegionLaw {
  using Material = M;                                            ///< as it was given to the body
  static constexpr bool graded = is_graded<M>;                   ///< the law depends on the position
  using Law = LawOf<M>;                                          ///< of one point
  using Scalar = std::conditional_t<graded, double, LoopLanes>;  ///< on which the law is evaluated
  static constexpr int width = lane_count<Scalar>;               ///< points per evaluation

  std::vector<Law> laws;  ///< one, or one per point when graded
  std::vector<HistoryOf<Law, Scalar>> histories;  ///< of the accepted state
  std::vector<HistoryOf<Law, Scalar>> advanced;   ///< by the step that is being computed
  std::size_t begin = 0;                          ///< first point of the region in the table
  std::size_t end = 0;                            ///< one past its last point
  Stabilization stabilization;                    ///< of the region; of its softest law, where graded

  /// Wave speed squared and kinematic longitudinal viscosity, the largest over the region, m²/s² and m²/s.
  double wave_speed_squared = 0.0;
  double kinematic_viscosity = 0.0;  ///< see above, m²/s
  double least_density = std::numeric_limits<double>::infinity();  ///< over the region, kg/m³
  double softest = std::numeric_limits<double>::infinity();        ///< least shear modulus of the region, Pa

  [[nodiscard]] const Law& law(std::size_t q) const { return laws[graded ? q - begin : 0]; }  ///< at point q of the table
  /// Number of the block that holds point q.
  [[nodiscard]] std::size_t block(std::size_t q) const { return (q - begin) / static_cast<std::size_t>(width); }

  /// For checkpoints: the histories, as numbers point by point.
  template <class Archive>
  void state(Archive& archive) {
    constexpr std::size_t scalars = history_size<Law>;
    if constexpr (scalars > 0) {
      std::vector<double> flat(histories.size() * scalars * static_cast<std::size_t>(width));
      const auto for_each_number = [&](const auto& visit) {
        std::size_t k = 0;
        for (auto& history : histories)
          for (std::size_t i = 0; i < scalars; ++i)
            for (int l = 0; l < width; ++l) visit(flat[k++], history_scalars<Law, Scalar>(history)[i], l);
      };
      for_each_number([](double& number, Scalar& x, int l) { number = lane(x, l); });
      archive("histories", flat);
      if constexpr (Archive::restoring) for_each_number([](double& number, Scalar& x, int l) { set_lane(x, l, number); });
    }
  }

  /// The same of the points in `rows`, whose places count from the first point of the region.
  template <class Archive>
  void state(Archive& archive, const StateRows& rows) {
    constexpr std::size_t scalars = history_size<Law>;
    if constexpr (scalars > 0) {
      std::vector<Eigen::Matrix<double, static_cast<int>(scalars), 1>> of_points(end - begin);
      const auto for_each_number = [&](const auto& visit) {
        for (std::size_t p = 0; p < of_points.size(); ++p)
          for (std::size_t k = 0; k < scalars; ++k)
            visit(of_points[p][static_cast<Eigen::Index>(k)], history_scalars<Law, Scalar>(histories[block(begin + p)])[k], static_cast<int>(p % static_cast<std::size_t>(width)));
      };
      for_each_number([](double& number, Scalar& x, int l) { number = lane(x, l); });
      archive("points", of_points, &rows);
      if constexpr (Archive::restoring) for_each_number([](double& number, Scalar& x, int l) { set_lane(x, l, number); });
    }
  }

  /// The laws of points [first, last), and their limits. Then settle() is to be called.
  void prepare(const M& material, std::size_t first, std::size_t last, const std::vector<Vector3>& positions) {
    begin = first;
    end = last;
    if constexpr (graded) {
      for (std::size_t q = begin; q < end; ++q) laws.push_back(material.at(positions[q]));
    } else {
      laws.push_back(material);
    }
    for (const Law& law : laws) {
      if constexpr (requires { law.validate(); }) law.validate();
      wave_speed_squared = std::max(wave_speed_squared, law.wave_speed() * law.wave_speed());
      kinematic_viscosity = std::max(kinematic_viscosity, viscosity_modulus(law) / law.density);
      softest = std::min(softest, shear_modulus(law));
      least_density = std::min(least_density, law.density);
    }
    histories.resize((end - begin + width - 1) / static_cast<std::size_t>(width));
    advanced = histories;
  }
  /// What settle() takes; of several processes that have points of the region, the largest of each.
  [[nodiscard]] std::array<double, 4> limits() const { return {wave_speed_squared, kinematic_viscosity, -least_density, -softest}; }
  /// Takes the limits of the whole region. `scale`, the stabilisation's factor per point of the table (empty without one), takes up how far a graded law's
  /// stabilisation is above the least of the region, which is `stabilization`.
  template <class Q>
  void settle(const std::array<double, 4>& of_all, const Q& quadrature, std::vector<double>& scale) {
    wave_speed_squared = of_all[0];
    kinematic_viscosity = of_all[1];
    least_density = -of_all[2];
    softest = -of_all[3];
    stabilization = quadrature.stabilization(softest);
    scale_stabilization(quadrature, scale);
  }

  /// Lets the stabilisation's factors of a table follow a graded law, as prepare() does.
  template <class Q>
  void scale_stabilization([[maybe_unused]] const Q& quadrature, [[maybe_unused]] std::vector<double>& scale) const {
    if constexpr (graded) {
      if (scale.empty() || !(stabilization.modulus > 0.0)) return;
      for (std::size_t q = begin; q < end; ++q)
        scale[q] *= quadrature.stabilization(shear_modulus(law(q))).modulus / stabilization.modulus;
    }
  }
};

}  // namespace tactoid
