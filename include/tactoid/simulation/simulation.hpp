#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactoid/boundary/axis_condition.hpp>
#include <tactoid/boundary/boundary.hpp>
#include <tactoid/boundary/essential_conditions.hpp>
#include <tactoid/boundary/prescribed_motion.hpp>
#include <tactoid/contact/contact.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/pages.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/state.hpp>
#include <tactoid/integrator/integrator.hpp>
#include <tactoid/integrator/reference_update.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/simulation/body_fields.hpp>
#include <tactoid/simulation/body_pace.hpp>
#include <tactoid/simulation/contact_anchoring.hpp>
#include <tactoid/simulation/decomposition.hpp>
#include <tactoid/simulation/energy_ledger.hpp>
#include <tactoid/simulation/observer.hpp>
#include <tactoid/simulation/placement.hpp>
#include <tactoid/simulation/stable_step.hpp>

namespace tactoid {

/// Bodies, the contacts between them, what acts on their boundaries, and the integrator that advances them:
///
///   Simulation simulation{Bodies{cell, substrate},
///                         Contacts{between<0, 1>(LigandReceptor{}), between<0, 1>(VanDerWaals{})},
///                         Boundaries{on<0>(SurfaceTension{}), on<1>(fixed(bottom))},
///                         CentralDifference{}};
///   simulation.run(5_us, every(0.1_us, observer));
///
/// Everything is checked and evaluated once at construction; ParameterError or GeometryError tell what is wrong.
/// Forces are summed in a fixed order: results are the same to the bit for any number of threads. Several processes with a
/// session of <tactoid/mpi.hpp> divide its bodies among them: all of them make the same calls, in the same order.
template <class BodiesType, class ContactsType, class BoundariesType, class IntegratorType>
class Simulation;

/// Defined in implicit_problem.hpp, which programs with implicit steps include.
template <class SimulationType>
class SimulationProblem;

/// The implementation of Simulation: all types are known, so nothing is called through a pointer.
template <class... B, class... C, class... T, class I>
class Simulation<Bodies<B...>, Contacts<C...>, Boundaries<T...>, I> {
 public:
  static constexpr std::size_t body_count = sizeof...(B);                                 ///< number of bodies
  static constexpr int dimension = std::tuple_element_t<0, std::tuple<B...>>::dimension;  ///< 1, 2 or 3: that of all bodies
  static_assert(((B::dimension == dimension) && ...), "All bodies of a Simulation have the same dimension.");
  /// How far velocities are behind the displacements, as a share of the step: ½ but for integrators that say `synchronous`.
  static constexpr double velocity_lag = synchronous<I> ? 0.0 : 0.5;

  /// Composes, checks and evaluates the first state; takes bodies, contacts, terms and integrator over. Throws
  /// ParameterError, GeometryError, and ComputationError where the first state has an inverted point.
  Simulation(Bodies<B...> bodies, Contacts<C...> contacts, Boundaries<T...> boundaries, I integrator)
      : bodies_(std::move(bodies.list)), contacts_(std::move(contacts.list)), boundaries_(std::move(boundaries.list)),
        integrator_(std::move(integrator)) {
    static_assert(Integrator<I, Simulation>, "The last argument of a Simulation is an Integrator.");
    require_possible_parts();
    for_each_body([&](auto& body, std::size_t b) {
      if (synchronous<I> && body.share() != nullptr)
        throw ParameterError("Body \"" + body.name() + "\": each process has made its own rows of it (SetUp::divided), and implicit steps need all rows; choose SetUp::whole, or explicit steps.");
      if (body.share() != nullptr && (Ranks::current == nullptr || Ranks::current->size() == 1))
        throw ParameterError("Body \"" + body.name() + "\": several processes have made its rows, and their session is over.");
      body.velocity_lag = velocity_lag;
      if (loaded(b)) fields_[b].prepare(body);
      if (subcycling()) pace_[b].prepare(body.size());
      std::vector<PrescribedMotion> motions;
      for_each_boundary([&](auto& on, std::size_t) {
        if constexpr (is_motion<decltype(on)>)
          if (std::decay_t<decltype(on)>::body == b) motions.push_back(on.term);
      });
      motions = with_axis_condition(body.cloud(), std::move(motions));
      if (body.in_parts())  // the others belong to other processes
        for (PrescribedMotion& motion : motions) std::erase_if(motion.particles, [&](Index i) { return i < body.size() && !body.cloud().part->is_own(i); });
      const auto make_conditions = [&] { essential_[b] = EssentialConditions(motions, body.particle_values(), body.reference(), body.masses()); };
      if (body.in_parts()) Ranks::current->together(make_conditions);
      else make_conditions();
      (void)impose(body, b, 0.0, 0.0);
      if (body.in_parts())
        for (Field* field : {&body.displacement, &body.velocity, &body.director})
          if (!field->empty()) body.share()->tell_all(*field);
      if (loaded(b)) fields_[b].refresh(body, 0.0);
    });
    for_each_contact([&](auto& between, std::size_t) {
      using Pair = std::decay_t<decltype(between)>;
      static_assert(Pair::first < body_count && Pair::second < body_count, "A contact names a body that does not exist.");
      static_assert(Contact<decltype(between.contact), dimension>, "between<…>() takes a Contact.");
      between.contact.initialize(std::get<Pair::first>(bodies_).cloud(), view<Pair::first>(),
                                 std::get<Pair::second>(bodies_).cloud(), view<Pair::second>());
    });
    for_each_boundary([&](auto& on, std::size_t) {
      using Place = std::decay_t<decltype(on)>;
      static_assert(Place::body < body_count, "A boundary term names a body that does not exist.");
      if constexpr (!is_motion<decltype(on)>) {
        static_assert(BoundaryTerm<decltype(on.term), dimension>, "on<…>() takes a BoundaryTerm or a PrescribedMotion.");
        on.term.initialize(std::get<Place::body>(bodies_).cloud(), view<Place::body>());
      }
    });
    for_each_body([&](auto& body, std::size_t b) { stable_[b].calibrate(body); });
    evaluate();
    ledger_.initial = ledger_.total();
    integrator_.initialize(*this);
    if (Ranks::current != nullptr && Ranks::current->size() > 1) decompose(*Ranks::current);
    give_back_released();
  }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // --- parts -------------------------------------------------------------------------------------------------
  /// Body N, in the order of Bodies{…}, whole on every process: where several share it, the first call after a step gathers it.
  template <std::size_t N>
  [[nodiscard]] auto& body() {
    complete();
    return std::get<N>(bodies_);
  }
  /// Body N, in the order of Bodies{…}; see above.
  template <std::size_t N>
  [[nodiscard]] const auto& body() const {
    complete();
    return std::get<N>(bodies_);
  }
  /// The contact number N of Contacts{…}, to read what it holds; whole, as body().
  template <std::size_t N>
  [[nodiscard]] auto& contact() {
    complete();
    return std::get<N>(contacts_).contact;
  }
  /// The term number N of Boundaries{…}, or its prescribed motion.
  template <std::size_t N>
  [[nodiscard]] auto& boundary() { return std::get<N>(boundaries_).term; }
  [[nodiscard]] const I& integrator() const { return integrator_; }     ///< with what it keeps from step to step
  [[nodiscard]] double time() const { return time_; }                   ///< present instant, s
  [[nodiscard]] double last_time_step() const { return last_step_; }    ///< length of the step that led here, s; 0 at the start
  [[nodiscard]] std::size_t steps() const { return steps_; }            ///< taken since the start
  [[nodiscard]] const EnergyLedger& ledger() const { return ledger_; }  ///< energies now and works since the start, J
  /// Values at the particles of a body: positions, velocities, forces of contacts and boundary terms; whole, as body().
  template <std::size_t N>
  [[nodiscard]] ParticleFields particles() {
    complete();
    if (!loaded(N)) show<N>();
    return view<N>();
  }
  /// How the bodies are divided among processes; null where this one computes everything.
  [[nodiscard]] const Decomposition* decomposition() const { return decomposition_.get(); }
  /// Essential conditions of a body, with their reactions.
  template <std::size_t N>
  [[nodiscard]] const EssentialConditions& essential() const { return essential_[N]; }

