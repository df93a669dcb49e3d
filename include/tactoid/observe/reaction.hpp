#pragma once

#include <cstddef>
#include <vector>

#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Forces of the essential conditions of a body on it.
struct Reactions {
  std::vector<Vector3> conditions;  ///< of each condition, in the order in which `on<N>(…)` names them, N
  Vector3 total = Vector3::Zero();  ///< their sum, N
};

/// Reactions of all prescribed motions of body N of a simulation, at the beginning of its last step (that is when the
/// force acts that brings the body to the prescribed place at the end of the step); zero before the first step. Of a body of
/// revolution: sums over whole rings, in which (0) is the radial part; the axis is the last condition.
///
///   simulation.run(5_us, every(0.1_us, [](auto& s) { fmt::print("{}\n", reactions<1>(s).total[2]); }));
template <std::size_t N, class S>
[[nodiscard]] Reactions reactions(const S& simulation) {
  const auto& essential = simulation.template essential<N>();
  Reactions r;
  for (std::size_t m = 0; m < essential.motions().size(); ++m) {
    r.conditions.push_back(essential.reaction(m));
    r.total += r.conditions.back();
  }
  return r;
}

}  // namespace tactoid
