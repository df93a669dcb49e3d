#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <tactoid/contact/on_rigid.hpp>
#include <tactoid/geometry/facets.hpp>
#include <tactoid/geometry/o_grid.hpp>
#include <tactoid/geometry/order.hpp>
#include <tactoid/geometry/part.hpp>
#include <tactoid/simulation/body_fields.hpp>
#include <tactoid/simulation/stiffness.hpp>

namespace tactoid::verification {

/// The octant x, y, z >= 0 of a ball about the origin, its particles dense about the pole (0, 0, R): an O-grid of a
/// half-space with a core of half-width `core` (measured on the ball, m) and `cells`³ cells in it, and shells that grow
/// by `growth` each, taken to the ball by an inversion. That keeps angles, so that cells stay about as wide as high.
[[nodiscard]] inline PointCloud<3> graded_octant(double radius, double core, int cells, double growth) {
  const double inner = 0.5 * core / radius;  // the inversion doubles lengths at the pole
  const int shells = static_cast<int>(std::ceil(std::log(1.0 / inner) / std::log(growth)));
  const auto in_core = [&](const detail::CubePoint<3>& point) -> Point<3> {
    const double rounded = std::pow(point.s, 1.5);
    return inner * point.s * ((1.0 - rounded) * 0.85 * point.d + rounded * detail::equiangular_direction<3>(point.d));
  };
  const auto in_shell = [&](int k, const Point<3>& d) -> Point<3> {
    return std::pow(inner, 1.0 - static_cast<double>(k) / shells) * detail::equiangular_direction<3>(d);
  };
  PointCloud<3> octant = part_where(detail::o_grid<3>(2 * cells, shells, in_core, in_shell), [inner](const Point<3>& p) {
    return p[0] > -1e-9 * inner && p[1] > -1e-9 * inner && p[2] < 1e-9 * inner;
  });
  const Point<3> center(0.0, 0.0, -1.0);
  for (Point<3>& X : octant.positions) {
    Point<3> p(X[0], X[1], -X[2]);
    for (int k = 0; k < 3; ++k)
      if (std::abs(p[k]) < 1e-9 * inner) p[k] = 0.0;
    Point<3> x = center + 2.0 * (p - center) / (p - center).squaredNorm();
    if (std::abs(p.norm() - 1.0) < 1e-9) x[2] = 0.0;
    X = radius * x;
  }
  octant.cell_regions.assign(octant.cells.size(), 0);
  octant.regions = {"body"};
  return morton_ordered(octant);
}

/// The cloud with those of its facets only that lie on the sphere of the given radius: where an octant can touch.
[[nodiscard]] inline PointCloud<3> on_sphere(PointCloud<3> cloud, double radius) {
  return with_facets_where(std::move(cloud), [radius](const Point<3>& X) { return std::abs(X.norm() - radius) < 1e-9 * radius; });
}

/// Static contact of the octant of a ball with a rigid plate above its pole, by Newton's method. Symmetry holds the
/// three cut planes: it is an eighth of a whole ball between two plates. Forces are those of the library, at finite
/// strain; the matrix is the library's stiffness, factorised once by factorize(), and the plate's, which acts on few
/// particles, comes in by Woodbury's formula.
template <class Body, GapLaw Law>
class PressedBody {
 public:
  /// Particles within `reach` of the pole (m) can touch.
  PressedBody(Body& body, double radius, double reach, Law law) : body_(body), part_(on_sphere(body.cloud(), radius)) {
    fields_.prepare(body);
    contact_ = {.law = law, .surface = {.normal = -Vector3::UnitZ()}, .points_per_direction = 3};
    surface_ = FacetSurface<3>(part_);
    quadrature_ = FacetQuadrature<3>(surface_, body.reference(), 3);
    contact_.initialize(part_, fields_.view(body));
    for (std::size_t i = 0; i < body.size(); ++i)
      for (int k = 0; k < 3; ++k) unknown_.push_back(body.reference()[i][k] == 0.0 ? -1 : unknowns_++);
    column_.assign(body.size(), -1);
    for (const Index i : surface_.nodes)
      if ((part_.positions[i] - Point<3>(0.0, 0.0, radius)).norm() < reach && unknown_[3 * i + 2] >= 0) {
        column_[i] = static_cast<int>(touching_.size());
        touching_.push_back(i);
      }
  }

  void set_law(Law law) { contact_.law = law; }

  /// Takes the stiffness of the body at its present state.
  void factorize() {
    const StiffnessMatrix K = assemble_stiffness(body_);
    std::vector<Eigen::Triplet<double>> entries;
    for (int c = 0; c < K.outerSize(); ++c)
      for (StiffnessMatrix::InnerIterator e(K, c); e; ++e) {
        const int row = unknown_[static_cast<std::size_t>(e.row())], column = unknown_[static_cast<std::size_t>(c)];
        if (row >= column && column >= 0) entries.emplace_back(row, column, e.value());
      }
    StiffnessMatrix free(unknowns_, unknowns_);
    free.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(free);
    if (factor_.info() != Eigen::Success) throw ComputationError("PressedBody: the stiffness has no factors.");
    const auto m = static_cast<Eigen::Index>(touching_.size());
    response_.resize(unknowns_, m);
    compliance_.resize(m, m);
    for (Eigen::Index j = 0; j < m; ++j) response_.col(j) = factor_.solve(Eigen::VectorXd::Unit(unknowns_, z_of(j)));
    for (Eigen::Index i = 0; i < m; ++i) compliance_.row(i) = response_.row(z_of(i));
  }

