// Yang's branch, Q(t) = ∫ B(τ) e^{−(t−τ)/A₃} Ė(τ) dτ with B = A₁ + A₂ (I − 3): L. M. Yang, V. P. W. Shim, C. T. Lim,
// Int. J. Impact Eng. 2000, 24, 545 (I = I₂) and X. Zeng, S. Li, Soft Matter 2012, 8, 5765, eqn (8) (I = I₃).
// P = F S + J F Q. For small strains it is one Maxwell element beside a spring, of the modulus B at rest.
#include "studies.hpp"

#include <numbers>

#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/geometry/box.hpp>
#include <tactoid/geometry/jitter.hpp>
#include <tactoid/integrator/central_difference.hpp>
#include <tactoid/kernel/rkpm.hpp>
#include <tactoid/material/yang_visco.hpp>
#include <tactoid/observe/reaction.hpp>
#include <tactoid/quadrature/nodal_centroids.hpp>
#include <tactoid/simulation/simulation.hpp>

#include "driven.hpp"

namespace tactoid::verification {
namespace viscoelastic_study {
namespace {

constexpr double pi = std::numbers::pi;

template <class Invariant>
using Solid = YangVisco<ModifiedMooneyRivlin, Invariant>;

constexpr double a1 = 3.5e6, a2 = 8.3e5, a3 = 5.0e-6;  // the paper's substrate

template <class Invariant>
struct Named;
template <>
struct Named<ThirdInvariant> {
  static constexpr const char* name = "I3";
  static constexpr double rest_bracket = a1 - 2.0 * a2;
  static double bracket(const Tensor3& C) { return a1 + a2 * (C.determinant() - 3.0); }
};
template <>
struct Named<SecondInvariant> {
  static constexpr const char* name = "I2";
  static constexpr double rest_bracket = a1;
  static double bracket(const Tensor3& C) { return a1 + a2 * (0.5 * (C.trace() * C.trace() - (C * C).trace()) - 3.0); }
};

/// Storage and loss modulus.
struct Moduli {
  double storage = 0.0, loss = 0.0;
};

/// First Fourier coefficients of a stress that was sampled at equal steps over one cycle of the strain e sin ωt.
[[nodiscard]] Moduli moduli(const std::vector<double>& stress, double amplitude) {
  Moduli m;
  const auto n = static_cast<double>(stress.size());
  for (std::size_t k = 0; k < stress.size(); ++k) {
    const double phase = 2.0 * pi * static_cast<double>(k) / n;
    m.storage += 2.0 / n * stress[k] * std::sin(phase) / amplitude;
    m.loss += 2.0 / n * stress[k] * std::cos(phase) / amplitude;
  }
  return m;
}

/// Maxwell element of modulus B and relaxation time A₃ at w = ω A₃ (J. D. Ferry, Viscoelastic Properties of Polymers,
/// 1980, ch. 3): B w²/(1 + w²), B w/(1 + w²).
[[nodiscard]] Moduli maxwell(double B, double w) {
  return {B * w * w / (1.0 + w * w), B * w / (1.0 + w * w)};
}

/// The law alone under F = 1 + e sin(ωt) direction, in `steps` steps per cycle; of P_ij less its elastic part.
template <class Invariant>
[[nodiscard]] Moduli at_a_point(double w, int steps, int i, int j) {
  const Solid<Invariant> law{.a1 = a1, .a2 = a2, .a3 = a3};
  const double omega = w / a3, amplitude = 1e-5, dt = 2.0 * pi / omega / steps;
  const int cycles = 2 + static_cast<int>(30.0 * w / (2.0 * pi));  // the start has decayed by e⁻³⁰
  HistoryOf<Solid<Invariant>, double> history;
  std::vector<double> stress;
  for (int k = 1; k < (cycles + 1) * steps; ++k) {
    PointState<double> point;
    point.deformation_gradient(i, j) += amplitude * std::sin(2.0 * pi * (k % steps) / steps);
    point.time_step = dt;
    const Tensor3 P = respond(law, point, history).stress;
    if (k >= cycles * steps) stress.push_back((P - law.elastic.first_piola(point.deformation_gradient))(i, j));
  }
  return moduli(stress, amplitude);
}

/// A cube whose every particle follows F(t): the traction P e_y of its top face, from the reactions less the inertia,
/// and the time at which it acts, at every step of size `step` up to `end`. Its elastic part is taken away.
struct Traction {
  double time;
  Vector3 branch, elastic;
};
template <class Invariant>
[[nodiscard]] std::vector<Traction> driven_cube(const std::function<Tensor3(double)>& F, double step, double end) {
  const double edge = 40e-6;
  const PointCloud<3> cloud = jitter(box({.size = {edge, edge, edge}, .cells = {2, 2, 2}}), 0.2);
  const auto is_top = [&](const Point<3>& X) { return X[1] > edge * (1.0 - 1e-9); };
  const auto top = select(cloud, is_top), rest = select(cloud, [&](const Point<3>& X) { return !is_top(X); });
  const Solid<Invariant> law{.a1 = a1, .a2 = a2, .a3 = a3};
  Body cube{"cube", cloud, Rkpm<3>{}, NodalCentroids{}, Materials{Region{"body", law}}};
  Simulation simulation{Bodies{std::move(cube)}, Contacts{}, Boundaries{on<0>(affine(top, F)), on<0>(affine(rest, F))},
                        CentralDifference{.time_step = step}};
  std::vector<Traction> history;
  simulation.run(end, every_steps(1, [&](auto& s) {
                   if (s.steps() < 2) return;  // the second difference below takes three instants
                   const double t = s.time() - s.last_time_step();
                   const Tensor3 acceleration = (F(t + step) - 2.0 * F(t) + F(t - step)) / (step * step);
                   Vector3 inertia = Vector3::Zero();
                   for (const Index i : top)
                     inertia += s.template body<0>().masses()[i] * (acceleration * cloud.positions[i]);
                   const Vector3 elastic = law.elastic.first_piola(F(t)).col(1);
                   const Vector3 total = (reactions<0>(s).conditions[0] - inertia) / (edge * edge);
                   history.push_back({t, total - elastic, elastic});
                 }));
  return history;
}

/// J F Q e_y under F(t) = 1 + sin(ωt) H from rest, by Simpson's rule for the hereditary integral.
template <class Invariant>
class HereditaryIntegral {
 public:
  HereditaryIntegral(const Tensor3& H, double omega, double end, int intervals)
      : H_(H), omega_(omega), step_(end / intervals), Q_{Tensor3::Zero()} {
    const double decay = std::exp(-step_ / a3), half = std::exp(-0.5 * step_ / a3);
    for (int k = 0; k < intervals; ++k) {
      const double t = step_ * k;
      Q_.push_back(decay * Q_.back() +
                   step_ / 6.0 * (decay * rate(t) + 4.0 * half * rate(t + 0.5 * step_) + rate(t + step_)));
    }
  }
  [[nodiscard]] Vector3 traction(double t) const {
    const auto k = static_cast<std::size_t>(std::lround(t / step_));
    const Tensor3 F = deformation(t);
    return (F.determinant() * F * Q_.at(k)).col(1);
  }
  [[nodiscard]] Tensor3 deformation(double t) const { return Tensor3::Identity() + std::sin(omega_ * t) * H_; }

