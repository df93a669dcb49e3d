#pragma once

#include <algorithm>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include <tactoid/contact/contact.hpp>
#include <tactoid/contact/surface_transfer.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// A contact made of several that act on the same pair of bodies: `Combined{LigandReceptor{}, VanDerWaals{}}`.
/// Forces and energies add up, in the order of the parts.
template <class... Parts>
struct Combined {
  /// As the parts do.
  static constexpr Reads reads_a = ((reads_a_of<Parts> == Reads::facets) && ...) ? Reads::facets : Reads::all;
  static constexpr Reads reads_b = ((reads_b_of<Parts> == Reads::facets) && ...) ? Reads::facets : Reads::all;  ///< see above
  static constexpr bool follows_redistribution = (tactoid::follows_redistribution<Parts> && ...);  ///< where all parts do
  std::tuple<Parts...> parts;  ///< in the order given

  Combined() = default;
  /// Takes the parts over.
  explicit Combined(Parts... p)
    requires(sizeof...(Parts) > 0)
      : parts(std::move(p)...) {}

  /// Initializes every part; throws what they throw.
  template <int D>
    requires(Contact<Parts, D> && ...)
  void initialize(const PointCloud<D>& cloud_a, const ParticleFields& a, const PointCloud<D>& cloud_b,
                  const ParticleFields& b) {
    std::apply([&](auto&... part) { (part.initialize(cloud_a, a, cloud_b, b), ...); }, parts);
  }
  /// Sum over the parts.
  TermEnergy apply(const ParticleFields& a, const ParticleFields& b, double time) {
    TermEnergy total;
    std::apply([&](auto&... part) { ((total += part.apply(a, b, time)), ...); }, parts);
    return total;
  }
  /// Rates of the parts add up: ω² of a sum of stiffnesses is at most the sum.
  [[nodiscard]] double stiffness_rate(const ParticleFields& a, const ParticleFields& b) const {
    return std::apply([&](const auto&... part) { return (0.0 + ... + part.stiffness_rate(a, b)); }, parts);
  }

  /// Where all parts that read every particle of A say so.
  [[nodiscard]] bool reads_own_alone() const
    requires(reads_a == Reads::all)
  {
    return std::apply([](const auto&... part) { return (tactoid::reads_own_alone(part) && ...); }, parts);
  }
  /// Of the parts that have one.
  void tell_own(Ranks& ranks, const std::vector<Index>& own)
    requires(TellsOwn<Parts> || ...)
  {
    const auto tell = [&](auto& part) {
      if constexpr (TellsOwn<std::decay_t<decltype(part)>>) part.tell_own(ranks, own);
    };
    std::apply([&](auto&... part) { (tell(part), ...); }, parts);
  }

  /// Of the parts that have one.
  template <class Emit>
    requires(ContactWithStiffness<Parts> || ...)
  void add_stiffness(const ParticleFields& a, const ParticleFields& b, const Emit& emit) const {
    const auto add = [&](const auto& part) {
      if constexpr (ContactWithStiffness<std::decay_t<decltype(part)>>) part.add_stiffness(a, b, emit);
    };
    std::apply([&](const auto&... part) { (add(part), ...); }, parts);
  }

  /// Tells the parts that keep something of A's surface.
  void redistribute(const SurfaceTransfer& surface, const ParticleFields& a, const ParticleFields& b)
    requires((tactoid::follows_redistribution<Parts> || tells_of_redistribution<Parts>) && ...)
  {
    const auto tell = [&](auto& part) {
      if constexpr (tells_of_redistribution<std::decay_t<decltype(part)>>) part.redistribute(surface, a, b);
    };
    std::apply([&](auto&... part) { (tell(part), ...); }, parts);
  }
  /// Throws ParameterError where a part does.
  void require_redistributable() const {
    const auto look_at = [](const auto& part) {
      if constexpr (requires { part.require_redistributable(); }) part.require_redistributable();
    };
    std::apply([&](const auto&... part) { (look_at(part), ...); }, parts);
  }

  /// For checkpoints: those of the parts.
  template <class Archive>
  void state(Archive& archive) {
    std::apply([&](auto&... part) { int n = 0; (archive.part("part_" + std::to_string(n++), part), ...); }, parts);
  }

  /// The part of type `Part`, as in `contact.get<VanDerWaals>().gaps()`.
  template <class Part>
  [[nodiscard]] const Part& get() const {
    return std::get<Part>(parts);
  }
  /// The part of type `Part`.
  template <class Part>
  [[nodiscard]] Part& get() {
    return std::get<Part>(parts);
  }
};

}  // namespace tactoid
