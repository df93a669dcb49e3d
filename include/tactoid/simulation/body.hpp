#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/pages.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/director/all.hpp>
#include <tactoid/geometry/measures.hpp>
#include <tactoid/geometry/particle_fields.hpp>
#include <tactoid/geometry/point_cloud.hpp>
#include <tactoid/geometry/validate.hpp>
#include <tactoid/kernel/kernel.hpp>
#include <tactoid/kinematics/kinematics.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/divided_build.hpp>
#include <tactoid/quadrature/quadrature.hpp>
#include <tactoid/quadrature/stored.hpp>
#include <tactoid/quadrature/particle_values.hpp>
#include <tactoid/simulation/decomposition.hpp>
#include <tactoid/simulation/earlier_configuration.hpp>
#include <tactoid/simulation/force_loop.hpp>
#include <tactoid/simulation/redistribution.hpp>
#include <tactoid/simulation/region_laws.hpp>
#include <tactoid/simulation/row_operations.hpp>

namespace tactoid {

/// A deformable body: a point cloud, the kernel and the quadrature that sample it, a law for each of its regions,
/// and, where a law needs one, a director field. Holds the state that an integrator advances.
///
///   Body cell{"cell", ball({...}), Rkpm<3>{}, NodalCentroids{}, Materials{Region{"nucleus", ...}, ...},
///             DirectorField{...}, initial_director};
///
/// The laws are matched to the regions of the cloud by name. Throws ParameterError for a parameter out of range or
/// a region without a law, and GeometryError for a cloud that the kernel cannot sample.
template <class KernelType, class QuadratureType, class MaterialsType, class Director = NoDirector>
class Body;

/// The implementation of Body, with the laws of its regions known one by one: each has a loop of its own.
template <class KernelType, class QuadratureType, class... Ms, class Director>
class Body<KernelType, QuadratureType, Materials<Ms...>, Director> {
 public:
  // Asserted here and not on the template's parameters: so compilers print which requirement is missing.
  static_assert(Kernel<KernelType>, "The third argument of a Body is a Kernel.");
  static_assert(Quadrature<QuadratureType, KernelType>, "The fourth argument of a Body is a Quadrature for its kernel.");
  static constexpr int dimension = KernelType::dimension;                      ///< 1, 2 or 3, that of the kernel and the cloud
  static constexpr bool has_director = !std::is_same_v<Director, NoDirector>;  ///< a director field is carried along
  /// What a point of a region with the law or field of laws M costs in a step beside its pairs, in pairs.
  template <class M>
  static constexpr double cost_of_point = (has_director ? 32.0 : 16.0) * (is_graded<M> ? 4.0 : 1.0);
  /// What the table keeps of a pair: in single precision where the quadrature says so (stored_as).
  using Entry = StoredEntry<QuadratureType>;
  static_assert(has_director || !(uses_director<LawOf<Ms>> || ...),
                "A material of this body needs a director: give the Body a DirectorField and an initial director.");

  /// A body without a director field; throws ParameterError and GeometryError as the class says.
  Body(std::string name, PointCloud<dimension> cloud, KernelType kernel, QuadratureType quadrature, Materials<Ms...> materials)
    requires(!has_director)
      : Body(std::move(name), std::move(cloud), kernel, quadrature, std::move(materials), Director{}, NoDirector{}) {}

  /// `initial` gives the director at the start: a function of the reference position, or a Field over the particles.
  template <class Initial>
  Body(std::string name, PointCloud<dimension> cloud, KernelType kernel, QuadratureType quadrature, Materials<Ms...> materials,
       Director director_law, const Initial& initial)
      : name_(std::move(name)), cloud_(std::move(cloud)), kernel_(kernel), quadrature_(quadrature), director_law_(director_law) {
    if (cloud_.part && Ranks::current != nullptr) Ranks::current->together([&] { tactoid::validate(cloud_); });
    else tactoid::validate(cloud_);
    kernel_.validate();
    director_law_.validate();
    build_table(materials);
    if (has_director && !table_.value_based())
      throw ParameterError("Body \"" + name_ + "\": a director field needs a value-based quadrature, such as NodalCentroids.");
    if (cloud_.axisymmetric && !table_.entries.empty() && std::all_of(table_.entries.begin(), table_.entries.end(), [](const TableEntry& e) { return e.gradient[2] == 0.0; }))
      throw ParameterError("Body \"" + name_ + "\": its quadrature does not support axisymmetric clouds: TableEntry::gradient[2] must be the shape "
                           "function over R there.");
    match_regions(materials, std::index_sequence_for<Ms...>{});
    particle_values_ = ParticleValues(table_.particle_values);
    assemble_masses();
    const std::size_t n = table_.particles;
    displacement.assign(n, Vector4::Zero());
    velocity.assign(n, Vector4::Zero());
    force.assign(n, Vector4::Zero());
    if constexpr (has_director) {
      if constexpr (std::is_same_v<Initial, Field>) this->director = initial;
      else this->director = initial_director(cloud_, initial);
      if (this->director.size() != n)
        throw ParameterError(fmt::format("Body \"{}\": the initial director has {} vectors, the cloud has {} particles.",
                                         name_, this->director.size(), n));
      director_flux.assign(n, Vector4::Zero());
      point_rate_.assign(table_.points(), Tensor3::Zero());
      point_volume_ratio_.assign(table_.points(), 1.0);
      points_of_particle_.assign(n, {});
      for (Index q = 0; q < table_.points(); ++q) points_of_particle_[table_.owner[q]].push_back(q);
    }
    follow_table();
  }

  // --- state -------------------------------------------------------------------------------------------------
  Field displacement;   ///< unknowns u_I (values at the particles, or coefficients) since the first configuration, m
  Field velocity;       ///< their rates, `velocity_lag` of the last step before the present instant, m/s
  double velocity_lag = 0.5;  ///< ½ for leapfrog integrators, 0 where velocities belong to the end of the step
  Field force;          ///< forces conjugate to the unknowns, N
  Field director;       ///< h_I; empty without a director field
  Field director_flux;  ///< −Σ_q V_q J (∇₀h C⁻¹) G_qI, m; the diffusion of the director
  std::vector<char> anchored;  ///< 1 where the director is held (anchoring); empty or one per particle

