#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <tactoid/contact/surface.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/geometry/particle_fields.hpp>

namespace tactoid {

/// The facets of a surface that hang together in a plane or a meridian section, from end to end.
struct FacetCurve {
  std::vector<Index> facets;  ///< in their order; each ends where the next begins
  std::vector<Index> nodes;   ///< facet k reaches from nodes[k] to nodes[k + 1]; of a closed curve the last is the first
  bool closed = false;        ///< comes back to where it began
};

/// The curves of a surface, each once, in the order of their first facets.
[[nodiscard]] std::vector<FacetCurve> facet_curves(const FacetSurface<2>& surface);

/// What becomes of amounts on the facets of a surface (areas, receptors, bonds) whose particles slid along it: each new facet takes the
/// amounts of the parts of the old ones that it covers, in proportion to their present area. What is summed over a curve stays as it is.
class SurfaceTransfer {
 public:
  /// A curve with the new place of each of its nodes: k + s is s of the way along its k-th facet as this was. Ends stay.
  struct Slide {
    FacetCurve curve;            ///< with its facets in their order
    std::vector<double> places;  ///< one per node, ascending, from 0 to the number of facets
    std::vector<double> radii;   ///< of the nodes as they were, m; 1 where there is no axis
    std::vector<double> lengths;  ///< of the facets as they were, m
  };

  SurfaceTransfer() = default;
  /// Curve by curve.
  explicit SurfaceTransfer(std::vector<Slide> slides) : slides_(std::move(slides)) {}

  [[nodiscard]] const std::vector<Slide>& slides() const { return slides_; }   ///< curve by curve

  /// Calls visit(new bin, old bin, share of the old one) for all that overlap; bins are the parts of the facets that belong to the
  /// points of a quadrature with these weights (they sum to 1), facet by facet. The shares of an old bin sum to 1.
  template <class Visit>
  void for_each_share(const std::vector<double>& weights, const Visit& visit) const {
    const std::size_t n = weights.size();
    for (const Slide& slide : slides_) {
      const std::size_t count = slide.curve.facets.size();
      std::vector<double> until(count + 1, 0.0);  // present area up to each node
      for (std::size_t k = 0; k < count; ++k) until[k + 1] = until[k] + area(slide, k, 1.0);
      const auto at = [&](double place) {
        const std::size_t k = std::min(static_cast<std::size_t>(std::max(place, 0.0)), count - 1);
        return until[k] + area(slide, k, place - static_cast<double>(k));
      };
      std::vector<double> before{0.0}, after{0.0};
      for (std::size_t k = 0; k < count; ++k) {
        double along = 0.0;
        for (std::size_t j = 0; j < n; ++j) {
          along += weights[j];
          const double s = j + 1 == n ? 1.0 : along;
          before.push_back(j + 1 == n ? until[k + 1] : at(static_cast<double>(k) + s));
          after.push_back(at((1.0 - s) * slide.places[k] + s * slide.places[k + 1]));
        }
      }
      after.back() = before.back();
      std::size_t o = 0;
      for (std::size_t b = 0; b + 1 < after.size(); ++b) {
        while (o > 0 && before[o] > after[b]) --o;
        while (o + 2 < before.size() && before[o + 1] <= after[b]) ++o;
        for (std::size_t k = o; k + 1 < before.size() && before[k] < after[b + 1]; ++k) {
          const double width = before[k + 1] - before[k];
          const double overlap = std::min(before[k + 1], after[b + 1]) - std::max(before[k], after[b]);
          if (width > 0.0 && overlap > 0.0)
            visit(slide.curve.facets[b / n] * n + b % n, slide.curve.facets[k / n] * n + k % n, overlap / width);
        }
      }
    }
  }

  /// Amounts per facet and point of a quadrature (facet-major), on the new facets.
  [[nodiscard]] std::vector<double> carry(const std::vector<double>& weights, const std::vector<double>& amounts) const;

 private:
  /// Of the first s of a facet: of the cone between its rings, over π.
  [[nodiscard]] static double area(const Slide& slide, std::size_t k, double s);

  std::vector<Slide> slides_;
};

/// A contact or boundary term that keeps amounts per facet of a body whose particles are redistributed has
///   void redistribute(const SurfaceTransfer&, const ParticleFields& body)
/// (a contact: of body A, with the fields of A and B). One that keeps nothing of the kind says so by
///   static constexpr bool follows_redistribution = true;
template <class T>
inline constexpr bool follows_redistribution = [] {
  if constexpr (requires { T::follows_redistribution; }) return bool(T::follows_redistribution);
  else return false;
}();

/// Whether a contact is to be told when particles of its body A slid along the surface, as above.
template <class C>
concept tells_of_redistribution = requires(C& contact, const SurfaceTransfer& surface, const ParticleFields& fields) { contact.redistribute(surface, fields, fields); };

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/contact/surface_transfer.ipp>
#endif
