#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>

#include <tactoid/tactoid.hpp>

#include <common/options.hpp>

namespace tactoid {

/// The substrate of the paper, of a stiffness that depends on the place.
using GradedSubstrate = Graded<std::function<YangVisco<>(const Vector3&)>>;

/// Factors on the constants of the base substrate on its two sides.
struct StiffnessGradient {
  double soft = 2.0;    ///< at +x
  double stiff = 10.0;  ///< at −x

  void add_to(Options& options) {
    options.add("soft", &soft, Range::positive(), "Factor on the constants of the base substrate on the side +x");
    options.add("stiff", &stiff, Range::positive(), "Factor on the constants of the base substrate on the side -x");
  }
};

/// Parameters of a cell that spreads on a substrate. The defaults are those of Zeng and Li, Soft Matter 2012, 8, 5765;
/// those that the paper does not give are marked, with their reason.
struct SpreadingParameters {
  // Geometry and resolution
  double radius = 5.0e-6;           ///< of the cell, m
  double nucleus = 0.382;           ///< radius of the nucleus over that of the cell
  double substrate_radius = 15e-6;  ///< m
  double substrate_height = 5e-6;   ///< m
  double gap = 200e-9;              ///< initial gap, m
  double resolution = 1.0;          ///< scales the numbers of cells in each direction; 1: 4341 + 16640 particles
  double contact_refinement = 1.0;  ///< facets of the cell below 55 degrees from its lowest point are so many times as small
  double turn = 0.0;                ///< of both meshes around z, rad: what turns with it is the mesh's doing

  // Cell
  double density = 1000.0;  ///< of nucleus and cytoplasm, kg/m³
  // Nucleus
  double nucleus_c1 = 2126.0, nucleus_c2 = 170.0, nucleus_lambda = 1.7e5;  ///< Pa
  // Cytoplasm
  double viscosity = 0.003;            ///< μ, Pa·s. Not in the paper: that of the fluid phase of cytosol
  double bulk_modulus = 6.8e5;         ///< K, Pa. Not in the paper: 4 λ of the nucleus
  double activity = -1.0;              ///< ζ, Pa: the paper's −0.001 if its unit is kPa
  double director_elasticity = 1e-12;  ///< η, N. Not in the paper: the scale of a Frank constant
  double diffusivity = 1e-7;           ///< γ/ρᵈ, m²/s. Not in the paper: the director relaxes within microseconds
  double core_size = 0.5e-6;           ///< ε_d, m. Not in the paper: the particle spacing
  std::string director = "random";     ///< random, uniform or radial at the start. Not in the paper
  double correlation_length = 2e-6;    ///< of the random director, m
  std::uint64_t seed = 1;              ///< of the random director
  bool anchoring = true;               ///< the director is held where the cell touches

  // Substrate
  std::string preset = "printed";  ///< viscous constants: printed, viscous/10 or elastic
  double substrate_density = 1000.0;                                                  ///< kg/m³
  double substrate_c1 = 1.265e4, substrate_c2 = 1.012e3, substrate_lambda = 1.012e6;  ///< base, Pa
  double a1 = 3.5e6, a2 = 8.3e5, a3 = 5e-6;                                           ///< Pa, Pa, s

  // Adhesion and surface
  double van_der_waals = 1e6;          ///< G, N/kg
  double van_der_waals_range = 10e-6;  ///< d₀, m
  bool van_der_waals_reaction = false;
  double bond_density = 500e12;       ///< N_b, 1/m²
  double binding_energy = 0.024e-18;  ///< σ_b, J
  double bond_range = 100e-9;         ///< ε, m
  std::string bonds_on = "cell";      ///< whose surface bonds are counted and sampled on: cell or substrate
  int contact_points = 2;             ///< quadrature points along each side of a facet of that surface, for bonds
  std::string bond_area = "reference";  ///< bonds are as many per area: reference (of the matter) or mobile (of the present surface, which is a fluid)
  double surface_tension = 0.072e-3;  ///< σ₀, N/m
  double surface_smoothing = 0.0;     ///< share of its size below which a facet's tension fades