  // --- parts -------------------------------------------------------------------------------------------------
  [[nodiscard]] const std::string& name() const { return name_; }                        ///< begins the messages about this body
  [[nodiscard]] const PointCloud<dimension>& cloud() const { return cloud_; }            ///< the reference configuration
  [[nodiscard]] const KernelType& kernel() const { return kernel_; }                     ///< with its support
  [[nodiscard]] const QuadratureType& quadrature() const { return quadrature_; }         ///< with its stabilisation
  [[nodiscard]] const PointTable& table() const { return table_; }                       ///< points, volumes and gradients, as the quadrature built them; on the updated reference, if there was one
  [[nodiscard]] const Director& director_law() const { return director_law_; }           ///< parameters of the director field
  [[nodiscard]] const std::vector<double>& masses() const { return masses_; }            ///< lumped, kg
  [[nodiscard]] const std::vector<double>& nodal_volumes() const { return volumes_; }    ///< reference, m³
  [[nodiscard]] const ParticleValues& particle_values() const { return particle_values_; }  ///< from unknowns to values at the particles
  [[nodiscard]] std::size_t size() const { return table_.particles; }                    ///< number of particles
  /// Positions X_I of the first configuration, m. Not to be held across an update of the reference.
  [[nodiscard]] const Field& reference() const { return earlier_.empty() ? table_.particle_position : earlier_.position; }
  /// Volume of a quadrature point in the first configuration, m³: what laws and densities are per.
  [[nodiscard]] double point_volume(std::size_t q) const { return earlier_.empty() ? table_.volume[q] : earlier_.volume[q]; }

  /// Calls f(RegionLaw&, index of the region) for every region.
  template <class F>
  void for_each_region(const F& f) {
    std::apply([&](auto&... region) { Index r = 0; (f(region, r++), ...); }, laws_);
  }
  /// Calls f(const RegionLaw&, index of the region) for every region.
  template <class F>
  void for_each_region(const F& f) const {
    std::apply([&](const auto&... region) { Index r = 0; (f(region, r++), ...); }, laws_);
  }

  /// Calls f(i) for the particles that this process computes: all, unless others share the body. As parallel_for.
  template <class F>
  void for_each_particle(const F& f) const {
    const Index* const local = share_ ? share_->local.data() : nullptr;
    parallel_for(local ? share_->local.size() : size(), [&](std::size_t k) { f(local ? local[k] : k); });
  }

  // --- reference ---------------------------------------------------------------------------------------------
  /// F₀ of point q, from the first configuration to that of the table; 1 where these are the same.
  [[nodiscard]] Tensor3 earlier_gradient(std::size_t q) const { return earlier_.empty() ? Tensor3(Tensor3::Identity()) : earlier_.gradient[q]; }
  /// Displacement of the particles from the first configuration to that of the table, m.
  [[nodiscard]] Field displacement_of_table() const {
    Field u(size(), Vector4::Zero());
    if (!earlier_.empty())
      for (std::size_t i = 0; i < u.size(); ++i) u[i] = table_.particle_position[i] - earlier_.position[i];
    return u;
  }
  /// Displacement of the particles since the configuration of the table, m: its gradients are those of the table.
  [[nodiscard]] Field displacement_in_table() const {
    if (earlier_.empty()) return displacement;
    Field u(size());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = displacement[i] + earlier_.position[i] - table_.particle_position[i];
    return u;
  }

  /// By how much lengths have changed since the configuration of the table: the largest stretch of a point, or the inverse of the
  /// smallest, whichever is more; a bound that is exact where two stretches are equal. >= 1; infinite where a point is inverted.
  [[nodiscard]] double distortion() const {
    const Field u = displacement_in_table();
    std::vector<double> largest(table_.chunks.size(), 0.0);
    for_each_chunk(table_, [&](const PointChunk& chunk, std::size_t c) {
      for (std::size_t q = chunk.begin; q < chunk.end; ++q) {
        const Tensor3 F = Tensor3::Identity() + rows::gradient_at(table_, q, u);
        const Inversion<double> inverse = invert(F);
        const double most = std::max(largest_eigenvalue_bound<double>(F.transpose() * F),
                                     largest_eigenvalue_bound<double>(inverse.inverse * inverse.inverse.transpose()));
        largest[c] = std::max(largest[c], inverse.determinant > 0.0 ? most : std::numeric_limits<double>::infinity());
      }
    });
    return std::sqrt(*std::max_element(largest.begin(), largest.end()));
  }

  /// Takes the present configuration as that on which neighbours, shape functions and points are defined. Particles, masses, velocities, the
  /// positions of points between their particles, and the laws with all that they remember (stress, energy, histories) are
  /// carried over as they are, so that mass and momentum are kept to the bit, and the elastic energy of solids is. The stabilisation starts
  /// anew: its energy is lost. The volume ratio of fluids (regions whose laws have no shear_modulus) is smoothed. `displacement` still counts from the first configuration. Forces are those of the table
  /// before until they are evaluated again. Throws GeometryError or ComputationError where the quadrature cannot sample the present
  /// configuration, and ParameterError for a periodic cloud and where several processes share the body; it is then as it was.
  void update_reference() {
    MovedReference moved = moved_reference();
    PointTable table = quadrature_.build_moved(moved.cloud, kernel_, moved.cells);
    earlier_ = std::move(moved.earlier);
    adopt(std::move(table));
  }

