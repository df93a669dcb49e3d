#pragma once

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include <tactoid/boundary/axis_condition.hpp>
#include <tactoid/boundary/boundary.hpp>
#include <tactoid/boundary/essential_conditions.hpp>
#include <tactoid/integrator/static_newton.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/body_fields.hpp>
#include <tactoid/simulation/stiffness.hpp>

namespace tactoid {

/// Equilibrium of one body under essential conditions and boundary terms, as an EquilibriumProblem for StaticNewton:
///
///   StaticProblem problem{body, {fixed(left), pull}, BodyForce<>{.acceleration = …}};
///   StaticNewton{.load_steps = 4}.solve(problem);
///   problem.reaction(1);
///
/// Works on the body's displacement; the velocity is set to zero. Prescribed displacements grow linearly from the
/// present ones to their values at `time` 0, the forces of the terms linearly from zero. A term that has a stiffness
/// (TermWithStiffness: rigid surfaces, surface tension) adds it to the tangent; the others are dead loads for it: those that
/// follow the deformation (pressure) converge too, but not quadratically.
/// Components beyond the dimension of the body are no unknowns. The body must outlive the problem.
template <class Body, class... Terms>
class StaticProblem {
 public:
  static constexpr int dimension = Body::dimension;  ///< of the body

  /// Throws ParameterError for a condition that EssentialConditions rejects, and for a body whose rows several processes have.
  StaticProblem(Body& body, std::vector<PrescribedMotion> motions, Terms... terms)
      : body_(body), terms_(std::move(terms)...) {
    static_assert((BoundaryTerm<Terms, dimension> && ...), "A StaticProblem takes BoundaryTerms after its conditions.");
    if (body.share() != nullptr)
      throw ParameterError("Body \"" + body.name() + "\": statics need all of its rows, but several processes share them; compose it without a session, or with SetUp::whole.");
    std::fill(body_.velocity.begin(), body_.velocity.end(), Vector4::Zero());
    fields_.prepare(body_);
    essential_ = EssentialConditions(with_axis_condition(body_.cloud(), std::move(motions)), body_.particle_values(), body_.reference(),
                                     body_.masses());
    fields_.refresh(body_, 0.0);
    std::apply([&](auto&... term) { (term.initialize(body_.cloud(), fields_.view(body_)), ...); }, terms_);
    Vector4 least = body_.reference().front(), most = least;
    for (const Vector4& X : body_.reference()) least = least.cwiseMin(X), most = most.cwiseMax(X);
    length_ = (most - least).norm();
    assemble_conditions();
    initial_ = conditions_ * unknowns();
    defect_target_ = initial_;
    reactions_.assign(essential_.motions().size(), Vector3::Zero());
  }

  // --- results -----------------------------------------------------------------------------------------------
  /// Force of the condition m (in the order given) on the body, N.
  [[nodiscard]] const Vector3& reaction(std::size_t m) const { return reactions_[m]; }
  /// Energies of the body and of the terms at the last evaluation, J.
  [[nodiscard]] const BodyTotals& energies() const { return totals_; }
  /// Of the terms at the last evaluation, J.
  [[nodiscard]] const TermEnergy& term_energy() const { return term_energy_; }

  // --- what StaticNewton uses --------------------------------------------------------------------------------
  /// Fraction of the loads and of the prescribed displacements, 0 (present state) to 1.
  void set_load(double fraction) {
    fraction_ = fraction;
    defect_target_ = initial_ + fraction * (final_ - initial_);
  }

  /// Forces at the present displacement; false where a point is inverted or a force is not finite.
  bool evaluate() {
    fields_.refresh(body_, 0.0);
    term_energy_ = {};
    std::apply([&](auto&... term) { (add_term(term), ...); }, terms_);
    std::fill(body_.force.begin(), body_.force.end(), Vector4::Zero());
    totals_ = body_.add_internal_forces(0.0, false);
    const bool sound = body_.failed_point() == body_.table().points();
    Field external(body_.size(), Vector4::Zero());
    body_.particle_values().distribute(fields_.force, external);
    const Eigen::VectorXd inside = flat(body_.force), outside = fraction_ * flat(external);
    for (std::size_t i = 0; i < external.size(); ++i) body_.force[i] += fraction_ * external[i];
    forces_ = inside + outside;
    force_scale_ = std::max(inside.norm(), outside.norm());
    return sound && forces_.allFinite();
  }

