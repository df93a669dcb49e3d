#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <tactoid/tactoid.hpp>

#include <common/options.hpp>
#include <common/spreading_case.hpp>

namespace tactoid {

/// Tethers between cell and substrate, which a study adds to SpreadingCase. Rates are those of real bonds, times `rate_factor`.
struct Tethers {
  std::string mode = "mean";           ///< off, mean (field) or stochastic
  double density = 300e12;             ///< receptors per area of the surface that has them, 1/m²
  double stiffness = 1e-3;             ///< κ, N/m
  double length = 50e-9;               ///< ℓ at rest, m
  double capture_distance = 60e-9;     ///< gap below which bonds form, m
  double on_rate = 1.0;                ///< k_on, 1/s
  double off_rate = 0.1;               ///< k_s, 1/s
  double slip_force = 10e-12;          ///< F_s, N
  double catch_rate = 0.0;             ///< k_c, 1/s
  double catch_force = 5.38e-12;       ///< F_c, N
  double rate_factor = 1e7;            ///< how much faster than in a cell bonds form and break here
  std::uint64_t seed = 1;              ///< of the stochastic ones
  ContactSide side = ContactSide::first;  ///< who has the receptors: the cell, or the substrate
  int points = 2;                      ///< along each side of a facet

  void add_to(Options& options) {
    options.add_choice("tethers", &mode, {"off", "mean", "stochastic"}, "Bonds that hold in the tangential direction: none, in the mean field, one by one");
    options.add_quantity("tether-density", &density, Quantity::number_density, Range::positive(), "Receptors per area of the cell, or of the substrate (bonds-on)");
    options.add_quantity("tether-stiffness", &stiffness, Quantity::surface_tension, Range::non_negative(), "Stiffness of a bond");
    options.add_quantity("tether-length", &length, Quantity::length, Range::non_negative(), "Length of a bond at rest");
    options.add_quantity("capture-distance", &capture_distance, Quantity::length, Range::positive(), "Gap below which bonds form");
    options.add_quantity("on-rate", &on_rate, Quantity::frequency, Range::non_negative(), "Rate at which a free receptor binds");
    options.add_quantity("off-rate", &off_rate, Quantity::frequency, Range::non_negative(), "Rate at which a bond without force breaks by slipping");
    options.add_quantity("slip-force", &slip_force, Quantity::force, Range::positive(), "Force that makes slipping e times as fast");
    options.add_quantity("catch-rate", &catch_rate, Quantity::frequency, Range::non_negative(), "Rate at which a bond without force breaks on the catch path");
    options.add_quantity("catch-force", &catch_force, Quantity::force, Range::positive(), "Force that makes the catch path e times as slow");
    options.add("rate-factor", &rate_factor, Range::positive(), "Factor on all rates of the tethers: the run is that much shorter than a cell's time");
    options.add("tether-seed", &seed, Range::non_negative(), "Seed of the stochastic tethers");
  }

  /// Without tethers: bonds that never form and are no springs, which change no bit of a run.
  [[nodiscard]] TetheredBonds law() const {
    if (mode == "off") return {.stiffness = 0.0, .capture_distance = 1e-30, .kinetics = {.on_rate = 0.0}};
    return {.density = density,
            .stiffness = stiffness,
            .rest_length = length,
            .capture_distance = capture_distance,
            .kinetics = {.on_rate = rate_factor * on_rate,
                         .off_rate = rate_factor * off_rate,
                         .slip_force = slip_force,
                         .catch_rate = rate_factor * catch_rate,
                         .catch_force = catch_force},
            .stochastic = mode == "stochastic",
            .seed = seed,
            .points_per_direction = points,
            .sampled = side};
  }
  /// The surface and the quadrature of the other bonds.
  void follow(const SpreadingParameters& p) {
    side = p.bond_side();
    points = p.contact_points;
  }
  [[nodiscard]] auto contacts() const { return std::tuple(between<0, 1>(law())); }

  /// Bonds, and their pull on the substrate toward the axis of the cell, on the soft side (x > 0) and on the stiff one; the mean
  /// tension of a bond; the net force across, which symmetry makes zero; the largest speed in the cell.
  [[nodiscard]] std::vector<std::string> columns() const {
    return {"bonds_plus_x", "bonds_minus_x", "pull_plus_x", "pull_minus_x", "bond_tension", "bond_force_y", "speed_max"};
  }
  template <class S>
  [[nodiscard]] std::vector<double> values(S& simulation) const {
    TetheredBonds& tethers = simulation.template contact<first_added_contact>();
    double bonds[2] = {}, pull[2] = {}, tension = 0.0, across = 0.0;
    tethers.sites.visit([&](const auto& sites) {
      for (std::size_t s = 0; s < sites.size(); ++s) {
        const double n = sites.bound()[s], r = sites.extension()[s].norm();
        if (!(n > 0.0) || !(r > 0.0)) continue;
        const int half = sites.place(s)[0] > 0.0 ? 0 : 1;
        // An extension leads from the anchor to the site.
        const double toward_cell = tethers.sampled == ContactSide::first ? 1.0 : -1.0;
        const Vector4 on_substrate = (toward_cell * n * tethers.tension(r) / r) * sites.extension()[s];
        bonds[half] += n;
        pull[half] += half == 0 ? -on_substrate[0] : on_substrate[0];
        tension += n * tethers.tension(r);
        across += on_substrate[1];
      }
    });
    double speed = 0.0;
    for (const Vector4& v : simulation.template particles<0>().velocity) speed = std::max(speed, v.norm());
    const double all = bonds[0] + bonds[1];
    return {bonds[0], bonds[1], pull[0], pull[1], all > 0.0 ? tension / all : 0.0, across, speed};
  }
};

}  // namespace tactoid