  /// Calls f(body, number) for every body, in order.
  template <class F>
  void for_each_body(const F& f) {
    [&]<std::size_t... N>(std::index_sequence<N...>) { (f(std::get<N>(bodies_), N), ...); }(std::index_sequence_for<B...>{});
  }
  /// Calls f(body, number) for every body, in order.
  template <class F>
  void for_each_body(const F& f) const {
    [&]<std::size_t... N>(std::index_sequence<N...>) { (f(std::get<N>(bodies_), N), ...); }(std::index_sequence_for<B...>{});
  }
  /// Calls f(between, number) for every contact, in order: the contact with the numbers of its bodies.
  template <class F>
  void for_each_contact(const F& f) {
    std::apply([&](auto&... c) { std::size_t n = 0; (f(c, n++), ...); }, contacts_);
  }
  /// Calls f(on, number) for every boundary term and prescribed motion, in order: the term with the number of its body.
  template <class F>
  void for_each_boundary(const F& f) {
    std::apply([&](auto&... t) { std::size_t n = 0; (f(t, n++), ...); }, boundaries_);
  }

  /// Pairs of quadrature points and particles that one step visits.
  [[nodiscard]] std::size_t pairs() const {
    std::size_t sum = 0;
    for_each_body([&](const auto& body, std::size_t) { sum += body.table().pairs(); });
    return sum;
  }

  /// Velocity at the present instant (not at the middle of the last step) of the unknowns of a body, m/s.
  template <std::size_t N>
  [[nodiscard]] Field velocity() const {
    complete();
    const auto& body = std::get<N>(bodies_);
    Field v(body.size(), Vector4::Zero());
    const OwnParticles particles(body.in_parts() ? body.share() : nullptr, v.size());
    for (std::size_t k = 0; k < particles.size(); ++k) v[particles[k]] = present_velocity(body, N, particles[k]);
    if (body.in_parts()) body.share()->tell_all(v);
    return v;
  }

  // --- running -----------------------------------------------------------------------------------------------
  /// Advances to the time `until` (s). Observers are called at the start, at their times, and at the end; steps
  /// are cut so that these times are hit exactly. When a step breaks down, the last good state is restored, every
  /// observer is told by `last_good_state(simulation)` if it has that function, and the error goes on.
  template <class... Observers>
  void run(double until, Observers&&... observers) {
    static_assert((Observer<std::remove_reference_t<Observers>, Simulation> && ...), "Simulation::run takes observers.");
    if (!(until >= time_) || !std::isfinite(until)) reject("Simulation.run: end time", until, "s", fmt::format("finite and not before the present time, {:g} s", time_));
    const bool resumed = std::exchange(resumed_, false);
    if (!resumed) {
      run_start_ = time_;
      run_start_steps_ = steps_;
    }
    (begin(observers, resumed), ...);
    while (time_ < until) {
      // Events that coincide but for round-off are one: no step is as short as that.
      const double close = 1e-6 * (last_step_ > 0.0 ? last_step_ : largest_stable_time_step());
      const double first = std::min({until, observers.next_time(*this)...});
      double next = first;
      for (const double event : {until, observers.next_time(*this)...})
        if (event <= first + close) next = std::max(next, event);
      if (until <= first + close) next = until;
      moved_ = false;
      try {
        integrator_.step(*this, next);
      } catch (const ComputationError&) {
        if (moved_) restore();
        (observers.last_good_state(*this), ...);
        throw;
      }
      if (next - time_ < close) time_ = next;
      ++steps_;
      (observers.after_step(*this), ...);
    }
    (observers.end(*this), ...);
  }

