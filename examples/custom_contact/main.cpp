// A contact of your own: bonds that break under force hold two blocks together, which are pulled apart. See README.md beside this
// file, and bell_bonds.hpp for the contact.
#include <algorithm>
#include <cmath>

#include <tactoid/tactoid.hpp>

#include "bell_bonds.hpp"

using namespace tactoid;

namespace {

constexpr double width = 2_um, height = 1_um, speed = 0.1, end = 1.0_us;  // pulled at `speed`, m/s

struct Pull {
  double peak = 0.0, peak_time = 0.0;  ///< largest force, N, and when
  double worst = 0.0;                  ///< largest difference from the expected force, over its peak
  double energy_error = 0.0;
};

/// Pulls the upper block off; `expected`: the force at a time, N, or none.
template <class Expected>
Pull pull(const BellBonds& bonds, const Expected& expected) {
  const auto block = [](const char* name, double z) {
    return Body{name, box({.size = {width, width, height}, .cells = {3, 3, 2}, .origin = {0.0, 0.0, z}}), Rkpm<3>{}, NodalCentroids{},
                Materials{Region{"body", NeoHookean::from_young(1e9, 0.3)}}};
  };
  Body lower = block("lower", -height), upper = block("upper", bonds.length);
  upper.velocity.assign(upper.size(), Vector4(0.0, 0.0, speed, 0.0));  // no shock at the start
  const auto bottom = select(lower.cloud(), [](const Point<3>& X) { return X[2] < -0.999 * height; });
  const auto top = select(upper.cloud(), [&](const Point<3>& X) { return X[2] > bonds.length + 0.999 * height; });
  Simulation simulation{Bodies{std::move(lower), std::move(upper)}, Contacts{between<1, 0>(bonds)},
                        Boundaries{on<0>(fixed(bottom)), on<1>(PrescribedMotion{top, [](const Vector3&, double t) { return Vector3(0.0, 0.0, speed * t); }})},
                        CentralDifference{}};
  Pull result;
  double scale = 0.0;
  simulation.run(end, every_steps(1, [&](auto& s) {
    const double force = s.template contact<0>().total_force;
    if (force > result.peak) result.peak = force, result.peak_time = s.time();
    result.worst = std::max(result.worst, std::abs(force - expected(s.time())));
    scale = std::max(scale, expected(s.time()));
  }));
  result.worst = scale > 0.0 ? result.worst / scale : 0.0;
  result.energy_error = simulation.ledger().error();
  return result;
}

}  // namespace

int main() {
  // Slip bonds that do not form again, stretched at a constant rate: n = n₀ exp(−k₀ F_b/(κ v) (e^{κ v t/F_b} − 1)).
  const BellBonds slip;
  const double loading = slip.stiffness * speed;  // of a bond, N/s
  const auto exact = [&](double t) {
    const double left = std::exp(-slip.off_rate * slip.slip_force / loading * std::expm1(loading * t / slip.slip_force));
    return slip.density * width * width * left * loading * t;
  };
  const Pull slipping = pull(slip, exact);
  fmt::print("slip bonds:       largest force {:.4g} nN at {:.3g} us; differs from Bell's by at most {:.2g} % of it; energy error {:.1g}\n",
             1e9 * slipping.peak, 1e6 * slipping.peak_time, 100.0 * slipping.worst, slipping.energy_error);

  BellBonds caught = slip;
  caught.catch_weight = 20.0;
  const auto none = [](double) { return 0.0; };
  const Pull catching = pull(caught, none);
  BellBonds binding = slip;
  binding.on_rate = 1e7;
  const Pull rebinding = pull(binding, none);
  fmt::print("catch and slip:   largest force {:.4g} nN at {:.3g} us; energy error {:.1g}\n", 1e9 * catching.peak, 1e6 * catching.peak_time,
             catching.energy_error);
  fmt::print("that form again:  largest force {:.4g} nN at {:.3g} us; energy error {:.1g}\n", 1e9 * rebinding.peak, 1e6 * rebinding.peak_time,
             rebinding.energy_error);
  const bool sound = slipping.worst < 0.01 && std::max({slipping.energy_error, catching.energy_error, rebinding.energy_error}) < 0.01;
  return sound ? 0 : 1;
}