 private:
  [[nodiscard]] Tensor3 rate(double t) const {  // B Ė
    const Tensor3 F = deformation(t), F_rate = omega_ * std::cos(omega_ * t) * H_;
    return Named<Invariant>::bracket(F.transpose() * F) * 0.5 * (F_rate.transpose() * F + F.transpose() * F_rate);
  }
  Tensor3 H_;
  double omega_, step_;
  std::vector<Tensor3> Q_;
};

template <class Invariant>
void study_invariant(Report& report, Level level) {
  const std::string I = Named<Invariant>::name;
  const double B = Named<Invariant>::rest_bracket;

  // A sudden strain of a block: F jumps at t = 0 and stays.
  const Tensor3 F0 = (Tensor3() << 1.05, 0.2, 0.0, 0.0, 0.9, 0.1, 0.0, 0.0, 1.02).finished();
  const auto held = driven_cube<Invariant>([&](double) { return F0; }, 2.5e-8, 2.0 * a3);
  auto relaxation = report.table("relaxation_" + I, {"time_s", "branch_Pa", "exact_Pa"});
  double worst = 0.0;
  for (const Traction& now : held) {
    const double exact = held[0].branch.norm() * std::exp(-(now.time - held[0].time) / a3);
    worst =
        std::max(worst, (now.branch - held[0].branch / held[0].branch.norm() * exact).norm() / held[0].branch.norm());
    relaxation.write(std::array{now.time, now.branch.norm(), exact});
  }
  report.at_most(I + ": step strain of a block, branch less exp(-t/A3), over the first", worst, 1e-11,
                 "exact: Q decays as exp(-t/A3)");
  // That Q starts from B E: one half of B (E and 0) along the straight path, to the size of the strain.
  const double tiny = 1e-6;
  Tensor3 shear = Tensor3::Identity();
  shear(0, 1) = tiny;
  const Traction first = driven_cube<Invariant>([&](double) { return shear; }, 2.5e-8, 1e-7).front();
  report.compare(I + ": shear modulus of a sudden small strain, branch, Pa",
                 first.branch[0] / tiny * std::exp(first.time / a3), 0.5 * B, 1e-5, "B/2, B = bracket at rest");

  // Small harmonic strain: the point.
  auto table = report.table("moduli_" + I, {"omega_A3", "storage_Pa", "loss_Pa", "storage_exact_Pa", "loss_exact_Pa"});
  double shear_error = 0.0, stretch_error = 0.0;
  for (const double w : {0.1, 0.3, 1.0, 3.0, 10.0}) {
    const int steps = static_cast<int>(800.0 / std::min(w, 1.0));  // of 0.008 A₃ or less
    const Moduli exact = maxwell(0.5 * B, w), m = at_a_point<Invariant>(w, steps, 0, 1);
    const Moduli twice = maxwell(B, w), n = at_a_point<Invariant>(w, steps, 2, 2);
    const auto error = [](const Moduli& a, const Moduli& b) {
      return std::max(std::abs(a.storage / b.storage - 1.0), std::abs(a.loss / b.loss - 1.0));
    };
    shear_error = std::max(shear_error, error(m, exact));
    stretch_error = std::max(stretch_error, error(n, twice));
    table.write(std::array{w, m.storage, m.loss, exact.storage, exact.loss});
  }
  report.at_most(I + ": storage and loss in shear, omega A3 = 0.1 to 10, largest error", shear_error, 1e-5,
                 "Maxwell element of B/2 (Ferry 1980)");
  report.at_most(I + ": storage and loss in stretch, omega A3 = 0.1 to 10, largest error", stretch_error, 1e-5,
                 "Maxwell element of B");
  const auto point_error = [&](int steps) {
    const Moduli m = at_a_point<Invariant>(1.0, steps, 0, 1), exact = maxwell(0.5 * B, 1.0);
    return std::hypot(m.storage - exact.storage, m.loss - exact.loss) / B;
  };
  report.at_least(I + ": order in the time step, harmonic shear of a point", order(point_error(40), point_error(80)),
                  1.95, "second order");

  // The same of a block: reactions on its top face, ω A₃ = 1.
  const double omega = 1.0 / a3, period = 2.0 * pi / omega;
  const auto block_moduli = [&](int steps) {
    const int cycles = 4;  // e⁻²⁵ of the start is left
    const auto history = driven_cube<Invariant>(
        [&](double t) {
          Tensor3 F = Tensor3::Identity();
          F(0, 1) = 1e-5 * std::sin(omega * t);
          return F;
        },
        period / steps, period * (cycles + 1) + period / steps);
    std::vector<double> stress;
    for (const Traction& now : history)
      if (now.time > period * (cycles - 0.5 / steps)) stress.push_back(now.branch[0]);
    stress.resize(static_cast<std::size_t>(steps));
    return moduli(stress, 1e-5);
  };
  const Moduli coarse = block_moduli(400), fine = block_moduli(800), exact = maxwell(0.5 * B, 1.0);
  report.compare(I + ": storage modulus of a block in shear, omega A3 = 1, Pa", fine.storage, exact.storage, 1e-5,
                 "Maxwell element of B/2; reactions");
  report.compare(I + ": loss modulus of a block in shear, omega A3 = 1, Pa", fine.loss, exact.loss, 1e-5,
                 "Maxwell element of B/2; reactions");
  const auto distance = [&](const Moduli& m) { return std::hypot(m.storage - exact.storage, m.loss - exact.loss); };
  report.at_least(I + ": order in the time step, harmonic shear of a block", order(distance(coarse), distance(fine)),
                  1.95, "second order");

  // Large harmonic strain of the block, where the bracket changes with I: against the hereditary integral.
  const Tensor3 H = (Tensor3() << 0.1, 0.4, 0.0, 0.05, -0.15, 0.1, 0.0, 0.1, 0.12).finished();
  const double end = 1.25 * period;
  const HereditaryIntegral<Invariant> integral(H, omega, end, level == Level::full ? 16000 : 8000);
  const auto large_error = [&](int steps) {
    const auto history = driven_cube<Invariant>([&](double t) { return integral.deformation(t); }, period / steps, end);
    double difference = 0.0, largest = 0.0;
    for (const Traction& now : history) {
      const Vector3 reference = integral.traction(now.time);
      difference = std::max(difference, (now.branch - reference).norm());
      largest = std::max(largest, reference.norm());
    }
    return difference / largest;
  };
  const double at_800 = large_error(800), at_1600 = large_error(1600);
  report.at_most(I + ": large harmonic strain of a block, traction of the branch, error", at_1600, 1e-5,
                 "hereditary integral by Simpson's rule");
  report.at_least(I + ": order in the time step, large harmonic strain of a block", order(at_800, at_1600), 1.9,
                  "second order");
}

}  // namespace
}  // namespace viscoelastic_study

void viscoelastic(Report& report, Level level) {
  using namespace viscoelastic_study;
  study_invariant<ThirdInvariant>(report, level);
  study_invariant<SecondInvariant>(report, level);
}

}  // namespace tactoid::verification