  /// The same with particles that are moved (redistribute in redistribution.hpp): all but those of solids (regions whose laws have a shear modulus)
  /// and those with a value in `held`, one per particle. What is kept, and how:
  ///   - the surface to second order in the facets, and the volume that it encloses: exactly that of the points, to which it is brought;
  ///   - the mass of each region to round-off: the cells of a fluid are the nodal cells of the particles, and its volume ratio is carried
  ///     along (carrying_rows), so that V_q is the volume of the cell over J. Lumped masses are made anew from it;
  ///   - linear momentum, in a plane angular momentum too, to round-off: velocities and directors are carried along, affine fields
  ///     exactly, and what momentum lacks is given to the particles that are not held as a rigid motion;
  ///   - solids, as they are. Of a fluid's F₀ the volume ratio alone is kept, all that it has.
  /// A particle is then a label: its place is exact, `displacement` is from the first place of the label, not of the matter that is there.
  /// Throws as update_reference() does, GeometryError where a cell would be inverted, and ParameterError as require_redistributable().
  RedistributedParticles update_reference(const Redistribution& parameters, const std::vector<char>& held)
    requires(dimension == 2)
  {
    require_redistributable();
    MovedReference moved = moved_reference();
    RedistributedParticles result;
    std::vector<char> stays = held;
    stays.resize(size(), 0);
    std::vector<char> solid(table_.points(), 1);
    for_each_region([&](const auto& region, Index) {
      if (is_fluid(region)) std::fill(solid.begin() + static_cast<std::ptrdiff_t>(region.begin), solid.begin() + static_cast<std::ptrdiff_t>(region.end), 0);
    });
    PointCloud<dimension> first = cloud_;
    for (std::size_t i = 0; i < size(); ++i) first.positions[i] = reference()[i].template head<dimension>();
    // The cells of solids are no polygons of their particles: what they lack is none of the fluid's.
    double wanted = 0.0;
    for (std::size_t q = 0; q < solid.size(); ++q) {
      if (solid[q]) stays[table_.owner[q]] = 1;
      else wanted += moved.cells[q].volume;
    }
    const std::vector<NodalCell<dimension>> present = cells_of_points(moved.cloud);
    for (std::size_t q = 0; q < solid.size(); ++q)
      if (solid[q]) wanted += present[q].volume;
    PointCloud<dimension> cloud = moved.cloud;
    result.surface = redistribute(cloud, first, stays, wanted, parameters);
    result.rows = detail::carrying_rows(kernel_, moved.cloud, cloud.positions);
    redistribute_points(moved, cloud);

    PointTable table = quadrature_.build_moved(cloud, kernel_, moved.cells);
    const std::vector<double> masses = masses_;
    Field position(size());
    for (std::size_t i = 0; i < size(); ++i) position[i] = pad(moved.cloud.positions[i]);
    EarlierConfiguration earlier = std::exchange(earlier_, std::move(moved.earlier));
    const bool before = std::exchange(redistributed_, true);
    try {
      adopt(std::move(table));
    } catch (const GeometryError&) {
      earlier_ = std::move(earlier);
      redistributed_ = before;
      throw;
    }
    for (std::size_t i = 0; i < size(); ++i) displacement[i] = pad(cloud.positions[i]) - reference()[i];
    Field carried = detail::carried(result.rows, velocity);
    for (std::size_t i = 0; i < size(); ++i)
      if (cloud_.axisymmetric && cloud.positions[i][0] == 0.0) carried[i][0] = 0.0;
    keep_momentum(masses, position, carried, held);
    velocity = std::move(carried);
    if constexpr (has_director) director = detail::carried(result.rows, director);
    return result;
  }

  /// Throws ParameterError where particles cannot be redistributed: in one and three dimensions, under fluids (laws without a shear modulus) that are
  /// graded or have a history, and where the quadrature has not one point per particle and region.
  void require_redistributable() const {
    if (dimension != 2) throw ParameterError(fmt::format("Redistribution: the particles of body \"{}\" cannot be moved in {} dimensions, only in a plane or a meridian section.", name_, dimension));
    for_each_region([&](const auto& region, Index r) {
      using Region = std::decay_t<decltype(region)>;
      if (!is_fluid(region)) return;
      if (Region::graded) throw ParameterError(fmt::format("Redistribution: the law of region {} of body \"{}\" belongs to places of the first configuration (Graded), its particles cannot be moved.", r, name_));
      if (history_size<typename Region::Law> > 0) throw ParameterError(fmt::format("Redistribution: the law of region {} of body \"{}\" has a history, its particles cannot be moved.", r, name_));
    });
    for (std::size_t q = 1; q < table_.points(); ++q)
      if (table_.owner[q] == table_.owner[q - 1] && table_.region[q] == table_.region[q - 1])
        throw ParameterError("Redistribution: body \"" + name_ + "\" needs a quadrature with one point per particle and region, such as NodalCentroids.");
  }
  /// Whether a region of the body is a fluid: without one its particles are not moved.
  [[nodiscard]] bool has_fluid() const {
    bool fluid = false;
    for_each_region([&](const auto& region, Index) { fluid = fluid || is_fluid(region); });
    return fluid;
  }

  // --- forces ------------------------------------------------------------------------------------------------
  /// Adds the internal forces at the present state to `force` (and sets the director's flux and rates), and returns
  /// energies and powers. One pass over the table. With `advance` the histories advanced by `time_step` wait for
  /// accept_histories(): a step that breaks down has not touched them.
  BodyTotals add_internal_forces(double time_step, bool advance) {
    if constexpr (has_director) for_each_particle([&](std::size_t i) { director_flux[i].setZero(); });
    bool rates = false;
    for_each_region([&](const auto& region, Index) { rates = rates || needs_rate(region); });
    if (rates) pack_motion();
    if (share_)
      for (const Index i : share_->abroad) force[i].setZero();
    if (!earlier_.empty()) relative_ = displacement_in_table();
    const Loop loop = force_loop();
    for_each_chunk(table_, [&](const PointChunk& chunk, std::size_t c) {
      const bool keep = advance && is_counted(c);  // the first points of other processes share a block with the last own ones
      visit(chunk.region, [&](auto& region) {
        if constexpr (Loop::template always_with_rates<std::decay_t<decltype(region)>>)
          chunks_[c] = loop.template pass<true>(region, chunk, time_step, keep);
        else if (needs_rate(region))
          chunks_[c] = loop.template pass<true>(region, chunk, time_step, keep);
        else
          chunks_[c] = loop.template pass<false>(region, chunk, time_step, keep);
      });
    });
    if (share_) meet_other_ranks();
    return find_totals();
  }

  /// Makes the histories of the last add_internal_forces(…, true) those of the body.
  void accept_histories() {
    for_each_region([](auto& region, Index) { std::swap(region.histories, region.advanced); });
  }

  /// The first point whose volume ratio is not positive (or is NaN) after add_internal_forces; points() if none. Where each process has a part, of this one: the others know failed_rank().
  [[nodiscard]] std::size_t failed_point() const { return found_.failure == no_failure ? table_.points() : found_.failure; }
  /// Of a body in parts: the first process that has such a point; -1 if none.
  [[nodiscard]] int failed_rank() const { return found_.failed_rank; }

  // --- stable step -------------------------------------------------------------------------------------------
  /// Largest squared wave number that region r's points carry in the present configuration, 1/m², as bounded by
  /// the shape of the rows alone: max_q k_q² ‖F_q⁻¹‖². Known after add_internal_forces.
  [[nodiscard]] const std::vector<double>& region_wave_numbers() const { return found_.stretch; }

  /// Largest volume ratio J over the points of a body with a director. Known after add_internal_forces.
  [[nodiscard]] double largest_volume_ratio() const
    requires has_director
  {
    return found_.largest_volume_ratio;
  }

