#pragma once

#include <tactoid/boundary/boundary.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/geometry/facets.hpp>

namespace tactoid {

/// A surface term (pressure, surface tension, a rigid plate) on a part of the surface: on the facets all of whose
/// particles satisfy a predicate of the reference position (m). A BoundaryTerm.
///
///   OnFacets{AmbientPressure{.pressure = 1_kPa}, [](const auto& X) { return X[2] > 0.999e-6; }}
///
/// The cut planes of a body that is computed in part, by symmetry, are no surface: leave them out.
template <class Term, class Predicate>
struct OnFacets {
  static constexpr Reads reads = reads_of<Term>;  ///< as the term does
  Term term;            ///< satisfies BoundaryTerm
  Predicate predicate;  ///< bool(const Point<D>& X)

  /// Throws GeometryError where no facet satisfies the predicate.
  template <int D>
    requires BoundaryTerm<Term, D>
  void initialize(const PointCloud<D>& cloud, const ParticleFields& body) {
    const PointCloud<D> part = with_facets_where(cloud, predicate);
    if (part.facets.empty()) throw GeometryError("OnFacets: no facet of the body satisfies the predicate.");
    term.initialize(part, body);
  }
  TermEnergy apply(const ParticleFields& body, double time) { return term.apply(body, time); }  ///< of the term
  /// Of the term.
  [[nodiscard]] double stiffness_rate(const ParticleFields& body) const { return term.stiffness_rate(body); }
  /// Of the term, where it has one.
  template <class Emit>
    requires TermWithStiffness<Term>
  void add_stiffness(const ParticleFields& body, const Emit& emit) const {
    term.add_stiffness(body, emit);
  }
  /// For checkpoints: that of the term.
  template <class Archive>
  void state(Archive& archive) { archive.part("term", term); }
};
/// Deduced from the term and the predicate.
template <class Term, class Predicate>
OnFacets(Term, Predicate) -> OnFacets<Term, Predicate>;

}  // namespace tactoid