  /// When the run began, s and steps; a simulation whose state was restored goes on with the run that was saved.
  [[nodiscard]] double run_start() const { return run_start_; }
  [[nodiscard]] std::size_t run_start_steps() const { return run_start_steps_; }  ///< steps taken when the run began

  /// Everything that the next step needs: for save_state and restore_state, in a simulation that is composed in the same
  /// way. Then it goes on with the same bits, and the next run calls its observers when the saved run would have.
  /// Contacts, terms and integrators take part if they have a state (core/state.hpp).
  template <class Archive>
  void state(Archive& archive) {
    if constexpr (Archive::restoring) incomplete_ = false;
    else complete();
    archive("time", time_);
    archive("evaluated", evaluated_);
    archive("last_step", last_step_);
    archive("step_before", step_before_);
    archive("steps", steps_);
    archive("run_start", run_start_);
    archive("run_start_steps", run_start_steps_);
    archive("external_power", external_power_);
    archive("dissipated_power", dissipated_power_);
    archive.part("ledger", ledger_);
    for_each_body([&](auto& body, std::size_t b) {
      const std::string name = "body_" + std::to_string(b);
      archive.part(name, body);
      const StateRows own = body.particle_rows();
      const CloudPart* const part = body.cloud().part.get();
      const StateRows* const rows = part != nullptr ? &own : nullptr;
      if (loaded(b)) archive.part(name + "/at_particles", fields_[b], rows);
      archive.part(name + "/conditions", essential_[b], rows, part, static_cast<RowShare*>(body.share()));
      archive.part(name + "/stable_step", stable_[b]);
      archive(name + "/term_rate", term_rates_[b]);
      if (subcycling()) archive.part(name + "/pace", pace_[b], rows);
    });
    for_each_contact([&](auto& between, std::size_t n) { archive.part("contact_" + std::to_string(n), between.contact); });
    for_each_boundary([&](auto& on, std::size_t n) {
      if constexpr (!is_motion<decltype(on)>) archive.part("boundary_" + std::to_string(n), on.term);
    });
    archive.part("integrator", integrator_);
    if constexpr (Archive::restoring) {
      resumed_ = true;
      bool in_parts = false;
      for_each_body([&](const auto& body, std::size_t) { in_parts = in_parts || body.in_parts(); });
      if (in_parts) decomposition_->complete();  // each process has restored its own particles
    }
  }

  // --- what an integrator uses -------------------------------------------------------------------------------
  /// Largest stable step of all bodies at the present state, s, without a safety factor; see StableStep.
  [[nodiscard]] double largest_stable_time_step() const {
    double step = std::numeric_limits<double>::infinity();
    for_each_body([&](const auto& body, std::size_t b) {
      step = std::min(step, stable_[b].largest_step(body, term_rates_[b]));
    });
    return step;
  }
  /// The same of each body alone, with the contacts and boundary terms that act on it; in the middle of its own step, with its
  /// deformation at the beginning of that. A body that is held by multipliers counts as the stiffest one: its reactions are those of single steps.
  [[nodiscard]] std::array<double, body_count> stable_time_steps() const {
    std::array<double, body_count> steps{};
    for_each_body([&](const auto& body, std::size_t b) {
      const bool multipliers = !essential_[b].empty() && !essential_[b].on_values();
      steps[b] = multipliers ? largest_stable_time_step() : stable_[b].largest_step(body, term_rates_[b]);
    });
    return steps;
  }

  /// How long the steps of each body are from the next kick at which it is due, s: whole numbers of those of drift(); 0: each of them.
  void set_body_steps(const std::array<double, body_count>& steps) {
    static_assert(subcycled<I>, "Bodies have steps of their own under integrators that say `static constexpr bool subcycled = true`.");
    body_steps_ = steps;
  }

  /// v ← v + Δt M⁻¹ f of all unknowns, with the forces of the last evaluate(); Δt in s.
  void kick(double time_step) {
    for_each_body([&](auto& body, std::size_t b) {
      if constexpr (subcycled<I>)
        if (subcycling()) pace_[b].begin_step(body, body_steps_[b], time_step, last_step_);
      make_room(previous_velocity_[b], body);
      body.for_each_particle([&](std::size_t i) {
        previous_velocity_[b][i] = body.velocity[i];
        body.velocity[i] += (time_step / body.masses()[i]) * body.force[i];
      });
    });
  }

  /// u ← u + Δt v of all unknowns, then the essential conditions at the new time; the time moves on by Δt, s. What
  /// was there before is kept, in case that evaluate() breaks down.
  void drift(double time_step) {
    for_each_body([&](auto& body, std::size_t b) {
      make_room(previous_[b], body);
      body.for_each_particle([&](std::size_t i) {
        previous_[b][i] = body.displacement[i];
        body.displacement[i] += time_step * body.velocity[i];
      });
      if constexpr (subcycled<I>)
        if (subcycling()) pace_[b].drift(body, time_step);
    });
    // Prescribed particles of a whole body are known to all processes by now; of a part, each has imposed its own before it tells them.
    for_each_body([&](auto& body, std::size_t b) { if (body.in_parts()) ledger_.external_work += impose(body, b, time_ + time_step, time_step); });
    begin_exchange();
    for_each_body([&](auto& body, std::size_t b) { if (!body.in_parts()) ledger_.external_work += impose(body, b, time_ + time_step, time_step); });
    moved_ = true;
    step_before_ = last_step_;
    time_ += time_step;
    last_step_ = time_step;
    drifted_ = true;
  }

  /// Forces and energies at the present state; histories and directors are advanced by the last step.
  void evaluate() { evaluate(false); }

