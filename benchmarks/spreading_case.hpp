#pragma once

#include <utility>

#include <common/spreading_parameters.hpp>

#include <tactoid/tactoid.hpp>

namespace tactoid {

/// The cell of the paper on its substrate, 4341 + 16640 particles, as the example spreading_uniform composes it.
struct SpreadingCase {
  SpreadingParameters p;

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
                Materials{Region{"body", p.substrate_law(p.stiffness)}}};
  }
  /// Everything on: both contacts, anchoring, surface tension, the fixed bottom.
  [[nodiscard]] auto simulation() const {
    auto substrate_body = substrate();
    auto bottom =
        select(substrate_body.cloud(), [&](const Point<3>& X) { return X[2] < -p.substrate_height * (1.0 - 1e-9); });
    return Simulation{Bodies{cell(), std::move(substrate_body)},
                      Contacts{between<0, 1>(p.ligand_receptor()), between<0, 1>(p.van_der_waals_force()),
                               between<0, 1>(ContactAnchoring{.capture_distance = p.bond_range})},
                      Boundaries{on<0>(SurfaceTension{.tension = p.surface_tension}), on<1>(fixed(std::move(bottom)))},
                      CentralDifference{.safety = p.safety}};
  }
};

}  // namespace tactoid
