#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/parallel.hpp>
#include <tactoid/material/tangent.hpp>
#include <tactoid/quadrature/coloring.hpp>
#include <tactoid/quadrature/rows.hpp>
#include <tactoid/simulation/earlier_configuration.hpp>
#include <tactoid/simulation/row_operations.hpp>

namespace tactoid {

/// The stiffness of a body: unknown i of particle I has the number D I + i.
using StiffnessMatrix = Eigen::SparseMatrix<double>;

namespace detail {

/// Zero matrix with a D × D block for every two particles that share a point, columns sorted by row.
template <int D>
[[nodiscard]] StiffnessMatrix stiffness_pattern(const PointTable& table);

/// The entries of a row, without the one that fills it up.
[[nodiscard]] inline std::span<const TableEntry> pairs_of(const PointTable& table, std::size_t q) {
  const auto row = table.stored_row<TableEntry>(q);
  return is_padding(table, q, table.offsets[q + 1] - 1) ? row.first(row.size() - 1) : row;
}

/// The gradient of a pair with respect to the configuration before the one of the table; the third one of a meridian section, φ/R, stays apart.
[[nodiscard]] inline Vector3 referred(const PointTable& table, const TableEntry& entry, const Tensor3& earlier) {
  const Vector3 G = entry.vector();
  if (!table.axisymmetric) return earlier.transpose() * G;
  Vector3 g = Vector3::Zero();
  g.head<2>() = earlier.topLeftCorner<2, 2>().transpose() * G.head<2>();
  g[2] = earlier(2, 2) * G[2];
  return g;
}

/// Adds the first N × N of a block to the entries of a matrix, whose first place is (row, column).
template <int N>
void add_block(Eigen::Index row, Eigen::Index column, const Tensor3& k, std::vector<Eigen::Triplet<double>>& entries) {
  for (int c = 0; c < N; ++c)
    for (int r = 0; r < N; ++r) entries.emplace_back(static_cast<int>(row) + r, static_cast<int>(column) + c, k(r, c));
}

/// The law's history at one lane of a block.
template <class Law, class T>
[[nodiscard]] tactoid::HistoryOf<Law, double> history_at_lane(const tactoid::HistoryOf<Law, T>& block,
                                                              [[maybe_unused]] int l) {
  tactoid::HistoryOf<Law, double> one;
  if constexpr (history_size<Law> > 0) {
    tactoid::HistoryOf<Law, T> copy = block;
    const T* from = history_scalars<Law, T>(copy);
    double* to = history_scalars<Law, double>(one);
    for (std::size_t i = 0; i < history_size<Law>; ++i) to[i] = lane(from[i], l);
  }
  return one;
}

/// κ Cᵀ w C of the stabilising energy ½ κ Σ_J w_J |Σ_M c_JM u_M|², c_JM = δ_JM − δ_IM − ΔX_J · G_M, the same for
/// every component. (A template, so that programs that need no stiffness do not compile it.)
template <class Matrix = Eigen::MatrixXd>
[[nodiscard]] Matrix stabilization_stiffness(const PointTable& table, std::size_t q, std::size_t size, double kappa) {
  const auto row = table.stored_row<TableEntry>(q).first(size);
  const auto n = static_cast<Eigen::Index>(size);
  const Index owner = table.owner[q];
  Matrix c(n, n);
  const auto weights = table.bonds(q);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (Eigen::Index J = 0; J < n; ++J) {
    const TableEntry& entry = row[static_cast<std::size_t>(J)];
    Vector3 dX = (table.particle_position[entry.particle] - table.particle_position[owner]).head<3>();
    for (int k = 0; k < 3; ++k)
      if (table.period[k] > 0.0) dX[k] -= table.period[k] * std::round(dX[k] / table.period[k]);
    if (J < static_cast<Eigen::Index>(weights.size())) w[J] = kappa * static_cast<double>(weights[static_cast<std::size_t>(J)]);
    for (Eigen::Index M = 0; M < n; ++M) {
      const TableEntry& other = row[static_cast<std::size_t>(M)];
      c(J, M) = (J == M ? 1.0 : 0.0) - (other.particle == owner ? 1.0 : 0.0);
      for (int k = 0; k < 3; ++k) c(J, M) -= dX[k] * other.gradient[k];
    }
  }
  return c.transpose() * w.asDiagonal() * c;
}

/// Calls add(a, b, offset) for the entries a, b of row q, where `offset` is the place of the first component of the
/// block (a, b) within a column of the matrix.
template <int D, class Add>
void for_each_block(const StiffnessMatrix& K, std::span<const TableEntry> row, const Add& add) {
  for (std::size_t b = 0; b < row.size(); ++b) {
    const auto column = static_cast<Eigen::Index>(D * row[b].particle);
    const int* inner = K.innerIndexPtr() + K.outerIndexPtr()[column];
    int place = 0;
    for (std::size_t a = 0; a < row.size(); ++a) {  // two ascending runs: those of the stabilisation, then the others
      const int wanted = static_cast<int>(D * row[a].particle);
      if (inner[place] > wanted) place = 0;
      while (inner[place] != wanted) place += D;
      add(a, b, place);
    }
  }
}

}  // namespace detail

/// In which sense a stiffness is meant.
struct StepTangent {
  double rate_factor = 0.0;  ///< ∂v/∂u of the scheme, 1/s; 0: the velocity is held at zero
  double time_step = 0.0;    ///< during which laws with memory forget, s
};

/// Stiffness K = −∂f/∂u of the internal forces at the present state of a body, D N × D N with D its dimension:
///   K = Σ_q V_q Gᵀ A G + the stiffness of the stabilisation,   A = ∂P/∂F by automatic differentiation.
/// By default velocities are taken as zero, and laws with memory answer as to a sudden change; `step` gives −df/du of an
/// implicit step instead. The director is held. Symmetric for laws with an energy, without rates. For statics, vibration and
/// implicit steps; the explicit steps need none.
template <class Body>
[[nodiscard]] StiffnessMatrix assemble_stiffness(const Body& body, const StepTangent& step = {}) {
  static_assert(std::is_same_v<typename Body::Entry, TableEntry>, "Statics and implicit steps need a body whose gradients are stored as double.");
  constexpr int D = Body::dimension;
  const PointTable& table = body.table();
  const Field displacement = body.displacement_in_table();
  if (table.pairs_elsewhere > 0)
    throw ParameterError("Body \"" + body.name() + "\": assemble_stiffness needs all rows, but other processes hold some of them; an implicit integrator keeps them all, where the body is set up whole.");
  StiffnessMatrix K = detail::stiffness_pattern<D>(table);
  body.for_each_region([&](const auto& region, Index r) {
    using Law = typename std::decay_t<decltype(region)>::Law;
    const double modulus = table.stabilization_scale.empty() ? 0.0 : region.stabilization.modulus;
    for_each_chunk(table, [&](const PointChunk& chunk, std::size_t) {
      if (chunk.region != r) return;
      for (std::size_t q = chunk.begin; q < chunk.end; ++q) {
        const auto row = detail::pairs_of(table, q);
        const double volume = body.point_volume(q);
        PointState<double> state;
        state.time_step = step.time_step;
        state.deformation_gradient += rows::gradient_at(table, q, displacement);
        if (step.rate_factor > 0.0) state.deformation_rate = rows::gradient_at(table, q, body.velocity);
        if constexpr (Body::has_director) {
          state.director_gradient = rows::gradient_at(table, q, body.director);
          state.director = body.director[table.owner[q]].template head<3>();
        }
        std::vector<Vector3> G;  // with respect to the configuration that the law knows
        const Tensor3 earlier = body.earlier_gradient(q);
        refer_to_first(state, earlier);
        for (const TableEntry& entry : row) G.push_back(detail::referred(table, entry, earlier));
        const int l = static_cast<int>((q - region.begin) % static_cast<std::size_t>(region.width));
        const auto history = detail::history_at_lane<Law, typename std::decay_t<decltype(region)>::Scalar>(
            region.histories[region.block(q)], l);
        const Tangent A = tangent(region.law(q), state, history, step.rate_factor);
        std::vector<Eigen::Matrix<double, D, 9>> left(row.size());  // V G_a · A
        for (std::size_t a = 0; a < row.size(); ++a)
          for (int i = 0; i < D; ++i) {
            left[a].row(i).setZero();
            for (int k = 0; k < D; ++k) left[a].row(i) += volume * G[a][k] * A.row(3 * i + k);
            if (table.axisymmetric && i == 0) left[a].row(i) += volume * G[a][2] * A.row(8);
          }
        Eigen::MatrixXd hold;
        if (modulus > 0.0)
          hold = detail::stabilization_stiffness(table, q, row.size(), modulus * table.stabilization_scale[q] *
                                                                           (1.0 + region.stabilization.damping_time * step.rate_factor));
        detail::for_each_block<D>(K, row, [&](std::size_t a, std::size_t b, int place) {
          for (int j = 0; j < D; ++j) {
            double* column =
                K.valuePtr() + K.outerIndexPtr()[static_cast<Eigen::Index>(D * row[b].particle) + j] + place;
            for (int i = 0; i < D; ++i) {
              double k = 0.0;
              for (int m = 0; m < D; ++m) k += left[a](i, 3 * j + m) * G[b][m];
              if (table.axisymmetric && j == 0) k += left[a](i, 8) * G[b][2];
              column[i] += k;
            }
            if (modulus > 0.0) column[j] += hold(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
          }
        });
      }
    });
  });
  return K;
}

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/simulation/stiffness.ipp>
#endif