  /// Updates the reference of every body that is distorted by more than `distortion` (Body::distortion) and evaluates the forces anew.
  /// Nothing moves, and time stands still. Bodies need a quadrature with build_moved, such as NodalCentroids; see require_updatable().
  ReferenceUpdate update_references(double distortion) {
    return update_references(distortion, [](auto& body, std::size_t) { body.update_reference(); });
  }
  /// The same, and particles of fluids are redistributed: then contacts and terms are told (SurfaceTransfer), and `rows` is filled.
  ReferenceUpdate update_references(double distortion, const Redistribution& redistribution) {
    std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>> rows(body_count);
    ReferenceUpdate done = update_references(distortion, [&](auto& body, std::size_t b) {
      if constexpr (dimension == 2) {
        if (!body.has_fluid()) return body.update_reference();
        RedistributedParticles moved = body.update_reference(redistribution, held_particles(body, b));
        rows[b] = std::move(moved.rows);
        follow_redistribution(body, b, rows[b], moved.surface);
      } else {
        body.update_reference();
      }
    });
    if (std::any_of(rows.begin(), rows.end(), [](const auto& r) { return r.rows() > 0; })) done.rows = std::move(rows);
    return done;
  }

  /// Throws ParameterError where references cannot be updated: in periodic boxes, and of bodies that several processes share.
  void require_updatable() const {
    if (Ranks::current != nullptr && Ranks::current->size() > 1)
      throw ParameterError("UpdatedReference: bodies that several processes share keep their reference; run it on one, or without.");
    for_each_body([](const auto& body, std::size_t) {
      if (!body.cloud().period.isZero()) throw ParameterError("UpdatedReference: body \"" + body.name() + "\" is periodic, and keeps its reference.");
    });
  }

  /// Throws ParameterError where particles of fluids cannot be redistributed: by their body (Body::require_redistributable), or by a contact or
  /// a term on it that does not say what becomes of what it keeps (surface_transfer.hpp).
  void require_redistributable() const {
    if (subcycling()) throw ParameterError("Redistribution: bodies that take steps of their own (SubcycledCentralDifference) keep their particles.");
    for_each_body([&](const auto& body, std::size_t b) {
      if (!body.has_fluid()) {
        if (dimension != 2) body.require_redistributable();
        return;
      }
      body.require_redistributable();
      const auto refuse = [&](const char* what, std::size_t n) {
        throw ParameterError(fmt::format("Redistribution: {} number {} does not say what becomes of what it keeps of body \"{}\" when particles are moved.", what, n, body.name()));
      };
      std::apply([&](const auto&... between) {
        [[maybe_unused]] std::size_t n = 0;
        [[maybe_unused]] const auto look_at = [&](const auto& c) {
          using Pair = std::decay_t<decltype(c)>;
          using Law = std::decay_t<decltype(c.contact)>;
          if (Pair::first == b && !tells_of_redistribution<Law> && !follows_redistribution<Law>) refuse("contact", n);
          if (Pair::second == b && !follows_redistribution<Law>) refuse("contact", n);
          if constexpr (requires { c.contact.require_redistributable(); })
            if (Pair::first == b || Pair::second == b) c.contact.require_redistributable();
          ++n;
        };
        (look_at(between), ...);
      }, contacts_);
      std::apply([&](const auto&... on) {
        [[maybe_unused]] std::size_t n = 0;
        [[maybe_unused]] const auto look_at = [&](const auto& t) {
          using Term = std::decay_t<decltype(t.term)>;
          constexpr bool told = requires(Term& term, const SurfaceTransfer& surface, const ParticleFields& fields) { term.redistribute(surface, fields); };
          if (std::decay_t<decltype(t)>::body == b && !is_motion<decltype(t)> && !told && !follows_redistribution<Term>) refuse("boundary term", n);
          ++n;
        };
        (look_at(on), ...);
      }, boundaries_);
    });
  }

  // --- what an implicit integrator uses ----------------------------------------------------------------------
  /// The simulation as equations for the state at the end of a step; for the length of a step.
  [[nodiscard]] auto implicit_problem() {
    static_assert(synchronous<I>, "Implicit problems are those of integrators that say `static constexpr bool synchronous = true`.");
    return SimulationProblem<Simulation>(*this);
  }

  /// Forces at the displacements, velocities and directors that the bodies have now, as at the end of a step of `time_step`
  /// (s) from time(). Nothing is kept: histories are advanced only tentatively, and contacts are told the time at the start
  /// of the step, so that what they remember stays. False where a point is inverted or something is not finite.
  [[nodiscard]] bool try_state(double time_step) {
    (void)forces(evaluated_, time_ + time_step, time_step);
    bool sound = true;
    for_each_body([&](const auto& body, std::size_t) {
      sound = sound && body.failed_point() == body.table().points() &&
              std::all_of(body.force.begin(), body.force.end(), [](const Vector4& f) { return f.allFinite(); });
    });
    return sound;
  }

  /// Keeps the present state as that at the end of a step of `time_step` (s): histories, what contacts remember, energies.
  /// `holding` are the forces that hold the prescribed values of each body, N per particle.
  void accept_state(double time_step, const std::array<Field, body_count>& holding) {
    const bool from_rest = last_step_ == 0.0 && !inertial();
    time_ += time_step;
    last_step_ = time_step;
    for_each_body([&](auto&, std::size_t b) {
      if (!essential_[b].empty()) ledger_.external_work += essential_[b].accept(time_, time_step, holding[b], from_rest);
    });
    evaluate(from_rest);
  }

  /// Sets the prescribed values at the end of a step of `time_step` (s).
  void prescribe(double time_step) {
    for_each_body([&](auto& body, std::size_t b) { essential_[b].prescribe(time_ + time_step, body.displacement); });
  }

