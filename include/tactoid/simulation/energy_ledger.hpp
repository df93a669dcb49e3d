#pragma once

#include <algorithm>
#include <cmath>

namespace tactoid {

/// The energies of a simulation at one instant and the works since its start, J.
struct EnergyLedger {
  double kinetic = 0.0;        ///< ½ Σ m |v|² at the present instant
  double strain = 0.0;         ///< of the laws
  double stabilization = 0.0;  ///< of the quadrature's stabilisation
  double adhesion = 0.0;       ///< potentials of the contacts
  double surface = 0.0;        ///< potentials of the boundary terms (surface tension, pressure, gravity)
  double dissipated = 0.0;     ///< by viscosity, damping, and the branches that have no energy
  double external_work = 0.0;  ///< of prescribed motion, active stress, and forces without an energy

  double reference_updates = 0.0;  ///< lost with the stabilisation as references were updated (UpdatedReference)

  double initial = 0.0;       ///< total() at the start
  double largest_work = 0.0;  ///< largest |work| or energy exchanged so far: the scale of the error

  /// What is stored now.
  [[nodiscard]] double total() const { return kinetic + strain + stabilization + adhesion + surface; }
  /// total + dissipated + lost by updates − external work − initial total: zero for exact integration in time.
  [[nodiscard]] double defect() const { return total() + dissipated + reference_updates - external_work - initial; }
  /// |defect| over the largest work done so far.
  [[nodiscard]] double error() const { return largest_work > 0.0 ? std::abs(defect()) / largest_work : 0.0; }

  /// For checkpoints: all of it.
  template <class Archive>
  void state(Archive& archive) {
    archive("kinetic", kinetic);
    archive("strain", strain);
    archive("stabilization", stabilization);
    archive("adhesion", adhesion);
    archive("surface", surface);
    archive("dissipated", dissipated);
    archive("external_work", external_work);
    archive("reference_updates", reference_updates);
    archive("initial", initial);
    archive("largest_work", largest_work);
  }

  /// Lets largest_work grow with what has been exchanged until now.
  void note_scale() {
    for (const double e : {kinetic, strain, dissipated, external_work, total() - initial})
      largest_work = std::max(largest_work, std::abs(e));
  }
};

}  // namespace tactoid
