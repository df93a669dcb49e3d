#pragma once

#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <tactoid/tactoid.hpp>

#include <common/spreading_parameters.hpp>

namespace tactoid {

/// What a study adds to the case: contacts, and columns of the history with their values at an instant. This one adds nothing.
struct NothingAdded {
  [[nodiscard]] std::tuple<> contacts() const { return {}; }
  [[nodiscard]] std::vector<std::string> columns() const { return {}; }
  template <class S>
  [[nodiscard]] std::vector<double> values(S&) const {
    return {};
  }
};

/// Number in the simulation of the first contact that a study adds.
inline constexpr std::size_t first_added_contact = 3;

/// The cell of the paper on its substrate: how the spreading examples and the benchmarks compose it.
/// `substrate_law`: a law or Graded, as SpreadingParameters::substrate_law gives it. D = 2: in the meridian section, with
/// `substrate_law` a function of that place. `added`: more contacts and columns, such as NothingAdded. Real: double, or
/// float for gradients that are stored in single precision.
template <MaterialSource Law, int D = 3, class Added = NothingAdded, class Real = double>
struct SpreadingCase {
  SpreadingParameters p;
  Law substrate_law;
  Added added = {};

  [[nodiscard]] auto quadrature() const {
    if constexpr (std::is_same_v<Real, double>) return p.quadrature();
    else return stored_as<Real>(p.quadrature());
  }
  [[nodiscard]] auto cell() const {
    PointCloud<D> cloud = p.cell_cloud<D>();
    Field director = p.director_field(cloud);
    return Body{"cell",
                std::move(cloud),
                Rkpm<D>{.support = p.support},
                quadrature(),
                Materials{Region{"nucleus", p.nucleus_law()}, Region{"cytoplasm", p.cytoplasm_law()}},
                DirectorField<>{.diffusivity = p.diffusivity, .core_size = p.core_size},
                std::move(director)};
  }
  [[nodiscard]] auto substrate() const {
    return Body{"substrate", p.substrate_cloud<D>(), Rkpm<D>{.support = p.support}, quadrature(),
                Materials{Region{"body", substrate_law}}};
  }
  /// Everything on: both contacts, anchoring, what is added, surface tension, the fixed bottom.
  [[nodiscard]] auto simulation() const {
    const SubcycledCentralDifference integrator{{.safety = p.safety, .time_step = p.time_step, .min_time_step = p.min_time_step}, p.subcycling};
    integrator.validate();  // before bodies are built
    return simulation(integrator);
  }
  /// The same under another integrator.
  template <class Integrator>
  [[nodiscard]] auto simulation(const Integrator& integrator) const {
    auto cell_body = cell();
    auto substrate_body = substrate();
    const auto bottom =
        select(substrate_body.cloud(), [&](const Point<D>& X) { return X[D - 1] < -p.substrate_height * (1.0 - 1e-9); });
    auto contacts = std::apply(
        [&](auto... more) {
          return Contacts{between<0, 1>(p.ligand_receptor()), between<0, 1>(p.van_der_waals_force()),
                          between<0, 1>(ContactAnchoring{.capture_distance = p.anchoring ? p.bond_range : 1e-30, .interval = synchronous<Integrator> ? 1 : 10}),
                          std::move(more)...};
        },
        added.contacts());
    return Simulation{
        Bodies{std::move(cell_body), std::move(substrate_body)}, std::move(contacts),
        Boundaries{on<0>(SurfaceTension{.tension = p.surface_tension, .smoothing = p.surface_smoothing}), on<1>(fixed(bottom))},
        integrator};
  }
};
template <MaterialSource Law>
SpreadingCase(SpreadingParameters, Law) -> SpreadingCase<Law>;
template <MaterialSource Law, class Added>
SpreadingCase(SpreadingParameters, Law, Added) -> SpreadingCase<Law, 3, Added>;

/// The same in the meridian section. Throws ParameterError for what is not axisymmetric.
template <MaterialSource Law>
[[nodiscard]] SpreadingCase<Law, 2> axisymmetric_case(const SpreadingParameters& p, const Law& substrate_law) {
  p.validate_axisymmetric();
  return {p, substrate_law};
}

}  // namespace tactoid
