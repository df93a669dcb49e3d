#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/random.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/material/history.hpp>
#include <tactoid/material/material.hpp>
#include <tactoid/material/tangent.hpp>
#include <tactoid/verify/gate_path.hpp>
#include <tactoid/verify/gate_report.hpp>

namespace tactoid {

/// What the material gate tries. Errors are relative; the scale of a stress is its own size at that point.
struct MaterialGateOptions {
  int samples = 12;                    ///< random deformations, >= 1; each also without its change of volume
  double amplitude = 0.3;              ///< size of the entries of F − 1, in (0, 0.5)
  double time_step = 2.0e-7;           ///< s, of the paths that lead to F: near the law's relaxation time, if any
  double director_gradient = 1.0e6;    ///< size of the entries of ∇₀h, 1/m
  double tolerance = 1.0e-9;           ///< largest relative error of what must agree to round-off
  std::uint64_t seed = 1;              ///< of the random deformations
};

namespace detail {

/// What the gate learns of a law; one member function per property.
template <Material M>
struct GateRun {
  using Hist = tactoid::HistoryOf<M, double>;
  static constexpr int steps = 4;  // of a path

  const M& material;
  const MaterialGateOptions& options;
  double scale = material.density * material.wave_speed() * material.wave_speed();  // stiffness, Pa
  std::vector<GatePath> paths = make_paths();

  [[nodiscard]] std::vector<GatePath> make_paths() const {
    std::vector<GatePath> made;
    Random random(options.seed);
    for (int k = 0; k < options.samples; ++k) {
      GatePath path;
      do path.end = Tensor3::Identity() + random_tensor(random, options.amplitude);
      while (determinant(path.end) < 0.3);
      path.aside = random_tensor(random, 0.2 * options.amplitude);
      path.director = Vector3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      path.director_gradient = random_tensor(random, options.director_gradient);
      path.duration = steps * options.time_step;
      made.push_back(path);
      path.end /= std::cbrt(determinant(path.end));  // the same without change of volume: small stresses show
      made.push_back(path);
    }
    return made;
  }

  struct End {
    PointState<double> state;
    Hist before;  // history before the last step
    Hist after;
    Response<double> response;
  };

  [[nodiscard]] End walk(const GatePath& path) const {
    End end;
    for (int k = 1; k <= steps; ++k) {
      end.state = path.at(static_cast<double>(k) / steps, options.time_step);
      end.before = end.after;
      end.response = respond(material, end.state, end.after);
    }
    return end;
  }

  /// |error| relative to the size of `reference` and, so that round-off passes, a small part of the law's stiffness.
  [[nodiscard]] double relative(double error, double reference) const {
    if (std::isnan(error) || std::isnan(reference)) return std::numeric_limits<double>::infinity();
    const double round_off = 64.0 * std::numeric_limits<double>::epsilon() * scale;
    return error / (reference + round_off / options.tolerance);
  }

  /// P − ∂W/∂F: with no time passing and Ḟ = 0 for laws that write energy(F) and first_piola(F).
  [[nodiscard]] double stress_of_energy_error() const {
    double worst = 0.0;
    if constexpr (HasEnergy<M>) {
      for (const GatePath& path : paths) {
        const PointState<double> state = path.at(1.0, 0.0);
        Hist history;
        const Tensor3 P = respond(material, state, history).stress;
        const Tensor3 dW = stress_of_energy(material, state.deformation_gradient);
        worst = std::max(worst, relative((P - dW).norm(), dW.norm()));
      }
    }
    return worst;
  }

  /// Same path, turned on its way by a growing rotation (with its spin in Ḟ, and the director turned): P must turn
  /// with it, energy and powers must not change.
  [[nodiscard]] double objectivity_error() const {
    double worst = 0.0;
    Random random(options.seed + 1);
    for (const GatePath& path : paths) {
      GatePath turned = path;
      turned.turn = skew_part(random_tensor(random, 2.0));
      const Response<double> a = walk(path).response, b = walk(turned).response;
      worst = std::max(worst, relative((b.stress - turned.rotation(1.0) * a.stress).norm(), a.stress.norm()));
      worst = std::max(worst, relative(std::abs(b.energy - a.energy), std::abs(a.energy)));
      const double rate = path.at(1.0, 0.0).deformation_rate.norm();
      for (const auto part : {&Response<double>::dissipated_power, &Response<double>::active_power})
        worst = std::max(worst, relative(std::abs(b.*part - a.*part) / rate, std::abs(a.*part) / rate));
    }
    return worst;
  }