 private:
  /// Updates the references of bodies that are distorted by update(body, number), and evaluates the forces anew.
  template <class Update>
  ReferenceUpdate update_references(double distortion, const Update& update) {
    ReferenceUpdate done;
    for_each_body([&](auto& body, std::size_t b) {
      const double present = body.distortion();
      done.distortion = std::max(done.distortion, present);
      if (!(present > distortion)) return;
      try {
        update(body, b);
      } catch (const GeometryError& error) {
        done.refused = error.what();
        return;
      } catch (const ComputationError& error) {
        done.refused = error.what();
        return;
      }
      stable_[b].calibrate(body);
      ++done.updates;
    });
    if (done.updates == 0) return done;
    const double before = ledger_.total();
    std::array<Field, body_count> velocities;  // at the present instant, which the forces of the table before have told
    for (std::size_t b = 0; b < body_count; ++b)
      if (loaded(b)) velocities[b] = fields_[b].velocity;
    const StepEnergies energies = forces(evaluated_, time_, 0.0);
    for_each_body([&](const auto& body, std::size_t b) { check(body, b); });
    for (std::size_t b = 0; b < body_count; ++b)
      if (loaded(b)) fields_[b].velocity = std::move(velocities[b]);
    take_stored(energies);
    done.lost_energy = before - ledger_.total();
    ledger_.reference_updates += done.lost_energy;
    return done;
  }

  /// Whether contacts or boundary terms act on body b. For the others nobody needs values at particles but particles<N>().
  [[nodiscard]] static constexpr bool loaded([[maybe_unused]] std::size_t b) {
    return ((C::first == b || C::second == b) || ...) || ((T::body == b && !is_motion<T>) || ...);
  }
  /// Makes the values at the particles of a body that is not loaded().
  template <std::size_t N>
  void show() {
    const auto& body = std::get<N>(bodies_);
    Field velocity = body.velocity;
    for (std::size_t i = 0; i < velocity.size() && forces_known_; ++i) velocity[i] = present_velocity(body, N, i);
    if (body.in_parts()) body.share()->tell_all(velocity);  // what holds a particle is known to its own process
    fields_[N].show(body, std::move(velocity));
  }
  /// Values at the particles of body N, as contacts and terms take them.
  template <std::size_t N>
  [[nodiscard]] ParticleFields view() {
    return fields_[N].view(std::get<N>(bodies_));
  }

  /// Particles with prescribed motion, other than that nothing leaves the axis.
  template <class Body>
  [[nodiscard]] std::vector<char> held_particles(const Body& body, std::size_t b) const {
    std::vector<char> held(body.size(), 0);
    for (int c = 0; c < 3; ++c)
      for (const auto& condition : essential_[b].conditions(c))
        if (c > 0 || !body.cloud().on_axis(body.cloud().positions[condition.particle])) held[condition.particle] = 1;
    return held;
  }

  /// Tells everything about the particles of a body where they are now.
  template <class Body>
  void follow_redistribution(const Body& body, std::size_t b, const Eigen::SparseMatrix<double, Eigen::RowMajor>& rows, const SurfaceTransfer& surface) {
    if (!loaded(b)) return;
    const Field velocity = detail::carried(rows, fields_[b].velocity);  // at the present instant
    fields_[b].refresh(body, 0.0);
    fields_[b].velocity = velocity;
    for_each_contact([&](auto& between, std::size_t) {
      using Pair = std::decay_t<decltype(between)>;
      if constexpr (tells_of_redistribution<std::decay_t<decltype(between.contact)>>)
        if (Pair::first == b) between.contact.redistribute(surface, view<Pair::first>(), view<Pair::second>());
    });
    for_each_boundary([&](auto& on, std::size_t) {
      constexpr std::size_t of = std::decay_t<decltype(on)>::body;
      if constexpr (requires { on.term.redistribute(surface, view<of>()); })
        if (of == b) on.term.redistribute(surface, view<of>());
    });
  }

  /// What a step books in the ledger.
  struct StepEnergies {
    BodyTotals internal;
    TermEnergy contact, boundary;
    double kinetic = 0.0;
  };

  /// Forces and energies at the present state; histories advanced by `time_step` wait for being accepted.
  StepEnergies forces(double contact_time, double time, double time_step) {
    StepEnergies energies;
    forces_known_ = true;
    if (!std::exchange(incomplete_, true) && decomposition_) give_back_elsewhere();
    for_each_body([&](auto& body, std::size_t b) {
      if (loaded(b)) fields_[b].refresh(body, velocity_lag * time_step);
    });
    term_rates_.fill(0.0);
    for_each_contact([&](auto& between, std::size_t) {
      using Pair = std::decay_t<decltype(between)>;
      const ParticleFields a = view<Pair::first>(), b = view<Pair::second>();
      energies.contact += between.contact.apply(a, b, contact_time);
      const double rate = between.contact.stiffness_rate(a, b);
      term_rates_[Pair::first] += rate;
      term_rates_[Pair::second] += rate;
    });
    for_each_boundary([&](auto& on, std::size_t) {
      if constexpr (!is_motion<decltype(on)>) {
        constexpr std::size_t b = std::decay_t<decltype(on)>::body;
        energies.boundary += on.term.apply(view<b>(), time);
        term_rates_[b] += on.term.stiffness_rate(view<b>());
      }
    });
    end_exchange();
    for_each_body([&](auto& body, std::size_t b) {
      if (loaded(b) && body.particle_values().identity()) {
        body.for_each_particle([&](std::size_t i) { body.force[i] = fields_[b].force[i]; });
      } else {
        body.for_each_particle([&](std::size_t i) { body.force[i].setZero(); });
        if (loaded(b)) body.particle_values().distribute(fields_[b].force, body.force);
      }
      energies.internal += add_internal_forces(body, b, time_step);
      energies.kinetic += sum_over_particles(b, body, [&](std::size_t i) {
        return 0.5 * body.masses()[i] * present_velocity(body, b, i).squaredNorm();
      });
    });
    if (!inertial()) energies.kinetic = 0.0;
    if constexpr (synchronous<I>) complete_rates();
    return energies;
  }

  template <class Body>
  BodyTotals add_internal_forces(Body& body, [[maybe_unused]] std::size_t b, double time_step) {
    if constexpr (subcycled<I>)
      if (subcycling()) return pace_[b].add_internal_forces(body, essential_[b], time_step);
    return body.add_internal_forces(time_step, true);
  }