  // Numerics
  double support = 1.75;           ///< of the kernel, per longest edge
  double hourglass = 0.12;         ///< stabilisation modulus over the shear modulus, in the solids
  double fluid_hourglass = 5.0;    ///< stabilisation modulus of the cytoplasm, Pa
  double fluid_hourglass_viscosity = 2.5e-5;  ///< stabilisation viscosity of the cytoplasm, Pa s
  double safety = 0.8;             ///< of the stable time step
  double time_step = 0.0;          ///< s; 0: chosen by the library
  double min_time_step = 1e-15;    ///< s; a run whose stable step is shorter stops
  double substrate_mass_scaling = 1.0;  ///< masses of the substrate over its true ones, >= 1: steps become longer by up to its square root
  int subcycling = 1;              ///< largest ratio of the steps of the two bodies, a power of two; 1: they are the same
  double end_time = 5e-6;          ///< s

  void add_to(Options& options) {
    options.add_quantity("end-time", &end_time, Quantity::time, Range::positive(), "Simulated time");
    options.add_choice("preset", &preset, {"printed", "viscous/10", "elastic"},
                       "Viscous constants of the substrate: as printed, a tenth, or none");
    options.add("nucleus", &nucleus, Range::inside(0.0, 1.0), "Radius of the nucleus over that of the cell");
    options.add("resolution", &resolution, Range::between(0.2, 10.0),
                "Scales the numbers of cells in each direction; 1 is 4341 + 16640 particles");
    options.add("contact-refinement", &contact_refinement, Range::between(1.0, 2.5),
                "Facets of the cell below 55 degrees from its lowest point are so many times as small, the others larger; 1: all alike");
    options.add_quantity("turn", &turn, Quantity::angle, Range::any(), "Turns the particles of both bodies around z");
    options.add_quantity("radius", &radius, Quantity::length, Range::positive(), "Radius of the cell");
    options.add_quantity("substrate-radius", &substrate_radius, Quantity::length, Range::positive(),
                         "Radius of the substrate");
    options.add_quantity("substrate-height", &substrate_height, Quantity::length, Range::positive(),
                         "Height of the substrate");
    options.add_quantity("gap", &gap, Quantity::length, Range::positive(), "Initial gap between cell and substrate");
    options.add_quantity("density", &density, Quantity::density, Range::positive(), "Density of the cell");
    options.add_quantity("substrate-density", &substrate_density, Quantity::density, Range::positive(),
                         "Density of the substrate");
    options.add_quantity("viscosity", &viscosity, Quantity::viscosity, Range::non_negative(),
                         "Viscosity of the cytoplasm");
    options.add_quantity("bulk-modulus", &bulk_modulus, Quantity::pressure, Range::positive(),
                         "Bulk modulus of the cytoplasm");
    options.add_quantity("activity", &activity, Quantity::pressure, Range::any(),
                         "Active stress of the cytoplasm; negative is contractile");
    options.add_quantity("director-elasticity", &director_elasticity, Quantity::force, Range::non_negative(),
                         "Elastic constant of the director in the stress");
    options.add("diffusivity", &diffusivity, Range::positive(), "Diffusivity of the director, m^2/s");
    options.add_quantity("core-size", &core_size, Quantity::length, Range::positive(),
                         "Core size of defects of the director");
    options.add_choice("director", &director, {"random", "uniform", "radial"}, "The director at the start");
    options.add_quantity("correlation-length", &correlation_length, Quantity::length, Range::positive(),
                         "Correlation length of the random director");
    options.add("seed", &seed, Range::non_negative(), "Seed of the random director");
    options.add("anchoring", &anchoring, "Hold the director where the cell touches");
    options.add_quantity("nucleus-c1", &nucleus_c1, Quantity::pressure, Range::positive(), "C1 of the nucleus");
    options.add_quantity("nucleus-c2", &nucleus_c2, Quantity::pressure, Range::non_negative(), "C2 of the nucleus");
    options.add_quantity("nucleus-lambda", &nucleus_lambda, Quantity::pressure, Range::positive(),
                         "Lambda of the nucleus");
    options.add_quantity("substrate-c1", &substrate_c1, Quantity::pressure, Range::positive(),
                         "C1 of the base substrate");
    options.add_quantity("substrate-c2", &substrate_c2, Quantity::pressure, Range::non_negative(),
                         "C2 of the base substrate");
    options.add_quantity("substrate-lambda", &substrate_lambda, Quantity::pressure, Range::positive(),
                         "Lambda of the base substrate");
    options.add_quantity("a1", &a1, Quantity::pressure, Range::any(), "A1 of the substrate's viscous part, as printed");
    options.add_quantity("a2", &a2, Quantity::pressure, Range::any(), "A2 of the substrate's viscous part, as printed");
    options.add_quantity("a3", &a3, Quantity::time, Range::positive(),
                         "A3, relaxation time of the substrate's viscous part");
    options.add_quantity("van-der-waals", &van_der_waals, Quantity::acceleration, Range::non_negative(),
                         "Strength G of the van der Waals force");
    options.add_quantity("van-der-waals-range", &van_der_waals_range, Quantity::length, Range::positive(),
                         "Range d0 of the van der Waals force");
    options.add("van-der-waals-reaction", &van_der_waals_reaction,
                "The van der Waals force acts back on the substrate");
    options.add_quantity("bond-density", &bond_density, Quantity::number_density, Range::non_negative(),
                         "Ligand-receptor bonds per area");
    options.add_quantity("binding-energy", &binding_energy, Quantity::energy, Range::non_negative(),
                         "Energy of a bond");
    options.add_quantity("bond-range", &bond_range, Quantity::length, Range::positive(), "Range epsilon of the bonds");
    options.add_choice("bonds-on", &bonds_on, {"cell", "substrate"}, "Whose surface bonds are counted and sampled on, ligand-receptor bonds and tethers");
    options.add("contact-points", &contact_points, Range::between(1, 4), "Quadrature points along each side of a facet of that surface, for bonds");
    options.add_choice("bond-area", &bond_area, {"reference", "mobile"},
                       "Bonds are as many per area of the matter, or per present area of a fluid surface, whose tension they lower");
    options.add_quantity("surface-tension", &surface_tension, Quantity::surface_tension, Range::non_negative(),
                         "Surface tension of the cell");
    options.add("surface-smoothing", &surface_smoothing, Range::between(0.0, 0.9), "Share of its first size below which the tension of a facet fades");
    options.add("support", &support, Range::between(1.2, 4.0), "Support of the kernel per longest cell edge");
    options.add("hourglass", &hourglass, Range::non_negative(), "Stabilisation over shear modulus in the solids");
    options.add_quantity("fluid-hourglass", &fluid_hourglass, Quantity::pressure, Range::non_negative(),
                         "Stabilisation modulus of the cytoplasm");
    options.add_quantity("fluid-hourglass-viscosity", &fluid_hourglass_viscosity, Quantity::viscosity, Range::non_negative(),
                         "Stabilisation viscosity of the cytoplasm");
    options.add("safety", &safety, Range::between(0.01, 1.0), "Fraction of the stable time step");
    options.add_quantity("time-step", &time_step, Quantity::time, Range::non_negative(),
                         "Fixed time step; 0: chosen by the program");
    options.add_quantity("min-time-step", &min_time_step, Quantity::time, Range::non_negative(),
                         "A run whose stable time step is shorter stops");
    options.add("substrate-mass-scaling", &substrate_mass_scaling, Range::between(1.0, 1e6),
                "The substrate is so many times as heavy as it is: longer steps, slower waves. The run says so");
    options.add("subcycling", &subcycling, Range::between(1, 64),
                "Explicit steps of the softer body may be so many of the stiffer one's, a power of two; 1: both take the same");
  }