  /// P Fᵀ − F Pᵀ: the Cauchy stress is symmetric.
  [[nodiscard]] double angular_momentum_error() const {
    double worst = 0.0;
    for (const GatePath& path : paths) {
      const End end = walk(path);
      const Tensor3 PFt = end.response.stress * end.state.deformation_gradient.transpose();
      worst = std::max(worst, relative((PFt - PFt.transpose()).norm(), PFt.norm()));
    }
    return worst;
  }

  /// Convergence order of [P(F + hH) − P(F − hH)]/2h to the tangent by differentiation: 2 if both are right.
  /// Infinite where the stress is so nearly linear that the difference is round-off.
  [[nodiscard]] double tangent_order() const {
    double lowest = std::numeric_limits<double>::infinity();
    Random random(options.seed + 2);
    for (const GatePath& path : paths) {
      const End end = walk(path);
      const Tangent A = tangent(material, end.state, end.after);
      const Tensor3 H = random_tensor(random, 1.0);
      Tensor3 slope;
      for (int i = 0; i < 3; ++i)
        for (int K = 0; K < 3; ++K) {
          slope(i, K) = 0.0;
          for (int j = 0; j < 3; ++j)
            for (int L = 0; L < 3; ++L) slope(i, K) += A(3 * i + K, 3 * j + L) * H(j, L);
        }
      const auto stress = [&](double h) {
        PointState<double> state = end.state;
        state.deformation_gradient += h * H;
        state.deformation_rate.setZero();
        state.time_step = 0.0;
        Hist history = end.after;
        return respond(material, state, history).stress;
      };
      const auto error = [&](double h) { return ((stress(h) - stress(-h)) / (2.0 * h) - slope).norm(); };
      const double coarse = error(4.0e-3), fine = error(1.0e-3);
      if (std::isnan(coarse) || std::isnan(fine)) return 0.0;
      const double round_off = 1.0e-11 * std::max(scale, slope.norm());
      if (fine > round_off) lowest = std::min(lowest, std::log2(coarse / fine) / 2.0);
    }
    return lowest;
  }

  /// Lanes against scalars along the paths, every lane on its own path.
  [[nodiscard]] double lanes_error() const {
    constexpr int W = 4;
    using L = Lanes<W>;
    double worst = 0.0;
    for (std::size_t first = 0; first < paths.size(); ++first) {
      tactoid::HistoryOf<M, L> history;
      Response<L> response;
      const auto path = [&](int l) -> const GatePath& {
        return paths[(first + static_cast<std::size_t>(l)) % paths.size()];
      };
      for (int k = 1; k <= steps; ++k) {
        PointState<L> state;
        for (int l = 0; l < W; ++l)
          set_state(state, path(l).at(static_cast<double>(k) / steps, options.time_step),
                    [l](L& to, double from) { set_lane(to, l, from); });
        response = respond(material, state, history);
      }
      for (int l = 0; l < W; ++l) {
        const Response<double> single = walk(path(l)).response;
        Tensor3 P;
        for (int i = 0; i < 3; ++i)
          for (int K = 0; K < 3; ++K) P(i, K) = lane(response.stress(i, K), l);
        const double rate = path(l).at(1.0, 0.0).deformation_rate.norm();
        worst = std::max(worst, relative((P - single.stress).norm(), single.stress.norm()));
        worst = std::max(worst, relative(std::abs(lane(response.energy, l) - single.energy), std::abs(single.energy)));
        for (const double error : {lane(response.dissipated_power, l) - single.dissipated_power,
                                   lane(response.active_power, l) - single.active_power})
          worst = std::max(worst, relative(std::abs(error) / rate, single.stress.norm()));
      }
    }
    return worst;
  }

  struct Work {
    double total = 0.0;     // ∫ P : dF
    double energy = 0.0;    // change of the stored energy
    double dissipated = 0.0;
    double active = 0.0;
    double turnover = 0.0;  // ∫ |P : Ḟ| dt
    bool reports = false;   // anything but a stress
    [[nodiscard]] double gap() const { return total - energy - dissipated + active; }
  };