  /// `from_rest`: the step began where no velocity was known, so that its powers are those of its end.
  void evaluate(bool from_rest) {
    const StepEnergies energies = forces(time_, time_, last_step_);
    for_each_body([&](const auto& body, std::size_t b) { check(body, b); });
    // All bodies are sound: what the step has brought is kept.
    for_each_body([&](auto& body, std::size_t b) {
      if (!pace_[b].due()) return;
      body.accept_histories();
      if constexpr (std::decay_t<decltype(body)>::has_director && !synchronous<I>) advance_director(body, pace_[b].step(last_step_));
    });
    for_each_contact([&](auto& between, std::size_t) {
      using Pair = std::decay_t<decltype(between)>;
      if constexpr (requires { between.contact.anchor(std::get<Pair::first>(bodies_)); }) between.contact.anchor(std::get<Pair::first>(bodies_));
    });
    if constexpr (synchronous<I>)  // a tangent needs all histories
      if (decomposition_) for_each_body([](auto& body, std::size_t) { body.complete_points(); });
    book(energies, from_rest);
    evaluated_ = time_;
    drifted_ = false;
  }

  /// Enters what is stored now in the ledger.
  void take_stored(const StepEnergies& energies) {
    ledger_.kinetic = energies.kinetic;
    ledger_.strain = energies.internal.strain_energy;
    ledger_.stabilization = energies.internal.stabilization_energy;
    ledger_.adhesion = energies.contact.potential;
    ledger_.surface = energies.boundary.potential;
  }

  /// Enters a step in the ledger.
  void book(const StepEnergies& energies, bool from_rest) {
    take_stored(energies);
    // The terms' powers are those at the ends of the step; the laws' too, unless velocities are those of its middle.
    double external_power = energies.contact.external_power + energies.boundary.external_power;
    double dissipated_power = energies.contact.dissipated_power + energies.boundary.dissipated_power;
    if constexpr (synchronous<I>) {
      external_power += energies.internal.active_power;
      dissipated_power += energies.internal.dissipated_power;
    } else {
      ledger_.external_work += last_step_ * energies.internal.active_power;
      ledger_.dissipated += last_step_ * energies.internal.dissipated_power;
    }
    if (from_rest) {
      external_power_ = external_power;
      dissipated_power_ = dissipated_power;
    }
    ledger_.external_work += 0.5 * last_step_ * (external_power_ + external_power);
    ledger_.dissipated += 0.5 * last_step_ * (dissipated_power_ + dissipated_power);
    external_power_ = external_power;
    dissipated_power_ = dissipated_power;
    // Only where all bodies are due are energies those of one instant.
    if (last_step_ > 0.0 && std::all_of(pace_.begin(), pace_.end(), [](const BodyPace& pace) { return pace.due(); })) ledger_.note_scale();
  }

  /// The essential conditions of a body at `time`, the end of a step; the work that they do, J.
  template <class Body>
  double impose(Body& body, std::size_t b, double time, double time_step) {
    if (essential_[b].empty()) return 0.0;
    const double work = essential_[b].impose(time, time_step, last_step_, body.displacement, body.velocity, body.in_parts() ? body.share() : nullptr);
    if (time_step > 0.0) body.for_each_particle([&](std::size_t i) { body.force[i] += essential_[b].forces()[i]; });
    return work;
  }

  template <class Place>
  static constexpr bool is_motion = std::is_same_v<std::decay_t<decltype(std::declval<Place>().term)>, PrescribedMotion>;

  /// Begins an observer, or lets it go on with the run whose state was restored.
  template <class O>
  void begin(O& observer, [[maybe_unused]] bool resumed) {
    if constexpr (requires { observer.resume(*this); })
      if (resumed) return observer.resume(*this);
    observer.begin(*this);
  }

  /// Whether masses resist: not in an overdamped scheme.
  [[nodiscard]] bool inertial() const {
    if constexpr (requires { integrator_.inertia; }) return integrator_.inertia;
    else return true;
  }

  /// Whether bodies may take steps of their own.
  [[nodiscard]] bool subcycling() const {
    if constexpr (subcycled<I>) return integrator_.max_ratio > 1;
    else return false;
  }

  /// Half a step with the forces at the present state; those of the conditions are the last ones.
  template <class Body>
  [[nodiscard]] Vector4 present_velocity(const Body& body, std::size_t b, std::size_t i) const {
    if constexpr (velocity_lag == 0.0) return body.velocity[i];
    Vector4 force = body.force[i];
    if (!essential_[b].empty()) force += essential_[b].forces()[i];
    return body.velocity[i] + (velocity_lag * last_step_ / body.masses()[i]) * force;
  }

  /// h ← one Cayley step of Dh/Dt = A h + D (diffusion − J r(h)), at all particles whose director is free.
  template <class Body>
  static void advance_director(Body& body, double time_step) {
    if (time_step <= 0.0) return;
    const auto& law = body.director_law();
    body.for_each_particle([&](std::size_t i) {
      if (body.in_parts() && !body.cloud().part->is_own(i)) return;
      if (!body.anchored.empty() && body.anchored[i]) return;
      const auto [A, J] = body.director_rate(i);
      const Vector3 h = body.director[i].template head<3>();
      const Vector3 source = (law.diffusivity / body.nodal_volumes()[i]) * body.director_flux[i].template head<3>() + J * law.source(h);
      body.director[i].template head<3>() = cayley_update(A, h, time_step, source);
    });
  }

