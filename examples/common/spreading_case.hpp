#pragma once

#include <utility>

#include <tactoid/tactoid.hpp>

#include <common/spreading_parameters.hpp>

namespace tactoid {

/// The cell of the paper on its substrate: how the spreading examples and the benchmarks compose it.
/// `substrate_law`: a law or Graded, as SpreadingParameters::substrate_law gives it.
template <MaterialSource Law>
struct SpreadingCase {
  SpreadingParameters p;
  Law substrate_law;

  [[nodiscard]] auto cell() const {
    PointCloud<3> cloud = p.cell_cloud();
    Field director = p.director_field(cloud);
    return Body{"cell",
                std::move(cloud),
                Rkpm<3>{.support = p.support},
                p.quadrature(),
                Materials{Region{"nucleus", p.nucleus_law()}, Region{"cytoplasm", p.cytoplasm_law()}},
                DirectorField<>{.diffusivity = p.diffusivity, .core_size = p.core_size},
                std::move(director)};
  }
  [[nodiscard]] auto substrate() const {
    return Body{"substrate", p.substrate_cloud(), Rkpm<3>{.support = p.support}, p.quadrature(),
                Materials{Region{"body", substrate_law}}};
  }
  /// Everything on: both contacts, anchoring, surface tension, the fixed bottom.
  [[nodiscard]] auto simulation() const {
    auto cell_body = cell();
    auto substrate_body = substrate();
    const auto bottom =
        select(substrate_body.cloud(), [&](const Point<3>& X) { return X[2] < -p.substrate_height * (1.0 - 1e-9); });
    return Simulation{
        Bodies{std::move(cell_body), std::move(substrate_body)},
        Contacts{between<0, 1>(p.ligand_receptor()), between<0, 1>(p.van_der_waals_force()),
                 between<0, 1>(ContactAnchoring{.capture_distance = p.anchoring ? p.bond_range : 1e-30})},
        Boundaries{on<0>(SurfaceTension{.tension = p.surface_tension}), on<1>(fixed(bottom))},
        CentralDifference{.safety = p.safety, .time_step = p.time_step}};
  }
};

}  // namespace tactoid