  [[nodiscard]] int count(int at_one, int least) const {
    return std::max(least, static_cast<int>(std::lround(at_one * resolution)));
  }

  /// The gauge pressure that balances the surface tension of the sphere, Pa (Young and Laplace).
  [[nodiscard]] double rest_pressure() const { return 2.0 * surface_tension / radius; }

  [[nodiscard]] Ball cell_shape() const {
    return {.radius = radius,
            .core_radius = nucleus * radius,
            .core_cells = count(10, 2),
            .shells = count(5, 1),
            .center = {0.0, 0.0, radius + gap}};
  }
  [[nodiscard]] Disc substrate_shape() const {
    return {.radius = substrate_radius,
            .height = substrate_height,
            .core_cells = count(21, 2),
            .rings = count(19, 1),
            .layers = count(7, 1) + 1};
  }
  /// Of the cell, in 3 dimensions or in the meridian section (D = 2), whose core has an even number of cells.
  template <int D>
  [[nodiscard]] PointCloud<D> cell_cloud() const {
    const PoleRefinement refinement{.factor = contact_refinement};
    Ball shape = cell_shape();
    if constexpr (D == 3) {
      return refine_pole<3>(turned(ball(shape)), shape.center, radius, refinement);
    } else {
      shape.core_cells += shape.core_cells % 2;
      return refine_pole<2>(meridian(shape), Point<2>(0.0, shape.center[2]), radius, refinement);
    }
  }
  template <int D>
  [[nodiscard]] PointCloud<D> substrate_cloud() const {
    if constexpr (D == 3) return turned(disc(substrate_shape()));
    else return meridian(substrate_shape());
  }
  /// What is not the same all around the axis. Throws ParameterError.
  void validate_axisymmetric() const {
    if (director == "random")
      throw ParameterError("--director random is not allowed: it is not axisymmetric; use --director uniform (along the axis) or radial.");
    if (turn != 0.0) throw ParameterError("--turn is not allowed: a meridian section cannot be turned around its axis.");
  }

