#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/core/tensor.hpp>
#include <tactoid/quadrature/point_table.hpp>
#include <tactoid/quadrature/row_share.hpp>

namespace tactoid {

/// The part of one body that this rank computes.
///
/// In the order of one process a rank evaluates its own chunks, and beyond them every row that touches one of its particles: so forces at its
/// particles are complete, and no force is exchanged. In the order of the ranks it evaluates its own chunks alone; what they do to
/// particles of other ranks is taken there by return_forces().
class BodyShare : public RowShare {
 public:
  SumOrder order = SumOrder::of_one_process;  ///< of what is added up
  std::vector<Index> local;  ///< particles that this rank owns, that its rows touch, or that are known to all; ascending; all of them while the body is set up

  ///@{
  /// In the order of the ranks: particles of other ranks that rows of this one touch; points that are evaluated here, and the particles
  /// to which they belong are those of other ranks; and those where it is the other way round.
  std::vector<Index> abroad, given_points, taken_points;
  ///@}

  /// Empties the rows that are not evaluated; does nothing where all rows must stay.
  virtual void drop_rows(PointTable& table) const = 0;
  /// Values of chunks, `per_chunk` numbers each: those of own chunks in, those of all chunks out. Collective.
  virtual void gather_chunks(std::span<double> values, std::size_t per_chunk) = 0;
  /// Adds to what own rows do to own particles what those of other ranks do; `fields`: forces, and the director's flux where there is one. Collective.
  virtual void return_forces(std::span<Field* const> fields) = 0;
  /// Values of given_points, `per_point` numbers each, to where they are taken_points. Collective.
  virtual void exchange_points(std::span<const double> given, std::span<double> taken, std::size_t per_point) = 0;
  /// Values of points, `per_point` numbers each: those of the points of own chunks in, those of all out. Collective.
  virtual void gather_points(std::span<double> values, std::size_t per_point) = 0;
};

/// A body as it is handed over to be divided. What it refers to must outlive the decomposition.
struct SharedBody {
  const PointTable* table = nullptr;       ///< with all its rows, or with those that this rank has made
  const RowShare* made = nullptr;          ///< where each rank has made its own rows: how the table was divided; needed only while bodies are being divided
  std::shared_ptr<const CloudPart> part;   ///< of the cloud that each rank has; null: all have the whole
  std::vector<double> region_cost;         ///< of a point of each region of the table beside its pairs, in pairs
  std::vector<char> known_to_all;          ///< per particle: 1 where every rank must know its motion in every step
  bool keep_rows = false;                  ///< no rank drops rows
  std::vector<Field*> motion;              ///< what the evaluation of a row reads of its particles: u, v, h
  std::vector<Field*> known;               ///< what every rank must know of particles that are known to all, `motion` included
  std::vector<Field*> whole;               ///< what complete() makes known
};

/// Bodies that are divided among ranks, and what the ranks tell each other in every step. All functions are collective.
class Decomposition {
 public:
  Decomposition() = default;
  Decomposition(const Decomposition&) = delete;
  Decomposition& operator=(const Decomposition&) = delete;
  virtual ~Decomposition() = default;

  /// The part of a body that is this rank's.
  [[nodiscard]] virtual std::shared_ptr<BodyShare> share(std::size_t body) const = 0;
  /// Per particle of a body: the rank that owns it.
  [[nodiscard]] virtual const std::vector<int>& owners(std::size_t body) const = 0;

  /// Starts the exchange of the motion. When it returns, particles that are known to all are.
  virtual void begin_exchange() = 0;
  /// Afterwards the particles of all rows of this rank are known, too.
  virtual void end_exchange() = 0;
  /// Makes the fields of all particles known to all ranks.
  virtual void complete() = 0;
  /// Σ_i term_i over the particles of a body, each rank giving those that it owns: in the order in which the body was divided.
  [[nodiscard]] virtual double sum(std::size_t body, std::span<const double> terms) = 0;
  /// The text that the rank gives to which a point of a body belongs, behind the number of that rank.
  [[nodiscard]] virtual std::string told_by_owner(std::size_t body, std::size_t point, const std::string& text) = 0;
};

}  // namespace tactoid
