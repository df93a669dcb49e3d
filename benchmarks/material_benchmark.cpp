// The laws: one point-wise response, in lanes and one point at a time, and one evaluation of the internal forces of a
// block of each material.
#include <array>
#include <string>

#include "report.hpp"
#include <common/spreading_parameters.hpp>

namespace {

using namespace tactoid;

/// A law known by its energy alone: the stress is found by automatic differentiation.
struct EnergyOnly {
  double density = 1000.0;
  NeoHookean law{};
  [[nodiscard]] double wave_speed() const { return law.wave_speed(); }
  [[nodiscard]] double shear_modulus() const { return law.shear_modulus(); }
  template <class T>
  [[nodiscard]] T energy(const Tensor<T>& F) const {
    return law.energy(F);
  }
};

/// A state away from rest in every respect, the same in all lanes but for its size.
template <class T>
PointState<T> some_state() {
  PointState<T> state;
  state.time_step = 1e-9;
  for (int l = 0; l < lane_count<T>; ++l)
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        const double x = 0.01 * (3 * i - 2 * k + 1 + l);
        set_lane(state.deformation_gradient(i, k), l, (i == k ? 1.0 : 0.0) + x);
        set_lane(state.deformation_rate(i, k), l, 1e5 * x);
        set_lane(state.director_gradient(i, k), l, 1e5 * x);
      }
      set_lane(state.director(i), l, 0.5 + 0.1 * i);
    }
  return state;
}

template <class T, class Law>
void response(benchmark::State& state, const Law& law) {
  set_thread_count(1);
  constexpr std::size_t blocks = 64;
  std::array<PointState<T>, blocks> points;
  points.fill(some_state<T>());
  std::array<HistoryOf<Law, T>, blocks> histories{};
  measure(state,
          [&] {
            for (std::size_t b = 0; b < blocks; ++b) {
              benchmark::DoNotOptimize(points[b]);
              Response<T> r = respond(law, points[b], histories[b]);
              benchmark::DoNotOptimize(r);
            }
          },
          {{"ns_per_point", blocks * static_cast<std::size_t>(lane_count<T>)}});
}

/// One evaluation of the internal forces of a block of 20³ cells (9261 particles with about 50 neighbours each), bent.
template <class Law>
void internal_forces(benchmark::State& state, const Law& law) {
  set_thread_count(1);
  const double edge = 5e-6;
  auto cloud = box({.size = {edge, edge, edge}, .cells = {20, 20, 20}});
  const Rkpm<3> kernel{.support = 2.35};
  const auto compose = [&] {
    if constexpr (uses_director<LawOf<Law>>)
      return Body{"block", cloud, kernel, NodalCentroids{}, Materials{Region{"body", law}}, DirectorField<>{},
                  RandomDirector{}};
    else
      return Body{"block", cloud, kernel, NodalCentroids{}, Materials{Region{"body", law}}};
  };
  auto body = compose();
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3 X = cloud.positions[i] / edge;
    body.displacement[i] = pad(Vector3(0.02 * edge * X[2] * X[2], 0.0, 0.01 * edge * X[0]));
    body.velocity[i] = pad(Vector3(0.1 * X[2] * X[2], 0.0, 0.05 * X[0]));
  }
  measure(state, [&] { benchmark::DoNotOptimize(body.add_internal_forces(1e-9, true)); },
          {{"ns_per_point", body.table().points()}, {"ns_per_pair", body.table().pairs()}});
  describe(state, body);
}

template <class Law>
void add(const std::string& name, const Law& law) {
  benchmark::RegisterBenchmark(("response_in_lanes/" + name).c_str(),
                               [law](benchmark::State& s) { response<LoopLanes>(s, law); });
  benchmark::RegisterBenchmark(("response_scalar/" + name).c_str(),
                               [law](benchmark::State& s) { response<double>(s, law); });
  benchmark::RegisterBenchmark(("internal_forces/" + name).c_str(),
                               [law](benchmark::State& s) { internal_forces(s, law); })
      ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  const SpreadingParameters p;
  add("NeoHookean", NeoHookean{});
  add("NeoHookean_by_energy", EnergyOnly{});
  add("ModifiedMooneyRivlin", p.nucleus_law());
  add("YangVisco", p.substrate_law(10.0));
  add("NematicGel", p.cytoplasm_law());
  const auto graded = Graded{[p](const Vector3& X) { return p.substrate_law(2.0 + X[0] / 1e-6); }};
  benchmark::RegisterBenchmark("internal_forces/Graded_YangVisco",
                               [graded](benchmark::State& s) { internal_forces(s, graded); })
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