  /// Equilibrium with the plate at height z (m), from the present state. False if Newton's method does not get there;
  /// `largest_change` (m) limits a step at the surface.
  bool solve(double z, double largest_change, int iterations = 260) {
    contact_.surface.point = Vector3(0.0, 0.0, z);
    for (int iteration = 0; iteration < iterations; ++iteration) {
      double scale = 0.0;
      const Eigen::VectorXd residual = forces(scale);
      if (!residual.allFinite()) return false;
      if (residual.norm() < 1e-8 * scale) return true;
      const Eigen::VectorXd w = factor_.solve(residual);
      // Newton's steps at first; where they do not settle, a stretch of steps without the law's softening: those go
      // downhill in energy, through a jump of the rim of the contact too.
      const Eigen::MatrixXd k = contact_stiffness(iteration % 80 >= 20);
      const auto m = static_cast<Eigen::Index>(touching_.size());
      Eigen::VectorXd at_surface(m);
      for (Eigen::Index i = 0; i < m; ++i) at_surface[i] = w[z_of(i)];
      const Eigen::VectorXd change =
          (Eigen::MatrixXd::Identity(m, m) + compliance_ * k).partialPivLu().solve(at_surface);
      const double part = std::min(1.0, largest_change / change.cwiseAbs().maxCoeff());
      const Eigen::VectorXd du = part * (w - response_ * (k * change));
      for (std::size_t i = 0; i < body_.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
          if (unknown_[3 * i + c] >= 0) body_.displacement[i][static_cast<Eigen::Index>(c)] += du[unknown_[3 * i + c]];
    }
    return false;
  }

  void reset() { std::fill(body_.displacement.begin(), body_.displacement.end(), Vector4::Zero()); }

  /// Force on the plate, of the whole ball, N: positive where the ball pushes.
  [[nodiscard]] double force() const { return 4.0 * contact_.force().z(); }
  /// Energy between the ball and the plate, J.
  [[nodiscard]] double contact_energy() const { return 4.0 * energy_; }
  [[nodiscard]] Eigen::Index unknowns() const { return unknowns_; }

 private:
  [[nodiscard]] Eigen::Index z_of(Eigen::Index j) const {
    return unknown_[3 * touching_[static_cast<std::size_t>(j)] + 2];
  }

  Eigen::VectorXd forces(double& scale) {
    fields_.refresh(body_, 0.0);
    energy_ = contact_.apply(fields_.view(body_), 0.0).potential;
    body_.force = fields_.force;
    body_.add_internal_forces(0.0, false);
    Eigen::VectorXd sum(unknowns_);
    scale = 0.0;
    for (std::size_t i = 0; i < body_.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        if (unknown_[3 * i + c] >= 0) {
          sum[unknown_[3 * i + c]] = body_.force[i][static_cast<Eigen::Index>(c)];
          scale = std::hypot(scale, fields_.force[i][static_cast<Eigen::Index>(c)]);
        }
    return sum;
  }

  /// ∂(push down)/∂(height) between the particles that can touch, N/m; positive semi-definite `without_softening`.
  [[nodiscard]] Eigen::MatrixXd contact_stiffness(bool without_softening) const {
    const auto m = static_cast<Eigen::Index>(touching_.size());
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(m, m);
    for (std::size_t q = 0; q < quadrature_.size(); ++q) {
      const auto& nodes = surface_.facets[quadrature_.facet_of(q)];
      const auto& shape = quadrature_.point(q).shape;
      double height = 0.0;
      for (std::size_t a = 0; a < nodes.size(); ++a) height += shape[a] * fields_.position[nodes[a]][2];
      const double gap = contact_.surface.point[2] - height, d = 1e-7 * part_.positions[nodes[0]].norm();
      double slope = (contact_.law.traction(gap + d) - contact_.law.traction(gap - d)) / (2.0 * d);
      if (without_softening) slope = std::min(slope, 0.0);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < nodes.size(); ++b)
          if (column_[nodes[a]] >= 0 && column_[nodes[b]] >= 0)
            k(column_[nodes[a]], column_[nodes[b]]) -= quadrature_.area[q] * slope * shape[a] * shape[b];
    }
    return k;
  }

  Body& body_;
  PointCloud<3> part_;
  BodyFields fields_;
  OnRigid<Law, RigidPlane> contact_{};
  FacetSurface<3> surface_;
  FacetQuadrature<3> quadrature_;
  std::vector<int> unknown_, column_;  // per component, per particle: −1 where held, where out of reach
  std::vector<Index> touching_;
  int unknowns_ = 0;
  double energy_ = 0.0;
  Eigen::SimplicialLDLT<StiffnessMatrix> factor_;
  Eigen::MatrixXd response_, compliance_;
};

}  // namespace tactoid::verification