  // --- views -------------------------------------------------------------------------------------------------
  /// Cauchy stress and volume ratio at all quadrature points, without advancing any history.
  [[nodiscard]] std::vector<PointSample> sample_points() {
    std::vector<PointSample> samples(table_.points());
    pack_motion();
    const Loop loop = force_loop();
    for_each_region([&](auto& region, Index) { loop.sample(region, samples); });
    if (share_ && !in_parts()) gather_at_points<10>([&](std::size_t q, auto at) {
      for (int a = 0; a < 9; ++a) at(a, samples[q].cauchy(a % 3, a / 3));
      at(9, samples[q].J);
    });
    return samples;
  }

  /// A field of unknowns as values at the particles.
  [[nodiscard]] Field at_particles(const Field& unknowns) const { return particle_values_.evaluate(unknowns); }

  /// Rate operator A of the director at a particle (Dh/Dt = A h + …) and the volume ratio there.
  [[nodiscard]] std::pair<Tensor3, double> director_rate(std::size_t particle) const {
    Tensor3 A = Tensor3::Zero();
    double J = 0.0, V = 0.0;
    for (Index q : points_of_particle_[particle]) {
      A += table_.volume[q] * point_rate_[q];
      J += table_.volume[q] * point_volume_ratio_[q];
      V += table_.volume[q];
    }
    return {A / V, J / V};
  }

  // --- shared by several processes ---------------------------------------------------------------------------
  /// How the rows of the table are divided among the processes that have made it together; null where this one has all of them.
  [[nodiscard]] BodyShare* share() const { return share_.get(); }
  /// Whether this process has a part of the cloud only (CloudPart): particles and points are numbered in it, and nobody has the whole.
  [[nodiscard]] bool in_parts() const { return share_ && share_->part; }
  /// Leaves to other processes what is not in this share of the body. Everything must be evaluated before.
  void share_with(std::shared_ptr<BodyShare> share) {
    share_ = std::move(share);
    share_->drop_rows(table_);
  }
  /// Gives back the memory of the packed motion of particles that are not in this share of the body.
  void give_back_motion() { give_back_unused(motion_, share_->local); }
  /// Makes the rates of the director known at all points. Collective, as Decomposition's functions; nothing in a body that is not shared.
  void complete_rates() {
    if constexpr (has_director)
      if (share_ && !in_parts()) gather_at_points<10>([&](std::size_t q, auto at) {
        for (int a = 0; a < 9; ++a) at(a, point_rate_[q](a % 3, a / 3));
        at(9, point_volume_ratio_[q]);
      });
  }
  /// Makes the rates of the director and the histories known at all points; as complete_rates().
  void complete_points() {
    complete_rates();
    if (!share_ || in_parts()) return;
    for_each_region([&](auto& region, Index) {
      using Region = std::decay_t<decltype(region)>;
      constexpr std::size_t scalars = history_size<typename Region::Law>;
      if constexpr (scalars > 0) gather_at_points<scalars>([&](std::size_t q, auto at) {
        if (q < region.begin || q >= region.end) return;
        auto* numbers = history_scalars<typename Region::Law, typename Region::Scalar>(region.histories[region.block(q)]);
        const int l = static_cast<int>((q - region.begin) % static_cast<std::size_t>(Region::width));
        for (std::size_t k = 0; k < scalars; ++k) at(k, numbers[k], l);
      });
    });
  }

  /// What a step leaves to the next one. The reference positions tell bodies apart.
  template <class Archive>
  void state(Archive& archive) {
    if constexpr (!Archive::restoring) complete_points();
    const StateRows of_particles = particle_rows(), of_points = point_rows();
    const StateRows* const particles = cloud_.part ? &of_particles : nullptr;
    const StateRows* const points = cloud_.part ? &of_points : nullptr;
    const auto expect = [&] {
      archive.expect("reference", reference(), particles);
      archive.expect("points", points != nullptr ? points->length : table_.points());
    };
    if (in_parts()) Ranks::current->together(expect);
    else expect();
    restore_reference(archive);
    archive.expect("pairs", table_.pairs());
    archive.expect("bytes_per_pair", sizeof(Entry));
    archive("displacement", displacement, particles);
    archive("velocity", velocity, particles);
    archive("force", force, particles);
    archive("region_wave_numbers", found_.stretch);
    if constexpr (has_director) {
      archive("director", director, particles);
      archive("director_flux", director_flux, particles);
      archive("anchored", anchored, particles);
      archive("point_rate", point_rate_, points);
      archive("point_volume_ratio", point_volume_ratio_, points);
    }
    for_each_region([&](auto& region, Index r) {
      const std::string name = "region_" + std::to_string(r);
      if (points != nullptr) archive.part(name, region, point_rows(region.begin, region.end));
      else archive.part(name, region);
    });
    if constexpr (Archive::restoring && has_director) {
      double most = 0.0;
      for (std::size_t q = 0; q < table_.points(); ++q)
        if (!in_parts() || share_->part->is_own(table_.owner[q])) most = std::max(most, point_volume_ratio_[q]);
      found_.largest_volume_ratio = in_parts() ? share_->largest(most) : most;
    }
  }
  /// Own particles among those of the whole cloud, for checkpoints of a body with a part of one.
  [[nodiscard]] StateRows particle_rows() const {
    StateRows rows{.size = size(), .length = cloud_.part ? cloud_.part->whole : 0, .here = {}, .number = {}};
    if (cloud_.part)
      for (const Index i : cloud_.part->own) rows.add(i, cloud_.part->number[i]);
    return rows;
  }

  /// Bytes of the tables and fields of the body, without its cloud (some 60 bytes per particle), and without what a simulation keeps beside it.
  [[nodiscard]] std::size_t memory() const {
    std::size_t sum = table_.memory();
    const auto add = [&](const auto&... list) { ((sum += list.capacity() * sizeof(list[0])), ...); };
    for_each_region([&](const auto& region, Index) { add(region.histories, region.advanced); });
    add(displacement, velocity, force, director, director_flux, anchored, masses_, volumes_, point_scale_, motion_, relative_);
    add(chunks_, point_rate_, point_volume_ratio_, points_of_particle_, earlier_.gradient, earlier_.volume, earlier_.position);
    for (const auto& points : points_of_particle_) add(points);
    return sum;
  }

 private:
  using Loop = ForceLoop<dimension, Director, Entry>;
  static constexpr std::size_t no_failure = ChunkResult{}.failure;

