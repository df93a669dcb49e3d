#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/integrator/central_difference.hpp>

namespace tactoid {

/// What an integrator that sub-cycles did since the start.
struct SubcycleReport {
  std::size_t steps = 0;                ///< in which everything moved
  std::vector<std::size_t> body_steps;  ///< of each body: evaluations of its internal forces

  /// For checkpoints: all of it.
  template <class Archive>
  void state(Archive& archive) {
    archive("steps", steps);
    archive("body_steps", body_steps);
  }
};

/// Central differences in which every body takes steps as long as it can itself: a stiff body small ones, a soft one 2, 4, 8 … of them as one,
///
///   Simulation{Bodies{…}, Contacts{…}, Boundaries{…}, SubcycledCentralDifference{CentralDifference{.safety = 0.7}, 8}};
///
/// Contacts, boundary terms and essential conditions act in all small steps; the internal forces of a body only at the ends of its own steps,
/// as impulses over them (r-RESPA: Tuckerman, Berne and Martyna, J. Chem. Phys. 1992, 97, 1990). Of second order, symplectic for conservative forces
/// while the steps stay the same, and conserves linear momentum to round-off. Histories, directors and what the laws dissipate advance with the body's own steps.
///
/// `step` takes one cycle, at whose end the steps of all bodies end. So observers and checkpoints see all of them at one instant; `Simulation::steps` counts
/// cycles. The ratios are powers of two that are not above those of the bodies' stable steps, contacts and terms included, so that the impulses are
/// faster than the modes of a contact, which they might drive else. They are looked at in each cycle, and fall at once but grow late; so does the small step, unless
/// all ratios are 1. The cycles up to an event are made equal. Where a contact becomes stiffer within a cycle, its small steps are divided.
struct SubcycledCentralDifference : CentralDifference {
  static constexpr bool subcycled = true;  ///< see tactoid::subcycled
  int max_ratio = 8;                       ///< of the longest step of a body over the smallest, a power of two; 1: the steps of CentralDifference
  SubcycleReport report{};                 ///< set by the steps, where max_ratio is above 1
  std::vector<int> wanted{};               ///< set by the steps: the ratio of each body where no event cuts the cycle
  double held_step = 0.0;                  ///< set by the steps: the smallest step where no event cuts it, s

  /// Throws ParameterError as CentralDifference does, and unless max_ratio is a power of two.
  void validate() const {
    CentralDifference::validate();
    if (max_ratio < 1 || !std::has_single_bit(static_cast<unsigned>(max_ratio)))
      reject("SubcycledCentralDifference.max_ratio", max_ratio, "", "1, 2, 4, 8 or another power of two");
  }

  /// Checks the parameters; throws ParameterError for these, and for a fixed step above the stable one of the first state.
  template <class System>
  void initialize(System& system) {
    validate();
    CentralDifference::initialize(system);
    report = {.body_steps = std::vector<std::size_t>(System::body_count, 0)};
    wanted.clear();
    held_step = 0.0;
  }

  /// One cycle, not beyond `until` (s). Throws as CentralDifference::step; what breaks down within a cycle leaves the last small step before.
  template <class System>
  void step(System& system, double until) {
    if (max_ratio == 1) return CentralDifference::step(system, until);
    double longest = longest_step(system);
    const double remaining = until - system.time();
    if (remaining <= 0.0) return;
    choose_ratios(system);
    std::vector<int> ratios = wanted;
    int cycle = *std::max_element(ratios.begin(), ratios.end());
    // Steps that follow every change of the stable one take in or give off energy.
    if (time_step == 0.0 && cycle > 1 && held_step <= longest && held_step >= (1.0 - reluctance) * longest) longest = held_step;
    held_step = longest;
    double dt = longest;
    if (time_step > 0.0) {
      cycle = std::min(cycle, power_of_two(remaining / longest * (1.0 + 1e-12)));
      dt = std::min(longest, remaining);
    } else {
      while (cycle > 1 && 0.5 * cycle * longest >= remaining) cycle /= 2;
      dt = remaining / (cycle * std::ceil(remaining / (cycle * longest) * (1.0 - 1e-12)));
    }
    std::array<double, System::body_count> steps{};
    for (std::size_t b = 0; b < steps.size(); ++b) {
      ratios[b] = std::min(ratios[b], cycle);
      if (ratios[b] > 1) steps[b] = ratios[b] * dt;
    }
    system.set_body_steps(steps);
    for (int k = 0; k < cycle; ++k) {
      const int parts = k == 0 ? 1 : division(system, dt);
      for (int part = 0; part < parts; ++part) advance(system, dt / parts);
      report.steps += static_cast<std::size_t>(parts);
      for (std::size_t b = 0; b < steps.size(); ++b)
        if (ratios[b] == 1) report.body_steps[b] += static_cast<std::size_t>(parts);
        else if ((k + 1) % ratios[b] == 0) ++report.body_steps[b];
    }
  }

  /// For checkpoints: what was counted, and what the next cycle begins with. Throws ParameterError where bodies had steps of their own and now may not.
  template <class Archive>
  void state(Archive& archive) {
    if constexpr (Archive::restoring)
      if (max_ratio == 1 && archive.has("held_step"))
        throw ParameterError("SubcycledCentralDifference.max_ratio = 1 is not allowed: the saved state has steps of the bodies' own.");
    if (max_ratio == 1) return;
    archive.part("subcycles", report);
    archive("ratios", wanted);
    archive("held_step", held_step);
  }

 private:
  static constexpr double reluctance = 0.25;  // share by which the stable steps change before the own ones grow

  /// A ratio falls at once where it must, but grows only when there is more than enough room: each change takes in or gives off energy.
  template <class System>
  void choose_ratios(System& system) {
    const auto stable = system.stable_time_steps();
    const double least = *std::min_element(stable.begin(), stable.end());
    const bool first = wanted.empty();
    wanted.resize(stable.size(), 1);
    for (std::size_t b = 0; b < stable.size(); ++b) {
      const double ratio = stable[b] > least ? stable[b] / least : 1.0;  // also where nothing limits any of them
      const auto allowed = [&](double room) { return power_of_two(std::min(ratio / room, double(max_ratio))); };
      wanted[b] = first ? allowed(1.0) : std::min(allowed(1.0), std::max(wanted[b], allowed(1.0 + reluctance)));
    }
  }

  /// The largest one up to x, at least 1.
  [[nodiscard]] static int power_of_two(double x) { return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::clamp(x, 1.0, double(1 << 30))))); }

  /// Into how many parts a step within a cycle must be divided at the present state: 1 as long as the stable step has not shrunk by half of what
  /// `safety` leaves.
  template <class System>
  [[nodiscard]] int division(System& system, double dt) const {
    const double longest = longest_step(system);
    if (time_step > 0.0 || dt <= longest * 0.5 * (1.0 + 1.0 / safety)) return 1;
    return static_cast<int>(std::ceil(dt / longest * (1.0 - 1e-12)));
  }
};

}  // namespace tactoid