  [[nodiscard]] PointCloud<3> turned(PointCloud<3> cloud) const {
    if (turn == 0.0) return cloud;
    for (Point<3>& X : cloud.positions)
      X.head<2>() = Point<2>(std::cos(turn) * X[0] - std::sin(turn) * X[1], std::sin(turn) * X[0] + std::cos(turn) * X[1]);
    return cloud;
  }

  [[nodiscard]] ModifiedMooneyRivlin nucleus_law() const {
    return {.density = density,
            .c1 = nucleus_c1,
            .c2 = nucleus_c2,
            .lambda = nucleus_lambda,
            .initial_pressure = rest_pressure()};
  }
  [[nodiscard]] NematicGel<> cytoplasm_law() const {
    return {.density = density,
            .viscosity = viscosity,
            .bulk_modulus = bulk_modulus,
            .reference_pressure = rest_pressure(),
            .director_elasticity = director_elasticity,
            .activity = activity};
  }
  /// The substrate with C₁, C₂, λ of the base times `factor`: 2, 5 and 10 are the paper's substrates I, II and III.
  [[nodiscard]] YangVisco<> substrate_law(double factor) const {
    const double viscous = preset == "elastic" ? 0.0 : preset == "viscous/10" ? 0.1 : 1.0;
    const ModifiedMooneyRivlin base{
        .density = substrate_density * substrate_mass_scaling, .c1 = substrate_c1, .c2 = substrate_c2, .lambda = substrate_lambda};
    return {.elastic = base.scaled(factor), .a1 = viscous * a1, .a2 = viscous * a2, .a3 = a3};
  }
  /// The substrate whose factor grows with the angle from one side to the other (Fig. 11).
  [[nodiscard]] GradedSubstrate graded_substrate(const StiffnessGradient& gradient) const {
    return {[*this, gradient](const Vector3& X) {
      const double angle = std::abs(std::atan2(X[1], X[0]));  // θ, 0 … π
      return substrate_law(gradient.soft + (gradient.stiff - gradient.soft) * angle / std::numbers::pi);
    }};
  }
  /// In the meridian section a uniform director is along the axis.
  template <int D>
  [[nodiscard]] Field director_field(const PointCloud<D>& cloud) const {
    if (director == "uniform") return initial_director(cloud, UniformDirector(Vector3::Unit(D == 2 ? 1 : 0)));
    if (director == "radial") return initial_director(cloud, RadialDirector(Vector3::Unit(D - 1) * (radius + gap)));
    return initial_director(cloud, RandomDirector({.correlation_length = correlation_length, .seed = seed}));
  }
  [[nodiscard]] NodalCentroids quadrature() const {
    return {.solid_ratio = hourglass, .fluid_modulus = fluid_hourglass, .fluid_viscosity = fluid_hourglass_viscosity};
  }
  [[nodiscard]] ContactSide bond_side() const { return bonds_on == "cell" ? ContactSide::first : ContactSide::second; }
  [[nodiscard]] LigandReceptor ligand_receptor() const {
    return {.bond_density = bond_density, .binding_energy = binding_energy, .range = bond_range,
            .area = bond_area == "mobile" ? ContactArea::mobile : ContactArea::reference, .sampled = bond_side(), .points_per_direction = contact_points};
  }
  [[nodiscard]] VanDerWaals van_der_waals_force() const {
    return {.strength = van_der_waals, .range = van_der_waals_range, .reaction = van_der_waals_reaction};
  }
};

}  // namespace tactoid