  /// What the force loop found in the whole body.
  struct Found {
    std::vector<double> stretch = std::vector<double>(sizeof...(Ms), 0.0);  // of each region
    double largest_volume_ratio = 1.0;
    std::size_t failure = no_failure;
    int failed_rank = -1;
  };

  /// Everything that depends on the rows of the table and not on their values.
  void follow_table() {
    table_.mass_shares = std::vector<double>();  // an assignment of {} would keep the memory
    chunks_.assign(table_.chunks.size(), {});
    found_ = {};
    point_scale_ = wave_numbers();
    if constexpr (std::is_same_v<Entry, SingleTableEntry>) table_.use_single_precision();
    if (share_) table_.pairs_elsewhere = share_->count_pairs(table_) - table_.size();
    longest_row_ = 0;
    for (Index q = 0; q < table_.points(); ++q) {
      const std::size_t row = table_.row(q).size(), bonds = table_.bonds(q).size();
      if (row % 2 != 0 || bonds % 2 != 0 || bonds > row)
        throw GeometryError(fmt::format("Body \"{}\": the quadrature has made a row of {} entries and {} bonds at point {}; both must be even (lay_out_rows), and bonds no more.",
                                        name_, row, bonds, q));
      longest_row_ = std::max(longest_row_, row);
    }
  }

  /// The present configuration as a new reference: particles, points with their volumes, and what is kept of the first one.
  struct MovedReference {
    PointCloud<dimension> cloud;
    std::vector<NodalCell<dimension>> cells;
    EarlierConfiguration earlier;
  };
  [[nodiscard]] MovedReference moved_reference() const {
    require_whole();
    static_assert(requires(const QuadratureType& q, const std::vector<NodalCell<dimension>>& cells) { { q.build_moved(cloud_, kernel_, cells) } -> std::same_as<PointTable>; },
                  "The reference of a body can be updated if its quadrature has build_moved(cloud, kernel, cells), as NodalCentroids.");
    const Field u = displacement_in_table();
    MovedReference moved{cloud_, {}, {reference(), earlier_.volume, {}}};
    auto& [cloud, cells, earlier] = moved;
    if (earlier.volume.empty()) earlier.volume = table_.volume;
    for (std::size_t i = 0; i < u.size(); ++i) cloud.positions[i] = (table_.particle_position[i] + u[i]).template head<dimension>();
    cells.resize(table_.points());
    for (std::size_t q = 0; q < cells.size(); ++q) {
      const Index owner = table_.owner[q];
      const Tensor3 F = Tensor3::Identity() + rows::gradient_at(table_, q, u);
      const Vector3 offset = table_.position[q] - table_.particle_position[owner].template head<3>();
      cells[q] = {owner, table_.region[q], 0.0, cloud.positions[owner] + (F * offset).template head<dimension>()};
      if (table_.axisymmetric) cells[q].centroid[0] = table_.position[q][0] * F(2, 2);  // the stretch of the ring
      if (!(determinant(F) > 0.0))
        throw GeometryError(fmt::format("Body \"{}\": the reference cannot be updated, the point of particle {} is inverted.", name_, owner));
      earlier.gradient.push_back(F * earlier_gradient(q));
    }
    for_each_region([&](const auto& region, Index) {
      if (is_fluid(region)) smooth_volume_ratio(table_, region.begin, region.end, earlier);
    });
    for (std::size_t q = 0; q < cells.size(); ++q) {
      cells[q].volume = earlier.volume[q] * determinant(earlier.gradient[q]);
      if (!(cells[q].volume > 0.0))
        throw GeometryError(fmt::format("Body \"{}\": the reference cannot be updated, the volume ratio around particle {} jumps too much.", name_, table_.owner[q]));
    }
    return moved;
  }

  template <class Region>
  [[nodiscard]] static bool is_fluid(const Region& region) {
    return std::all_of(region.laws.begin(), region.laws.end(), [](const auto& law) { return shear_modulus(law) == 0.0; });
  }