  template <class Body>
  void check(const Body& body, std::size_t b) const {
    const std::size_t q = body.failed_point();
    if (body.in_parts()) {
      if (const int rank = body.failed_rank(); rank >= 0)
        throw ComputationError(fmt::format("rank {}: {}", rank, Ranks::current->text_of(rank, q < body.table().points() ? why_failed(body, q) : "")));
      return;
    }
    if (q == body.table().points()) return;
    const std::string message = why_failed(body, q);
    throw ComputationError(decomposition_ ? decomposition_->told_by_owner(b, q, message) : message);
  }
  /// About a point that is inverted, or not a number.
  template <class Body>
  [[nodiscard]] std::string why_failed(const Body& body, std::size_t q) const {
    const Index particle = body.table().owner[q];
    const Vector3 X = body.reference()[particle].template head<3>();
    const Vector4& u = body.displacement[particle];
    bool finite = u.allFinite();
    for (const TableEntry& entry : body.table().row(q)) finite = finite && body.displacement[entry.particle].allFinite();
    return fmt::format(
        "Body \"{}\", particle {} at X = ({:.4g}, {:.4g}, {:.4g}) m, u = ({:.3g}, {:.3g}, {:.3g}) m, t = {:.6g} s: {}.", body.name(), body.cloud().number(particle), X[0], X[1],
        X[2], u[0], u[1], u[2], time_,
        finite ? "the point is inverted (J <= 0); likely causes are a deformation too large for this resolution, a contact "
                 "too violent, or too weak a stabilisation"
               : "the displacement is not a number; likely causes are a time step above the stable one or a law "
                 "evaluated outside its range");
  }

  /// Undoes the drift of a step whose evaluation broke down.
  void restore() {
    if (!drifted_) return;
    drifted_ = false;
    forces_known_ = false;
    for_each_body([&](auto& body, std::size_t b) {
      body.displacement = previous_[b];
      if (!previous_velocity_[b].empty()) body.velocity = previous_velocity_[b];
      std::fill(body.force.begin(), body.force.end(), Vector4::Zero());
      pace_[b].forget();
      if (loaded(b)) fields_[b].refresh(body, 0.0);
    });
    time_ -= last_step_;
    last_step_ = step_before_;
  }

  // --- shared by several processes ---------------------------------------------------------------------------
  /// Throws ParameterError where processes have parts of a body's cloud that takes part in what needs the whole.
  void require_possible_parts() {
    std::array<std::string, body_count> in_parts;  // names
    std::array<bool, body_count> surface{};
    for_each_body([&](const auto& body, std::size_t b) {
      if (!body.in_parts()) return;
      surface[b] = body.cloud().part->surface;
      in_parts[b] = "Body \"" + body.name() + "\": each process has a part of its cloud; ";
      if (synchronous<I>) throw ParameterError(in_parts[b] + "implicit steps need the whole.");
      if (Ranks::current != nullptr && Ranks::current->sum_order != SumOrder::of_ranks) throw ParameterError(in_parts[b] + "choose SumOrder::of_ranks.");
    });
    const auto require = [&](const char* what, std::size_t n, std::size_t b, Reads reads) {
      if (in_parts[b].empty()) return;
      if (reads == Reads::all) throw ParameterError(fmt::format("{}{} number {} may read all of its particles.", in_parts[b], what, n));
      if (!surface[b]) throw ParameterError(fmt::format("{}{} number {} needs all facets (Part::surface).", in_parts[b], what, n));
    };
    for_each_contact([&](auto& between, std::size_t n) {
      using Pair = std::decay_t<decltype(between)>;
      require("contact", n, Pair::first, reads_a_of<std::decay_t<decltype(between.contact)>>);
      require("contact", n, Pair::second, reads_b_of<std::decay_t<decltype(between.contact)>>);
    });
    for_each_boundary([&](auto& on, std::size_t n) {
      if constexpr (!is_motion<decltype(on)>) require("boundary term", n, std::decay_t<decltype(on)>::body, reads_of<std::decay_t<decltype(on.term)>>);
    });
  }
  /// Leaves to each process its part of the bodies, whose first state every process has evaluated.
  void decompose(Ranks& ranks) {
    std::vector<SharedBody> parts;
    for_each_body([&](auto& body, std::size_t b) {
      parts.push_back(shared_body(body, fields_[b], b));
      if (subcycling()) parts.back().whole.insert(parts.back().whole.end(), {&pace_[b].internal, &pace_[b].held});
    });
    decomposition_ = ranks.decompose(std::move(parts));
    for_each_body([&](auto& body, std::size_t b) {
      body.share_with(decomposition_->share(b));
      fields_[b].ranks = &ranks;
      if (divides_contacts(body) && body.particle_values().identity()) {
        fields_[b].own = &body.share()->own;
        fields_[b].owner = &body.share()->particle_owner;
      }
      terms_.resize(std::max(terms_.size(), body.size()));
    });
    give_back_elsewhere();
  }
  /// Memory of what moves at particles of which this process needs nothing: complete() fills it in where somebody asks. Implicit steps know the state of all particles.
  void give_back_elsewhere() {
    if constexpr (synchronous<I>) return;
    for_each_body([&](auto& body, std::size_t b) {
      const std::vector<Index>& local = body.share()->local;
      for (Field* field : {&body.displacement, &body.velocity, &body.force, &body.director, &body.director_flux, &fields_[b].position, &fields_[b].velocity, &fields_[b].force,
                           &previous_[b], &previous_velocity_[b]})
        if (!field->empty()) give_back_unused(*field, local);
      body.give_back_motion();
      give_back_unused(terms_, local);
    });
  }
  /// For values at the particles of this process.
  template <class Body>
  static void make_room(Field& field, const Body& body) {
    if (field.size() == body.size()) return;
    field.resize(body.size(), Vector4::Zero());
    if (body.share() != nullptr) give_back_unused(field, body.share()->local);
  }
  template <class Body>
  [[nodiscard]] SharedBody shared_body(Body& body, BodyFields& fields, std::size_t b) {
    SharedBody part;
    part.table = &body.table();
    part.made = body.share();
    part.part = body.cloud().part;
    part.keep_rows = synchronous<I> || !body.table().value_based();
    part.motion = {&body.displacement, &body.velocity};
    if constexpr (Body::has_director) part.motion.push_back(&body.director);
    part.known = part.motion;
    part.known.push_back(&body.force);  // velocities at the present instant need it
    part.whole = part.known;
    if (loaded(b)) part.whole.insert(part.whole.end(), {&fields.position, &fields.velocity, &fields.force});
    if constexpr (Body::has_director) part.whole.push_back(&body.director_flux);
    body.for_each_region([&](const auto& region, Index) { part.region_cost.push_back(Body::template cost_of_point<typename std::decay_t<decltype(region)>::Material>); });
    // Interpolated values, and conditions on them, take in the unknowns around.
    bool facets = false, all = !body.particle_values().identity();
    const auto note = [&](std::size_t of, Reads reads) {
      if (of == b) (reads == Reads::facets ? facets : all) = true;
    };
    for_each_contact([&](auto& between, std::size_t) {
      using Pair = std::decay_t<decltype(between)>;
      const bool own = divides_contacts(body) && reads_own_alone(between.contact);
      note(Pair::first, own ? Reads::facets : reads_a_of<std::decay_t<decltype(between.contact)>>);
      note(Pair::second, reads_b_of<std::decay_t<decltype(between.contact)>>);
    });
    for_each_boundary([&](auto& on, std::size_t) {
      if constexpr (!is_motion<decltype(on)>) note(std::decay_t<decltype(on)>::body, reads_of<std::decay_t<decltype(on.term)>>);
    });
    part.known_to_all.assign(body.size(), all ? 1 : 0);
    if (facets)
      for (const auto& facet : body.cloud().facets)
        for (const Index i : facet) part.known_to_all[i] = 1;
    for (int c = 0; c < 3 && !body.in_parts(); ++c)
      for (const auto& condition : essential_[b].conditions(c)) part.known_to_all[condition.particle] = 1;
    return part;
  }
  void begin_exchange() {
    if (!decomposition_) return;
    decomposition_->begin_exchange();
    exchanging_ = true;
  }
  void end_exchange() {
    if (std::exchange(exchanging_, false)) decomposition_->end_exchange();
  }
  /// Makes what the last evaluation left known to all processes; nothing where that has been done.
  void complete() const {
    if (!decomposition_ || !std::exchange(incomplete_, false)) return;
    decomposition_->complete();
    std::apply([&](auto&... c) { (tell_own(c), ...); }, contacts_);
  }
  template <class Between>
  void tell_own(Between& between) const {
    using Pair = std::decay_t<Between>;
    if constexpr (TellsOwn<decltype(between.contact)>) {
      const BodyFields& fields = fields_[Pair::first];
      if (fields.own != nullptr) between.contact.tell_own(*fields.ranks, *fields.own);
    }
  }
  /// Whether each of the processes that share the simulation computes contacts of its own particles of a body: where they sum in their own order, and the body is not small.
  template <class Body>
  [[nodiscard]] static bool divides_contacts(const Body& body) {
    if (synchronous<I> || Ranks::current == nullptr || Ranks::current->size() == 1 || Ranks::current->sum_order == SumOrder::of_one_process) return false;
    return (body.in_parts() ? body.cloud().part->whole : body.size()) >= Ranks::current->divided_contacts_from;
  }
  /// And the rates of the directors.
  void complete_rates() {
    complete();
    if (decomposition_) for_each_body([](auto& body, std::size_t) { body.complete_rates(); });
  }
  template <class Body, class Term>
  [[nodiscard]] double sum_over_particles(std::size_t b, const Body& body, const Term& term) {
    if (!decomposition_ && body.in_parts()) return ParticleSums(body.share(), body.size())([&](std::size_t i) { return Vector4(term(i), 0.0, 0.0, 0.0); })[0];
    if (!decomposition_) return parallel_sum(body.size(), term);
    body.for_each_particle([&](std::size_t i) { terms_[i] = term(i); });
    return decomposition_->sum(b, terms_);
  }