  /// Internal + fraction × external, N; D N of them.
  [[nodiscard]] const Eigen::VectorXd& forces() const { return forces_; }
  [[nodiscard]] double force_scale() const { return force_scale_; }  ///< larger norm of the two parts, N
  [[nodiscard]] double length() const { return length_; }            ///< diagonal of the box around the body, m
  /// K of the body, and of the terms that have one, N/m.
  [[nodiscard]] StiffnessMatrix stiffness() {
    StiffnessMatrix K = assemble_stiffness(body_);
    if constexpr ((TermWithStiffness<Terms> || ...)) K += term_stiffness();
    return K;
  }
  /// N: a row per prescribed component of a particle.
  [[nodiscard]] const StiffnessMatrix& conditions() const { return conditions_; }
  /// Unknowns are values at the particles.
  [[nodiscard]] bool conditions_are_values() const { return body_.particle_values().identity(); }
  [[nodiscard]] Eigen::VectorXd defect() const { return defect_target_ - conditions_ * unknowns(); }  ///< ū − N u, m
  /// u ← u + du, m.
  void move(const Eigen::VectorXd& du) {
    for (std::size_t i = 0; i < body_.size(); ++i)
      body_.displacement[i].template head<dimension>() +=
          du.segment<dimension>(static_cast<Eigen::Index>(dimension * i));
  }
  /// Sums the forces of the conditions (N, in the order of the rows) per prescribed motion, for reaction().
  void set_multipliers(const Eigen::VectorXd& multipliers) {
    std::fill(reactions_.begin(), reactions_.end(), Vector3::Zero());
    Eigen::Index row = 0;
    for (int c = 0; c < dimension; ++c)
      for (const auto& condition : essential_.conditions(c)) reactions_[condition.motion][c] += multipliers[row++];
  }

 private:
  template <class Term>
  void add_term(Term& term) {
    term_energy_ += term.apply(fields_.view(body_), 0.0);
  }

  /// Stiffness of the terms in the unknowns: of the particles, and Nᵀ K N where the unknowns are coefficients, u = N a.
  [[nodiscard]] StiffnessMatrix term_stiffness() {
    const auto n = static_cast<Eigen::Index>(dimension * body_.size());
    std::vector<Eigen::Triplet<double>> entries;
    const auto emit = [&](Index i, Index j, const Tensor3& k) {
      detail::add_block<dimension>(dimension * static_cast<Eigen::Index>(i), dimension * static_cast<Eigen::Index>(j), fraction_ * k, entries);
    };
    const auto add = [&](const auto& term) {
      if constexpr (TermWithStiffness<std::decay_t<decltype(term)>>) term.add_stiffness(fields_.view(body_), emit);
    };
    std::apply([&](const auto&... term) { (add(term), ...); }, terms_);
    StiffnessMatrix K(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
    const ParticleValues& map = body_.particle_values();
    if (map.identity()) return K;
    entries.clear();
    const ValueRows& rows = map.rows();
    for (std::size_t i = 0; i < body_.size(); ++i)
      for (std::size_t e = rows.offsets[i]; e < rows.offsets[i + 1]; ++e)
        for (int c = 0; c < dimension; ++c)
          entries.emplace_back(dimension * static_cast<int>(i) + c, dimension * static_cast<int>(rows.particles[e]) + c, rows.values[e]);
    StiffnessMatrix N(n, n);
    N.setFromTriplets(entries.begin(), entries.end());
    return N.transpose() * K * N;
  }

  [[nodiscard]] Eigen::VectorXd unknowns() const { return flat(body_.displacement); }

  [[nodiscard]] static Eigen::VectorXd flat(const Field& field) {
    Eigen::VectorXd v(static_cast<Eigen::Index>(dimension * field.size()));
    for (std::size_t i = 0; i < field.size(); ++i)
      v.segment<dimension>(static_cast<Eigen::Index>(dimension * i)) = field[i].template head<dimension>();
    return v;
  }

  void assemble_conditions() {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> values;
    const ParticleValues& map = body_.particle_values();
    for (int c = 0; c < dimension; ++c)
      for (const auto& [particle, motion, place] : essential_.conditions(c)) {
        const int row = static_cast<int>(values.size());
        if (map.identity()) {
          entries.emplace_back(row, dimension * static_cast<int>(particle) + c, 1.0);
        } else {
          const ValueRows& rows = map.rows();
          for (std::size_t e = rows.offsets[particle]; e < rows.offsets[particle + 1]; ++e)
            entries.emplace_back(row, dimension * static_cast<int>(rows.particles[e]) + c, rows.values[e]);
        }
        values.push_back(essential_.motions()[motion].value(place, 0.0)[c]);
      }
    conditions_.resize(static_cast<Eigen::Index>(values.size()), static_cast<Eigen::Index>(dimension * body_.size()));
    conditions_.setFromTriplets(entries.begin(), entries.end());
    final_ = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  Body& body_;
  std::tuple<Terms...> terms_;
  EssentialConditions essential_;
  BodyFields fields_;
  StiffnessMatrix conditions_;
  Eigen::VectorXd initial_, final_, defect_target_, forces_;
  double fraction_ = 0.0, force_scale_ = 0.0, length_ = 0.0;
  BodyTotals totals_;
  TermEnergy term_energy_;
  std::vector<Vector3> reactions_;
};

}  // namespace tactoid