  /// Nodal cells in the order of the points.
  [[nodiscard]] static std::vector<NodalCell<dimension>> cells_of_points(const PointCloud<dimension>& cloud) {
    std::vector<NodalCell<dimension>> cells = nodal_cells(cloud);
    std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return std::pair(a.region, a.particle) < std::pair(b.region, b.particle); });
    return cells;
  }

  /// Gives the points of fluids the nodal cells of the moved particles, their volume ratio as it was there, and the volume of the
  /// first configuration that belongs to both.
  void redistribute_points(MovedReference& moved, const PointCloud<dimension>& cloud) const {
    const std::vector<NodalCell<dimension>> fresh = cells_of_points(cloud);
    for_each_region([&](const auto& region, Index) {
      if (!is_fluid(region)) return;
      PointCloud<dimension> centroids;
      std::vector<Point<dimension>> places;
      const std::size_t n = region.end - region.begin;
      Eigen::VectorXd ratio(static_cast<Eigen::Index>(n));
      double before = 0.0, after = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t q = region.begin + k;
        centroids.positions.push_back(moved.cells[q].centroid);
        places.push_back(fresh[q].centroid);
        ratio[static_cast<Eigen::Index>(k)] = determinant(moved.earlier.gradient[q]);
        before += moved.earlier.volume[q];
      }
      ratio = (detail::carrying_rows(kernel_, centroids, places) * ratio).eval();
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t q = region.begin + k;
        const double J = ratio[static_cast<Eigen::Index>(k)];
        if (!(J > 0.0) || !(fresh[q].volume > 0.0))
          throw GeometryError(fmt::format("Body \"{}\": the particles cannot be redistributed, the volume ratio around particle {} jumps too much.", name_, table_.owner[q]));
        moved.cells[q].centroid = fresh[q].centroid;
        moved.cells[q].volume = fresh[q].volume;
        after += moved.earlier.volume[q] = fresh[q].volume / J;
      }
      for (std::size_t q = region.begin; q < region.end; ++q) {
        moved.earlier.volume[q] *= before / after;
        moved.earlier.gradient[q] = std::cbrt(fresh[q].volume / moved.earlier.volume[q]) * Tensor3::Identity();
      }
    });
  }

  /// Adds the rigid motion of the particles that are not held to velocities that were carried along, with which momentum is what it was.
  void keep_momentum(const std::vector<double>& masses, const Field& positions, Field& carried, const std::vector<char>& held) const {
    const bool turns = !cloud_.axisymmetric;
    Vector3 lacking = Vector3::Zero();
    Tensor3 moments = Tensor3::Zero();
    Vector4 middle = Vector4::Zero();
    double length = 0.0;
    for (const Vector4& x : positions) middle += x / static_cast<double>(positions.size());
    for (const Vector4& x : positions) length = std::max(length, (x - middle).norm());
    // Velocities of the two translations, and of a turn by 1/length.
    const auto modes = [&](const Vector4& x) {
      Eigen::Matrix<double, 2, 3> m;
      const Vector4 r = (x - middle) / length;
      m << 1.0, 0.0, -r[1], 0.0, 1.0, r[0];
      return m;
    };
    for (std::size_t i = 0; i < size(); ++i) {
      const Eigen::Matrix<double, 2, 3> now = modes(reference()[i] + displacement[i]);
      lacking += masses[i] * modes(positions[i]).transpose() * velocity[i].template head<2>() - masses_[i] * now.transpose() * carried[i].template head<2>();
      if (held.empty() || !held[i]) moments += masses_[i] * now.transpose() * now;
    }
    if (!turns) {  // along the axis alone
      if (moments(1, 1) > 0.0)
        for (std::size_t i = 0; i < size(); ++i)
          if (held.empty() || !held[i]) carried[i][1] += lacking[1] / moments(1, 1);
      return;
    }
    if (!(moments(0, 0) > 0.0)) return;
    const Vector3 rigid = moments.ldlt().solve(lacking);
    for (std::size_t i = 0; i < size(); ++i)
      if (held.empty() || !held[i]) carried[i].template head<2>() += modes(reference()[i] + displacement[i]) * rigid;
  }

  void require_whole() const {
    if (share_) throw ParameterError("Body \"" + name_ + "\": several processes share it, and so it keeps its reference.");
  }

  /// Own points [begin, end), which count from there: of one region, by the number of their particle in the whole cloud.
  [[nodiscard]] StateRows point_rows(std::size_t begin, std::size_t end) const {
    StateRows rows{.size = end - begin, .length = cloud_.part->whole, .here = {}, .number = {}};
    for (std::size_t q = begin; q < end; ++q)
      if (cloud_.part->is_own(table_.owner[q])) rows.add(q - begin, cloud_.part->number[table_.owner[q]]);
    return rows;
  }
  /// Those of all regions, one behind the other.
  [[nodiscard]] StateRows point_rows() const {
    StateRows all{.size = table_.points(), .length = 0, .here = {}, .number = {}};
    if (!cloud_.part) return all;
    for_each_region([&](const auto& region, Index) {
      const StateRows rows = point_rows(region.begin, region.end);
      for (std::size_t k = 0; k < rows.here.size(); ++k) all.add(region.begin + rows.here[k], all.length + rows.number[k]);
      all.length += rows.length;
    });
    return all;
  }

  /// Goes on with a table of the same points on another reference; where its masses are not positive, with the one before.
  void adopt(PointTable table) {
    PointTable before = std::exchange(table_, std::move(table));
    if (redistributed_) {
      std::vector<double> masses = masses_, volumes = volumes_;
      try {
        assemble_masses();
      } catch (const GeometryError&) {
        table_ = std::move(before);
        masses_ = std::move(masses);
        volumes_ = std::move(volumes);
        throw;
      }
    }
    for_each_region([&](const auto& region, Index) { region.scale_stabilization(quadrature_, table_.stabilization_scale); });
    follow_table();
  }

  /// The table is built again from where its particles and points were.
  template <class Archive>
  void restore_reference(Archive& archive) {
    Field particles;
    std::vector<Vector3> points;
    std::vector<double> volumes;
    EarlierConfiguration earlier = earlier_;
    if (!earlier_.empty()) particles = table_.particle_position, points = table_.position, volumes = table_.volume;
    if constexpr (Archive::restoring) particles.clear(), points.clear(), volumes.clear(), earlier = {};
    archive("updated_reference", particles);
    archive("updated_points", points);
    archive("updated_volumes", volumes);
    archive("earlier_volumes", earlier.volume);
    archive("earlier_gradients", earlier.gradient);
    archive("redistributed", redistributed_);
    if constexpr (Archive::restoring && requires(const std::vector<NodalCell<dimension>>& cells) { quadrature_.build_moved(cloud_, kernel_, cells); }) {
      if (particles.empty() && !earlier_.empty())
        throw ParameterError("Body \"" + name_ + "\": a state before an update of the reference cannot be restored after it; compose the simulation anew.");
      if (particles.empty()) return;
      require_whole();
      earlier.position = reference();
      PointCloud<dimension> cloud = cloud_;
      std::vector<NodalCell<dimension>> cells(points.size());
      for (std::size_t i = 0; i < particles.size(); ++i) cloud.positions[i] = particles[i].template head<dimension>();
      for (std::size_t q = 0; q < cells.size(); ++q) cells[q] = {table_.owner[q], table_.region[q], volumes[q], points[q].template head<dimension>()};
      earlier_ = std::move(earlier);
      adopt(quadrature_.build_moved(cloud, kernel_, cells));
    }
  }

  /// Every rank makes all rows; or its own where it has a part of the cloud, or the session says so and the quadrature can.
  void build_table(const Materials<Ms...>& materials) {
    Ranks* const ranks = Ranks::current != nullptr && Ranks::current->size() > 1 ? Ranks::current : nullptr;
    constexpr bool can_divide = requires(DividedBuild* divided) { quadrature_.build(cloud_, kernel_, divided); };
    if (cloud_.part && (!can_divide || cloud_.part->ranks != (ranks != nullptr ? ranks->size() : 1)))
      throw ParameterError(!can_divide ? "Body \"" + name_ + "\": its cloud is a part of a whole, which NodalCentroids alone can sample."
                                       : fmt::format("Body \"{}\": its cloud is one of {} parts, and there {} to share it.", name_, cloud_.part->ranks,
                                                     ranks == nullptr ? std::string("is one process") : fmt::format("are {} processes", ranks->size())));
    if constexpr (can_divide)
      if (ranks != nullptr && (cloud_.part || ranks->set_up == SetUp::divided)) {
        std::vector<double> costs(cloud_.regions.size(), 0.0);
        for (std::size_t r = 0; r < costs.size(); ++r)
          materials.for_each([&](std::size_t, const auto& region) {
            if (region.name == cloud_.regions[r]) costs[r] = cost_of_point<std::decay_t<decltype(region.material)>>;
          });
        DividedBuild divided(*ranks, std::move(costs));
        table_ = quadrature_.build(cloud_, kernel_, &divided);
        share_ = std::dynamic_pointer_cast<BodyShare>(divided.share());
        if (share_ == nullptr) throw ParameterError("Body \"" + name_ + "\": Ranks::divide must give a BodyShare.");
        return;
      }
    table_ = quadrature_.build(cloud_, kernel_);
  }

  template <class F>
  void visit(Index region, const F& f) {
    std::apply([&](auto&... law) { Index r = 0; ((r++ == region ? f(law) : void()), ...); }, laws_);
  }

  template <std::size_t... I>
  void match_regions(const Materials<Ms...>& materials, std::index_sequence<I...>) {
    // The regions of the tuple take the numbers of the cloud's regions; points are sorted by those.
    std::vector<std::string> names = cloud_.regions;
    materials.validate();
    std::vector<std::string> given;
    materials.for_each([&](std::size_t, const auto& region) { given.push_back(region.name); });
    std::vector<Index> number(names.size());
    for (std::size_t r = 0; r < names.size(); ++r) {
      const auto found = std::find(given.begin(), given.end(), names[r]);
      if (found == given.end())
        throw ParameterError(fmt::format("Body \"{}\": region \"{}\" of the cloud has no material; materials are given for: \"{}\".",
                                         name_, names[r], fmt::join(given, "\", \"")));
      number[r] = static_cast<Index>(found - given.begin());
    }
    if (given.size() != names.size())
      throw ParameterError(fmt::format("Body \"{}\": {} materials are given for {} regions; the cloud has the regions \"{}\".",
                                       name_, given.size(), names.size(), fmt::join(names, "\", \"")));
    std::array<std::pair<std::size_t, std::size_t>, sizeof...(Ms)> range{};
    for (std::size_t q = 0; q < table_.points(); ++q) {
      auto& [first, last] = range[number[table_.region[q]]];
      if (last == 0) first = q;
      last = q + 1;
    }
    for (Index& r : table_.region) r = number[r];
    for (PointChunk& chunk : table_.chunks) chunk.region = number[chunk.region];
    (std::get<I>(laws_).prepare(std::get<I>(materials.regions).material, range[I].first, range[I].second, table_.position), ...);
    for_each_region([&](auto& region, Index) {
      std::array<double, 4> limits = region.limits();
      if (in_parts()) share_->reduce({}, limits);
      region.settle(limits, quadrature_, table_.stabilization_scale);
    });
  }

  void assemble_masses() {
    masses_.assign(table_.particles, 0.0);
    volumes_.assign(table_.particles, 0.0);
    const auto share = [&](std::vector<double>& sums, const std::vector<double>& shares, std::size_t q, double amount) {
      if (shares.empty()) sums[table_.owner[q]] += amount;
      else
        for (std::size_t e = table_.offsets[q]; e < table_.offsets[q + 1]; ++e)
          sums[table_.entries[e].particle] += amount * shares[e];
    };
    for_each_region([&](auto& region, Index) {
      for (std::size_t q = region.begin; q < region.end; ++q) {
        share(masses_, table_.value_based() ? table_.mass_shares : table_.point_values, q, point_volume(q) * region.law(q).density);
        share(volumes_, table_.point_values, q, point_volume(q));
      }
    });
    if (share_) share_->complete(masses_);
    if (in_parts()) share_->complete(volumes_);
    const OwnParticles summed(in_parts() ? share_.get() : nullptr, masses_.size());
    std::string failure;
    for (std::size_t k = 0; k < summed.size() && failure.empty(); ++k)
      if (const std::size_t i = summed[k]; !(masses_[i] > 0.0))
        failure = fmt::format("Body \"{}\": particle {} at ({:.6g}, {:.6g}, {:.6g}) m has the lumped mass {:.3g} kg; enlarge the support.", name_, cloud_.number(i),
                              table_.particle_position[i][0], table_.particle_position[i][1], table_.particle_position[i][2], masses_[i]);
    if (in_parts()) failure = Ranks::current->first_failure(failure);
    if (!failure.empty()) throw GeometryError(failure);
  }

  /// k_q² = V_q Σ_I ρ |G_qI|² / M_I: squared wave number of the point alone, in the configuration of the table.
  std::vector<double> wave_numbers() const {
    std::vector<double> scale(table_.points(), 0.0);
    for_each_region([&](const auto& region, Index) {
      parallel_for(region.end - region.begin, [&](std::size_t i) {
        const std::size_t q = region.begin + i;
        for (const TableEntry& entry : table_.row(q)) {
          const double g2 = entry.gradient[0] * entry.gradient[0] + entry.gradient[1] * entry.gradient[1] +
                            entry.gradient[2] * entry.gradient[2];
          scale[q] += point_volume(q) * region.law(q).density * g2 / masses_[entry.particle];
        }
      });
    });
    return scale;
  }

  template <class Region>
  [[nodiscard]] static bool needs_rate(const Region& region) {
    return Loop::template always_with_rates<Region> || region.stabilization.modulus * region.stabilization.damping_time > 0.0;
  }

  /// To be made after pack_motion() and relative_, which it refers to (ForceLoop::sample needs the first alone).
  [[nodiscard]] Loop force_loop() {
    Loop loop{.table = table_, .earlier = earlier_, .displacement = earlier_.empty() ? displacement.data() : relative_.data(),
              .motion = motion_.data(), .director = director.data(), .evaluated = share_ ? share_->evaluated.data() : nullptr,
              .point_scale = point_scale_.data(), .longest_row = longest_row_, .velocity_lag = velocity_lag, .force = force.data(),
              .director_flux = director_flux.data(), .point_rate = point_rate_.data(), .point_volume_ratio = point_volume_ratio_.data()};
    return loop;
  }

  /// Displacement and velocity, packed for the force loop.
  void pack_motion() {
    motion_.resize(size());
    const bool updated = !earlier_.empty();
    for_each_particle([&](std::size_t i) {
      Quad u = quad(displacement[i].data());
      if (updated) {
        u += quad(earlier_.position[i].data());
        u -= quad(table_.particle_position[i].data());
      }
      quad(motion_[i].displacement) = u;
      quad(motion_[i].velocity) = quad(velocity[i].data());
    });
  }

  /// Exchanges what the force loop found with the other processes, in the order in which all of them sum.
  void meet_other_ranks() {
    if (share_->order == SumOrder::of_one_process) {
      if (!in_parts()) gather_chunks();
      return;
    }
    if constexpr (has_director) {
      share_->return_forces(std::array{&force, &director_flux});
      using Rate = Eigen::Matrix<double, 10, 1>;
      std::vector<double> given, taken(10 * share_->taken_points.size());
      for (const Index q : share_->given_points) {
        given.insert(given.end(), point_rate_[q].data(), point_rate_[q].data() + 9);
        given.push_back(point_volume_ratio_[q]);
      }
      share_->exchange_points(given, taken, 10);
      for (std::size_t k = 0; k < share_->taken_points.size(); ++k) {
        const Index q = share_->taken_points[k];
        const Eigen::Map<const Rate> arrived(taken.data() + 10 * k);
        point_rate_[q] = arrived.head<9>().reshaped(3, 3);
        point_volume_ratio_[q] = arrived[9];
      }
    } else {
      share_->return_forces(std::array{&force});
    }
  }

  /// Whether a chunk counts here; otherwise the process counts it that owns it, and both evaluate it while the body is set up.
  [[nodiscard]] bool is_counted(std::size_t chunk) const { return !in_parts() || share_->chunk_owner[chunk] == share_->rank(); }

  /// Sums up what was found in the chunks, of all processes.
  BodyTotals find_totals() {
    std::fill(found_.stretch.begin(), found_.stretch.end(), 0.0);
    found_.largest_volume_ratio = 0.0;
    found_.failure = no_failure;
    found_.failed_rank = -1;
    BodyTotals totals;
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      if (!is_counted(c)) continue;
      totals += chunks_[c].totals;
      double& stretch = found_.stretch[table_.chunks[c].region];
      stretch = std::max(stretch, chunks_[c].stretch);
      found_.largest_volume_ratio = std::max(found_.largest_volume_ratio, chunks_[c].largest_volume_ratio);
      found_.failure = std::min(found_.failure, chunks_[c].failure);
    }
    if (!share_ || (share_->order == SumOrder::of_one_process && !in_parts())) return totals;
    std::array<double, 4> sums{totals.strain_energy, totals.stabilization_energy, totals.dissipated_power, totals.active_power};
    std::vector<double> maxima = found_.stretch;
    maxima.push_back(found_.largest_volume_ratio);
    // The first point has the largest number; or the first rank, where each numbers its own points.
    constexpr double first = 1e15;
    const double failed = static_cast<double>(in_parts() ? static_cast<std::size_t>(share_->rank()) : found_.failure);
    maxima.push_back(found_.failure == no_failure ? 0.0 : first - failed);
    share_->reduce(sums, maxima);
    const auto failure = static_cast<std::size_t>(first - maxima.back());
    if (in_parts()) found_.failed_rank = maxima.back() == 0.0 ? -1 : static_cast<int>(failure);
    else found_.failure = maxima.back() == 0.0 ? no_failure : failure;
    maxima.pop_back();
    found_.largest_volume_ratio = maxima.back();
    maxima.pop_back();
    found_.stretch = std::move(maxima);
    return {sums[0], sums[1], sums[2], sums[3]};
  }

  /// Energies, stretches and failures of all chunks from the processes that own them.
  void gather_chunks() {
    constexpr std::size_t width = 7;
    std::vector<double> values(table_.chunks.size() * width, 0.0);
    for (std::size_t c = 0; c < table_.chunks.size(); ++c) {
      const BodyTotals& t = chunks_[c].totals;
      const double failure = chunks_[c].failure == no_failure ? -1.0 : static_cast<double>(chunks_[c].failure);
      const std::array<double, width> own{t.strain_energy,    t.stabilization_energy,          t.dissipated_power, t.active_power,
                                          chunks_[c].stretch, chunks_[c].largest_volume_ratio, failure};
      std::copy(own.begin(), own.end(), values.data() + c * width);
    }
    share_->gather_chunks(values, width);
    for (std::size_t c = 0; c < table_.chunks.size(); ++c) {
      const double* v = values.data() + c * width;
      chunks_[c] = {{v[0], v[1], v[2], v[3]}, v[4], v[5], v[6] < 0.0 ? no_failure : static_cast<std::size_t>(v[6])};
    }
  }

  /// N numbers at all points from the processes that own them. visit(q, at) calls at(k, x) with the number k of point q, or
  /// at(k, x, l) with lane l of it.
  template <std::size_t N, class Visit>
  void gather_at_points(const Visit& visit) {
    std::vector<double> values(table_.points() * N, 0.0);
    for (std::size_t q = 0; q < table_.points(); ++q)
      if (share_->evaluated[q]) visit(q, [&](auto k, const auto& x, int l = 0) { values[q * N + static_cast<std::size_t>(k)] = lane(x, l); });
    share_->gather_points(values, N);
    for (std::size_t q = 0; q < table_.points(); ++q)
      visit(q, [&](auto k, auto& x, int l = 0) { set_lane(x, l, values[q * N + static_cast<std::size_t>(k)]); });
  }

  std::string name_;
  PointCloud<dimension> cloud_;
  KernelType kernel_;
  QuadratureType quadrature_;
  Director director_law_;
  PointTable table_;
  ParticleValues particle_values_;
  std::tuple<RegionLaw<Ms>...> laws_;
  std::vector<double> masses_, volumes_;
  std::vector<double> point_scale_;  // wave_numbers()
  EarlierConfiguration earlier_;
  bool redistributed_ = false;  // particles have moved against the matter: masses are those of the table
  std::vector<rows::Motion> motion_;  // displacement (since the table) and velocity, packed for the force loop
  Field relative_;                    // displacement since the table, where the reference was updated
  std::size_t longest_row_ = 0;
  std::vector<ChunkResult> chunks_;
  Found found_;
  std::vector<Tensor3> point_rate_;
  std::vector<double> point_volume_ratio_;
  std::vector<std::vector<Index>> points_of_particle_;
  std::shared_ptr<BodyShare> share_;    // null where this process computes the whole body
};

/// Deduced without a director field.
template <class K, class Q, class... Ms>
Body(std::string, PointCloud<K::dimension>, K, Q, Materials<Ms...>) -> Body<K, Q, Materials<Ms...>, NoDirector>;
/// Deduced with a director field: its law and the director at the start are the last arguments.
template <class K, class Q, class... Ms, class Director, class Initial>
Body(std::string, PointCloud<K::dimension>, K, Q, Materials<Ms...>, Director, Initial)
    -> Body<K, Q, Materials<Ms...>, Director>;

}  // namespace tactoid