  std::tuple<B...> bodies_;
  mutable std::tuple<C...> contacts_;  // complete() is called by who only looks
  std::tuple<T...> boundaries_;
  I integrator_;
  std::array<BodyFields, body_count> fields_;
  std::array<EssentialConditions, body_count> essential_;
  std::array<StableStep, body_count> stable_;
  std::array<BodyPace, body_count> pace_;
  std::array<double, body_count> body_steps_{};  // asked for by an integrator that sub-cycles, s
  std::array<double, body_count> term_rates_{};  // ω² of contacts and boundary terms, 1/s²
  std::array<Field, body_count> previous_, previous_velocity_;  // before the last drift and the last kick
  bool moved_ = false;
  EnergyLedger ledger_;
  double external_power_ = 0.0, dissipated_power_ = 0.0;  // of contacts and boundary terms at the last evaluation, W
  double time_ = 0.0, last_step_ = 0.0, step_before_ = 0.0;
  double evaluated_ = 0.0;  // the time at which contacts were last told to move on, s: time_ but for round-off
  std::size_t steps_ = 0;
  bool drifted_ = false;      // displacements have moved on, forces have not
  bool forces_known_ = true;  // at the present displacements: not where a step broke down
  double run_start_ = 0.0;
  std::size_t run_start_steps_ = 0;
  bool resumed_ = false;  // the state was restored: the next run goes on with the one that was saved
  std::unique_ptr<Decomposition> decomposition_;  // null where this process computes everything
  bool exchanging_ = false;
  std::vector<double> terms_;  // of a sum over particles
  mutable bool incomplete_ = false;  // what the last evaluation left is known only where it was computed
};

/// Deduced from what is composed.
template <class... B, class... C, class... T, class I>
Simulation(Bodies<B...>, Contacts<C...>, Boundaries<T...>, I) -> Simulation<Bodies<B...>, Contacts<C...>, Boundaries<T...>, I>;

}  // namespace tactoid
