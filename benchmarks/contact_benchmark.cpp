// Contact and boundary terms at the paper's size: one evaluation on the cell 200 nm above its substrate.
#include "report.hpp"
#include <common/spreading_parameters.hpp>

namespace {

using namespace tactoid;

/// The two clouds with fields at rest, and the number of points that a term samples.
struct Pair {
  SpreadingParameters p;
  PointCloud<3> cell = p.cell_cloud<3>(), substrate = p.substrate_cloud<3>();
  struct Fields {
    Field reference, position, velocity, force;
    std::vector<double> mass, volume;
    explicit Fields(const PointCloud<3>& cloud) : volume(nodal_volumes(cloud)) {
      for (const Point<3>& X : cloud.positions) reference.push_back(pad(X));
      position = reference;
      velocity.assign(cloud.size(), Vector4::Zero());
      force = velocity;
      mass = volume;
      for (double& m : mass) m *= 1000.0;
    }
    [[nodiscard]] ParticleFields view() { return {reference, position, velocity, mass, volume, force}; }
  } a{cell}, b{substrate};
};

/// The cell moves back and forth by a nanometre, so that closest points are tracked as in a run.
template <class Term>
void contact(benchmark::State& state, Term term, std::size_t points) {
  set_thread_count(1);
  Pair pair;
  term.initialize(pair.cell, pair.a.view(), pair.substrate, pair.b.view());
  double shift = 1e-9;
  measure(state,
          [&] {
            for (Vector4& x : pair.a.position) x[0] += shift;
            shift = -shift;
            benchmark::DoNotOptimize(term.apply(pair.a.view(), pair.b.view(), 0.0));
          },
          {{"ns_per_point", points}});
  state.counters["points"] = static_cast<double>(points);
}

template <class Term>
void boundary(benchmark::State& state, Term term, std::size_t points) {
  set_thread_count(1);
  Pair pair;
  term.initialize(pair.cell, pair.a.view());
  measure(state, [&] { benchmark::DoNotOptimize(term.apply(pair.a.view(), 0.0)); }, {{"ns_per_point", points}});
  state.counters["points"] = static_cast<double>(points);
}

void ligand_receptor(benchmark::State& state) {
  const SpreadingParameters p;
  contact(state, p.ligand_receptor(), 4 * p.cell_cloud<3>().facets.size());
}
void van_der_waals(benchmark::State& state) {
  const SpreadingParameters p;
  contact(state, p.van_der_waals_force(), p.cell_cloud<3>().size());
}
void anchoring(benchmark::State& state) {  // looks at the gaps in every tenth step
  contact(state, ContactAnchoring{}, SpreadingParameters{}.cell_cloud<3>().facets.size());
}
void surface_tension(benchmark::State& state) {
  boundary(state, SurfaceTension{}, 4 * SpreadingParameters{}.cell_cloud<3>().facets.size());
}
void curvature_surface_tension(benchmark::State& state) {
  boundary(state, CurvatureSurfaceTension{}, 4 * SpreadingParameters{}.cell_cloud<3>().facets.size());
}

BENCHMARK(ligand_receptor)->Unit(benchmark::kMicrosecond);
BENCHMARK(van_der_waals)->Unit(benchmark::kMicrosecond);
BENCHMARK(anchoring)->Unit(benchmark::kMicrosecond);
BENCHMARK(surface_tension)->Unit(benchmark::kMicrosecond);
BENCHMARK(curvature_surface_tension)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