  /// Works along a path in n steps, by the trapezoidal rule.
  [[nodiscard]] Work work(const GatePath& path, int n) const {
    Work w;
    Hist history;
    const double dt = path.duration / n;
    PointState<double> state = path.at(0.0, 0.0);
    Response<double> old = respond(material, state, history);
    double old_power = contract(old.stress, state.deformation_rate);
    const double start = old.energy;
    for (int k = 1; k <= n; ++k) {
      state = path.at(static_cast<double>(k) / n, dt);
      const Response<double> r = respond(material, state, history);
      const double power = contract(r.stress, state.deformation_rate);
      w.total += 0.5 * dt * (old_power + power);
      w.turnover += 0.5 * dt * std::abs(old_power + power);
      w.dissipated += 0.5 * dt * (old.dissipated_power + r.dissipated_power);
      w.active += 0.5 * dt * (old.active_power + r.active_power);
      w.reports = w.reports || r.energy != 0.0 || r.dissipated_power != 0.0 || r.active_power != 0.0;
      old = r;
      old_power = power;
    }
    w.energy = old.energy - start;
    return w;
  }
};

}  // namespace detail

/// Checks a law as the library's own laws are checked:
///
///   const auto report = tactoid::material_gate(MyLaw{});
///   std::cout << report.text();
///   return report.passed() ? 0 : 1;
///
/// On random deformations and paths: the stress is the derivative of the energy (automatic differentiation); it turns
/// with the observer; the Cauchy stress is symmetric; the tangent agrees with differences to second order; Lanes give
/// what doubles give; work = change of energy + dissipated − active along paths. Reported, not required: stress and
/// energy at rest, and the smallest net work of closed cycles, which is required (>= 0) of a law that says
/// `static constexpr bool dissipative = true`. A law's history must be kept in the reference configuration (components
/// that do not turn with the observer). Throws ParameterError for options out of range, and what validate() throws.
template <Material M>
[[nodiscard]] GateReport material_gate(const M& material, const MaterialGateOptions& options = {}) {
  if (options.samples < 1) reject("MaterialGateOptions.samples", options.samples, "", "at least 1");
  if (!(options.amplitude > 0.0 && options.amplitude < 0.5))
    reject("MaterialGateOptions.amplitude", options.amplitude, "", "greater than 0 and less than 0.5");
  require_positive("MaterialGateOptions.time_step", options.time_step, "s");
  require_non_negative("MaterialGateOptions.director_gradient", options.director_gradient, "1/m");
  require_positive("MaterialGateOptions.tolerance", options.tolerance);
  if constexpr (requires { material.validate(); }) material.validate();

  const detail::GateRun<M> run{material, options};
  GateReport report;
  if constexpr (detail::HasEnergy<M>)
    report.at_most("stress - d energy/dF", run.stress_of_energy_error(), options.tolerance,
                   detail::HasStress<M> ? "" : "the stress is the derivative by construction");
  report.at_most("objectivity: P(Q F) - Q P(F)", run.objectivity_error(), options.tolerance);
  report.at_most("angular momentum: P F^T - F P^T", run.angular_momentum_error(), options.tolerance);
  report.at_least("order of differences to the tangent", run.tangent_order(), 1.9);
  report.at_most("Lanes - double", run.lanes_error(), options.tolerance);

  double gap = 0.0, net = std::numeric_limits<double>::infinity();
  bool reports = false;
  for (detail::GatePath path : run.paths) {
    const auto fine = run.work(path, 400), finer = run.work(path, 800);
    reports = reports || finer.reports;
    const double extrapolated = (4.0 * finer.gap() - fine.gap()) / 3.0;
    gap = std::max(gap, std::abs(extrapolated) / std::max(finer.turnover, 1e-300));
    path.closed = true;
    path.duration *= 2.0;
    const auto cycle = run.work(path, 400), cycle2 = run.work(path, 800);
    const double net_work = (4.0 * (cycle2.total + cycle2.active) - (cycle.total + cycle.active)) / 3.0;
    net = std::min(net, net_work / std::max(cycle2.turnover, 1e-300));
  }
  if (reports)
    report.at_most("work - energy - dissipated + active", gap, 1.0e-5, "relative to the work turned over");
  else
    report.note("work - energy - dissipated + active", gap,
                "not required: the law reports neither energy nor powers: its work is missing in the energy balance");
  constexpr bool dissipative = [] {
    if constexpr (requires { M::dissipative; }) return bool(M::dissipative);
    else return false;
  }();
  const char* of_cycles =
      "smallest net work of a cycle / work turned over; negative: the law gives energy for nothing";
  if constexpr (dissipative) report.at_least("dissipation in cycles", net, -1.0e-7, of_cycles);
  else report.note("dissipation in cycles", net, of_cycles);

  typename detail::GateRun<M>::Hist history;
  const Response<double> rest = respond(material, PointState<double>{}, history);
  report.note("energy at rest, J/m^3", rest.energy);
  report.note("stress at rest, Pa", rest.stress.norm(), "Frobenius norm of P at F = 1, h = 0");
  return report;
}

}  // namespace tactoid
