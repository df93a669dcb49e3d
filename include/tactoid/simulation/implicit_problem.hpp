#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/boundary/boundary.hpp>
#include <tactoid/boundary/essential_conditions.hpp>
#include <tactoid/contact/contact.hpp>
#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/integrator/implicit_dynamics.hpp>
#include <tactoid/simulation/stiffness.hpp>

namespace tactoid {

/// A Simulation as an ImplicitProblem. Unknowns are the displacements of all bodies, body by body and particle by particle, and
/// behind each body's displacements its directors (three components):
///   0 = M ü − f(u, u̇, h),   0 = ḣ − A(u̇) h − (D/V_I) flux_I(u, h) + D J r(h).
/// Prescribed displacements and anchored directors are held. The tangent has all of the laws of the bodies, the contacts and terms that
/// know their stiffness (where unknowns are values at the particles), and the diffusion, penalty and turning of the director; it leaves out
/// how director and motion depend on each other.
template <class Simulation>
class SimulationProblem {
 public:
  static constexpr int dimension = Simulation::dimension;  ///< of all bodies

  /// Works on the simulation, which must outlive it. Throws ParameterError for conditions on an interpolated field.
  explicit SimulationProblem(Simulation& simulation) : simulation_(simulation) {
    simulation_.for_each_body([&](auto& body, std::size_t b) {
      begin_[b] = size_;
      size_ += static_cast<Eigen::Index>(dimension * body.size());
      director_[b] = size_;
      if constexpr (has_director<decltype(body)>) size_ += static_cast<Eigen::Index>(3 * body.size());
    });
    held_.assign(static_cast<std::size_t>(size_), 0);
    for_each_essential([&](const auto& body, std::size_t b, const EssentialConditions& essential) {
      if (essential.empty()) return;
      if (!essential.on_values())
        throw ParameterError("Body \"" + body.name() + "\": ImplicitDynamics takes prescribed motion (which a meridian section has on its axis) only where unknowns are "
                             "values at the particles; use a value-based quadrature, such as NodalCentroids.");
      for (int c = 0; c < dimension; ++c)
        for (const auto& condition : essential.conditions(c)) held_[static_cast<std::size_t>(place(b, condition.particle) + c)] = 1;
    });
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      if constexpr (has_director<decltype(body)>)
        for (std::size_t i = 0; i < body.anchored.size(); ++i)
          if (body.anchored[i])
            for (int c = 0; c < 3; ++c) held_[static_cast<std::size_t>(director_place(b, i) + c)] = 1;
    });
    Eigen::VectorXd rate;
    state(start_, rate);
  }

  [[nodiscard]] Eigen::Index size() const { return size_; }           ///< number of unknowns
  [[nodiscard]] double time() const { return simulation_.time(); }    ///< present instant, s
  [[nodiscard]] double first_time_step() const { return simulation_.largest_stable_time_step(); }  ///< stable for explicit schemes, s

  /// Present displacements and directors (m; 1), and their rates; those of the directors are not known, and zero.
  void state(Eigen::VectorXd& z, Eigen::VectorXd& rate) const {
    z.setZero(size_);
    rate.setZero(size_);
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      for (std::size_t i = 0; i < body.size(); ++i) {
        z.segment<dimension>(place(b, i)) = body.displacement[i].template head<dimension>();
        rate.segment<dimension>(place(b, i)) = body.velocity[i].template head<dimension>();
        if constexpr (has_director<decltype(body)>) z.segment<3>(director_place(b, i)) = body.director[i].template head<3>();
      }
    });
  }

  /// Carries a vector of unknowns to particles that were redistributed, by rows of values at the particles (one matrix per body, empty where they
  /// stayed). What is held stays as it is.
  void carry(const std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>>& rows, Eigen::VectorXd& x) const {
    const Eigen::VectorXd before = x;
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      const auto& W = rows[b];
      for (Eigen::Index i = 0; i < W.rows(); ++i) {
        const auto carry_at = [&](auto components, const auto& place_of) {
          constexpr int n = decltype(components)::value;
          Eigen::Matrix<double, n, 1> sum = Eigen::Matrix<double, n, 1>::Zero();
          for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(W, i); it; ++it)
            sum += it.value() * before.segment<n>(place_of(static_cast<std::size_t>(it.col())));
          const Eigen::Index at = place_of(static_cast<std::size_t>(i));
          for (int c = 0; c < n; ++c)
            if (!held_[static_cast<std::size_t>(at + c)]) x[at + c] = sum[c];
        };
        carry_at(std::integral_constant<int, dimension>{}, [&](std::size_t k) { return place(b, k); });
        if constexpr (has_director<decltype(body)>) carry_at(std::integral_constant<int, 3>{}, [&](std::size_t k) { return director_place(b, k); });
      }
    });
  }
  /// Puts the velocities of the bodies into a vector of rates.
  void take_velocities(Eigen::VectorXd& rate) const {
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      for (std::size_t i = 0; i < body.size(); ++i) rate.segment<dimension>(place(b, i)) = body.velocity[i].template head<dimension>();
    });
  }

  /// Diagonal of the box around the body for displacements, m; 1 for directors.
  [[nodiscard]] Eigen::VectorXd scale() const {
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(size_);
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      const Field& X = body.reference();
      Vector4 least = X.front(), most = X.front();
      for (const Vector4& x : X) least = least.cwiseMin(x), most = most.cwiseMax(x);
      scale.segment(begin_[b], static_cast<Eigen::Index>(dimension * body.size())).setConstant((most - least).norm());
    });
    return scale;
  }

  /// Sets the prescribed displacements at the end of a step of dt (s); anchored directors stay.
  void prescribe(double dt, Eigen::VectorXd& z) {
    write(z, Eigen::VectorXd::Zero(size_));
    simulation_.prescribe(dt);
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      for (std::size_t i = 0; i < body.size(); ++i) z.segment<dimension>(place(b, i)) = body.displacement[i].template head<dimension>();
      if constexpr (has_director<decltype(body)>)
        for (std::size_t i = 0; i < body.anchored.size(); ++i)
          if (body.anchored[i]) z.segment<3>(director_place(b, i)) = start_.segment<3>(director_place(b, i));
    });
  }

  /// R at the end of a step: N for displacements, 1/s for directors; zero where held. False where a point is inverted.
  bool residual(const Eigen::VectorXd& z, const Eigen::VectorXd& rate, const Eigen::VectorXd& acceleration, double dt, Eigen::VectorXd& R) {
    write(z, rate);
    if (!simulation_.try_state(dt)) return false;
    R.resize(size_);
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      parallel_for(body.size(), [&](std::size_t i) {
        R.segment<dimension>(place(b, i)) =
            body.masses()[i] * acceleration.segment<dimension>(place(b, i)) - body.force[i].template head<dimension>();
        if constexpr (has_director<decltype(body)>) {
          const auto [A, J] = body.director_rate(i);
          const Vector3 h = body.director[i].template head<3>();
          const auto& law = body.director_law();
          R.segment<3>(director_place(b, i)) = rate.segment<3>(director_place(b, i)) - A * h -
                                               (law.diffusivity / body.nodal_volumes()[i]) * body.director_flux[i].template head<3>() -
                                               J * law.source(h);
        }
      });
    });
    holding_ = R;
    for (Eigen::Index k = 0; k < size_; ++k)
      if (held_[static_cast<std::size_t>(k)]) R[k] = 0.0;
    return true;
  }

  /// dR/dz of what is known of it, at the last residual; unit rows and columns where held.
  [[nodiscard]] StiffnessMatrix tangent(double rate_factor, double acceleration_factor, double dt) {
    std::vector<Eigen::Triplet<double>> entries;
    // Whole columns are copied: the bodies' blocks are by far the largest part.
    std::vector<StiffnessMatrix> blocks;
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      blocks.push_back(assemble_stiffness(body, {.rate_factor = rate_factor, .time_step = dt}));
      for (std::size_t i = 0; i < body.size(); ++i)
        for (int c = 0; c < dimension; ++c)
          entries.emplace_back(static_cast<int>(place(b, i)) + c, static_cast<int>(place(b, i)) + c, acceleration_factor * body.masses()[i]);
      if constexpr (has_director<decltype(body)>) add_director(body, b, rate_factor, entries);
    });
    add_contacts(entries);
    add_terms(entries);
    StiffnessMatrix rest(size_, size_);
    rest.setFromTriplets(entries.begin(), entries.end());
    StiffnessMatrix K = side_by_side(blocks) + rest;
    for (Eigen::Index c = 0; c < K.outerSize(); ++c)
      for (StiffnessMatrix::InnerIterator it(K, c); it; ++it)
        if (held_[static_cast<std::size_t>(it.row())] || held_[static_cast<std::size_t>(c)]) it.valueRef() = it.row() == c ? 1.0 : 0.0;
    return K;
  }

  /// Makes the state of the last residual, which is this one, the present state of the simulation.
  void accept(const Eigen::VectorXd&, const Eigen::VectorXd&, const Eigen::VectorXd&, double dt) {
    std::array<Field, Simulation::body_count> holding;
    simulation_.for_each_body([&](const auto& body, std::size_t b) {
      holding[b].assign(body.size(), Vector4::Zero());
      for (std::size_t i = 0; i < body.size(); ++i) holding[b][i].template head<dimension>() = holding_.segment<dimension>(place(b, i));
    });
    simulation_.accept_state(dt, holding);
  }

 private:
  template <class Body>
  static constexpr bool has_director = std::remove_cvref_t<Body>::has_director;
  [[nodiscard]] Eigen::Index place(std::size_t b, std::size_t i) const { return begin_[b] + static_cast<Eigen::Index>(dimension * i); }
  [[nodiscard]] Eigen::Index director_place(std::size_t b, std::size_t i) const { return director_[b] + static_cast<Eigen::Index>(3 * i); }

  template <class F>
  void for_each_essential(const F& f) {
    [&]<std::size_t... N>(std::index_sequence<N...>) {
      (f(simulation_.template body<N>(), N, simulation_.template essential<N>()), ...);
    }(std::make_index_sequence<Simulation::body_count>{});
  }

  void write(const Eigen::VectorXd& z, const Eigen::VectorXd& rate) {
    simulation_.for_each_body([&](auto& body, std::size_t b) {
      parallel_for(body.size(), [&](std::size_t i) {
        body.displacement[i].template head<dimension>() = z.segment<dimension>(place(b, i));
        body.velocity[i].template head<dimension>() = rate.segment<dimension>(place(b, i));
        if constexpr (has_director<decltype(body)>) body.director[i].template head<3>() = z.segment<3>(director_place(b, i));
      });
    });
  }

  /// The stiffnesses of the bodies in one matrix; nothing for the directors yet.
  [[nodiscard]] StiffnessMatrix side_by_side(const std::vector<StiffnessMatrix>& blocks) const {
    StiffnessMatrix K(size_, size_);
    Eigen::Index entries = 0;
    for (const auto& block : blocks) entries += block.nonZeros();
    K.reserve(entries);
    Eigen::Index column = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      for (; column < begin_[b]; ++column) K.startVec(column);
      for (Eigen::Index c = 0; c < blocks[b].outerSize(); ++c, ++column) {
        K.startVec(column);
        for (StiffnessMatrix::InnerIterator it(blocks[b], c); it; ++it) K.insertBack(begin_[b] + it.row(), column) = it.value();
      }
    }
    for (; column < size_; ++column) K.startVec(column);
    K.finalize();
    return K;
  }

  /// Diffusion Σ_q V_q J G_I C⁻¹ G_J D/V_I, and ḣ − A h + D J r(h) at each particle.
  template <class Body>
  void add_director(const Body& body, std::size_t b, double rate_factor, std::vector<Eigen::Triplet<double>>& entries) const {
    const PointTable& table = body.table();
    const Field displacement = body.displacement_in_table();
    const auto& law = body.director_law();
    // Around an axis a component along it has no part (h_R, h_θ have one) that turns with the angle.
    StiffnessMatrix L = detail::stiffness_pattern<1>(table), along_axis;
    if (table.axisymmetric) along_axis = L;
    for_each_chunk(table, [&](const PointChunk& chunk, std::size_t) {
      for (std::size_t q = chunk.begin; q < chunk.end; ++q) {
        const auto row = detail::pairs_of(table, q);
        const Tensor3 F = Tensor3::Identity() + rows::gradient_at(table, q, displacement);
        const Tensor3 flux = table.volume[q] * F.determinant() * (F.transpose() * F).inverse();
        detail::for_each_block<1>(L, row, [&](std::size_t a, std::size_t c, int at) {
          const Vector3 Ga = row[a].vector(), Gc = row[c].vector();
          const Eigen::Index place = L.outerIndexPtr()[row[c].particle] + at;
          L.valuePtr()[place] += Ga.dot(flux * Gc);
          if (table.axisymmetric) along_axis.valuePtr()[place] += Ga.head<2>().dot(flux.topLeftCorner<2, 2>() * Gc.head<2>());
        });
      }
    });
    for (int c = 0; c < 3; ++c) {
      const StiffnessMatrix& of_component = table.axisymmetric && c == 1 ? along_axis : L;
      for (Eigen::Index j = 0; j < L.outerSize(); ++j)
        for (StiffnessMatrix::InnerIterator it(of_component, j); it; ++it) {
          const auto i = static_cast<std::size_t>(it.row());
          entries.emplace_back(static_cast<int>(director_place(b, i)) + c, static_cast<int>(director_place(b, static_cast<std::size_t>(j))) + c,
                               law.diffusivity / body.nodal_volumes()[i] * it.value());
        }
    }
    for (std::size_t i = 0; i < body.size(); ++i) {
      const auto [A, J] = body.director_rate(i);
      const Vector3 h = body.director[i].template head<3>();
      const double penalty = law.diffusivity * J / (law.core_size * law.core_size);
      Tensor3 local = (rate_factor + penalty * (h.squaredNorm() - 1.0)) * Tensor3::Identity() - A;
      local += (2.0 * penalty) * h * h.transpose();
      detail::add_block<3>(director_place(b, i), director_place(b, i), local, entries);
    }
  }

  // What is known at the particles is known for the unknowns where these are values at the particles.
  void add_contacts(std::vector<Eigen::Triplet<double>>& entries) {
    simulation_.for_each_contact([&](auto& between, std::size_t) {
      using Pair = std::decay_t<decltype(between)>;
      if constexpr (ContactWithStiffness<std::decay_t<decltype(between.contact)>>) {
        constexpr std::array<std::size_t, 2> body = {Pair::first, Pair::second};
        if (!simulation_.template body<Pair::first>().particle_values().identity() ||
            !simulation_.template body<Pair::second>().particle_values().identity())
          return;
        between.contact.add_stiffness(simulation_.template particles<Pair::first>(), simulation_.template particles<Pair::second>(),
                                      [&](bool of_b, Index i, bool by_b, Index j, const Tensor3& k) {
                                        detail::add_block<dimension>(place(body[of_b], i), place(body[by_b], j), k, entries);
                                      });
      }
    });
  }
  void add_terms(std::vector<Eigen::Triplet<double>>& entries) {
    simulation_.for_each_boundary([&](auto& on, std::size_t) {
      constexpr std::size_t b = std::decay_t<decltype(on)>::body;
      if constexpr (TermWithStiffness<std::decay_t<decltype(on.term)>>) {
        if (!simulation_.template body<b>().particle_values().identity()) return;
        on.term.add_stiffness(simulation_.template particles<b>(), [&](Index i, Index j, const Tensor3& k) {
          detail::add_block<dimension>(place(b, i), place(b, j), k, entries);
        });
      }
    });
  }

  Simulation& simulation_;
  Eigen::Index size_ = 0;
  std::array<Eigen::Index, Simulation::body_count> begin_{}, director_{};
  std::vector<char> held_;   // 1 for unknowns that are prescribed or anchored
  Eigen::VectorXd start_;    // the unknowns as the step begins
  Eigen::VectorXd holding_;  // the residual, with the forces that hold
};

}  // namespace tactoid
