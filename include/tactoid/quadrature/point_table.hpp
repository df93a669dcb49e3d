#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Three doubles that lie where any Index may lie: what an array of double would align to eight bytes.
class PackedVector {
 public:
  /// A component of a vector that may be changed.
  class Component {
   public:
    explicit Component(void* place) : place_(place) {}  ///< refers to a double there
    Component(const Component&) = default;              ///< refers to the same
    operator double() const { return read(place_); }    ///< its value
    ///@{
    /// Sets it.
    const Component& operator=(double x) const { return std::memcpy(place_, &x, sizeof x), *this; }
    const Component& operator=(const Component& other) const { return *this = double(other); }
    ///@}
    const Component& operator+=(double x) const { return *this = *this + x; }  ///< adds to it

   private:
    void* place_;
  };
  PackedVector() = default;  ///< 0
  /// Of three components.
  PackedVector(double x, double y, double z) { (*this)[0] = x, (*this)[1] = y, (*this)[2] = z; }
  ///@{
  /// Component k.
  [[nodiscard]] double operator[](std::integral auto k) const { return read(words_ + 2 * static_cast<std::size_t>(k)); }
  [[nodiscard]] Component operator[](std::integral auto k) { return Component(words_ + 2 * static_cast<std::size_t>(k)); }
  ///@}

 private:
  static double read(const void* place) {
    double x;
    std::memcpy(&x, place, sizeof x);
    return x;
  }
  Index words_[6] = {};
};

/// One pair of a quadrature point q and a particle I: 28 bytes, read in one piece by the hot loop.
struct TableEntry {
  PackedVector gradient;  ///< ∇₀φ_I(X_q), or the value-based operator G_qI; 1/m. In a meridian section the third component is
                          ///< φ_I(X_q)/R_q, which gives the parts around the axis
  Index particle = 0;     ///< I
  /// ∇₀φ_I(X_q) as a vector.
  [[nodiscard]] Vector3 vector() const { return {gradient[0], gradient[1], gradient[2]}; }
};
static_assert(sizeof(TableEntry) == 28);

/// The same in 16 bytes, for bodies that store gradients in single precision (quadrature/stored.hpp).
struct alignas(16) SingleTableEntry {
  float gradient[3] = {0.0F, 0.0F, 0.0F};  ///< 1/m, as in TableEntry
  Index particle = 0;                      ///< I
  /// In double precision.
  operator TableEntry() const { return {{double(gradient[0]), double(gradient[1]), double(gradient[2])}, particle}; }
};

/// The entries of one point, in whichever precision they are stored; outside of the hot path.
class TableRow {
 public:
  /// `size` entries from one of the two on; the other is null.
  TableRow(const TableEntry* entries, const SingleTableEntry* single_entries, std::size_t size)
      : entries_(entries), single_entries_(single_entries), size_(size) {}
  [[nodiscard]] std::size_t size() const { return size_; }   ///< with the padding
  [[nodiscard]] bool empty() const { return size_ == 0; }    ///< also where other processes evaluate it
  /// Entry number k, in double precision.
  [[nodiscard]] TableEntry operator[](std::size_t k) const { return single_entries_ != nullptr ? TableEntry(single_entries_[k]) : entries_[k]; }

  /// Goes through the entries, by value.
  class Iterator {
   public:
    using difference_type = std::ptrdiff_t;                ///< of numbers
    using value_type = TableEntry;                         ///< in double precision
    using iterator_category = std::input_iterator_tag;     ///< entries are made when they are asked for
    using pointer = const TableEntry*;                     ///< there is none
    using reference = TableEntry;                          ///< a value
    Iterator() = default;
    Iterator(const TableRow& row, std::size_t k) : row_(&row), k_(k) {}  ///< at entry k
    TableEntry operator*() const { return (*row_)[k_]; }  ///< the entry
    Iterator& operator++() { return ++k_, *this; }        ///< to the next one
    Iterator operator++(int) { return {*row_, k_++}; }    ///< to the next one
    bool operator==(const Iterator& other) const { return k_ == other.k_; }  ///< the same place

   private:
    const TableRow* row_ = nullptr;
    std::size_t k_ = 0;
  };
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }    ///< the first entry
  [[nodiscard]] Iterator end() const { return {*this, size_}; }  ///< beyond the last one

 private:
  const TableEntry* entries_;
  const SingleTableEntry* single_entries_;
  std::size_t size_;
};

/// Compressed rows of (particle, value) pairs: a linear map from the unknowns to values.
struct ValueRows {
  std::vector<std::size_t> offsets;                             ///< row i: [offsets[i], offsets[i + 1]) of the lists below; empty: the identity
  std::vector<Index> particles;                                 ///< numbers of the unknowns
  std::vector<double> values;                                   ///< beside `particles`
  [[nodiscard]] bool empty() const { return offsets.empty(); }  ///< no map: unknowns are values
};

/// A contiguous range of points of one region whose contributions are added by one thread.
struct PointChunk {
  std::size_t begin = 0;  ///< first point
  std::size_t end = 0;    ///< one past the last point
  Index region = 0;       ///< of all its points
};

/// Where the weak form is sampled and how: quadrature points, their reference volumes and the flat table of
/// gradients, built once in the reference configuration. Vectors have three components in every dimension.
///
/// Two kinds of tables exist. In a *value-based* table the unknown of a particle is the value there: each
/// point has an owner, φ_I(X_q) = δ_{I,owner(q)} for point-wise terms, and `particle_values` is empty. In a
/// *coefficient* table the unknowns are coefficients: `point_values` holds φ_I(X_q) in the order of the
/// entries, and `particle_values` maps coefficients to the field at the particles.
struct PointTable {
  std::size_t particles = 0;  ///< number of unknown vectors
  int dimension = 3;          ///< of the body
  bool axisymmetric = false;  ///< a meridian section (PointCloud): points stand for rings

  std::vector<Vector3> position;     ///< X_q, m
  std::vector<double> volume;        ///< V_q, m³ (m² and m per unit thickness and section in plane and one-dimensional bodies)
  std::vector<Index> region;         ///< of the material at q
  std::vector<Index> owner;          ///< particle that q belongs to (value-based), or the nearest one
  std::vector<std::size_t> offsets;  ///< row of q: entries[offsets[q]] .. entries[offsets[q + 1] - 1]
  std::vector<TableEntry> entries;   ///< rows are padded to an even length with entries of zero gradient

  std::vector<SingleTableEntry> single_entries;  ///< instead of `entries`: use_single_precision()

  std::vector<double> point_values;  ///< φ_I(X_q) beside `entries`; empty in a value-based table
  ValueRows particle_values;         ///< φ_J(X_I); empty in a value-based table
  std::vector<double> mass_shares;   ///< of a value-based table, beside `entries`: I's share of the mass at q; Σ_I = 1. A body
                                     ///< releases it when its masses are lumped. Empty: the owner takes all.

  Field particle_position;                  ///< X_I, m
  std::vector<double> stabilization_scale;  ///< V_q · D / Σ_J w_J |X_J − X_I|², 1/m² · m³; empty: none
  std::vector<std::size_t> bond_offsets;    ///< weights of q: bond_weights[bond_offsets[q]] .. [bond_offsets[q + 1] - 1]; empty: none
  std::vector<float> bond_weights;          ///< w_J of the stabilisation, of the first entries of each row; an even number per row
  Vector3 period = Vector3::Zero();         ///< of periodic directions, m; 0 where not periodic

  std::vector<PointChunk> chunks;               ///< sorted by colour
  std::vector<std::size_t> color_offsets;       ///< chunks of colour c: [color_offsets[c], color_offsets[c + 1])
  std::size_t pairs_elsewhere = 0;              ///< entries of rows that are empty here, because other processes evaluate them

  [[nodiscard]] std::size_t points() const { return volume.size(); }       ///< number of quadrature points
  /// Number of entries, padding included; of the whole body, where it is shared by several processes.
  [[nodiscard]] std::size_t pairs() const { return size() + pairs_elsewhere; }
  /// Number of entries that are here, padding included.
  [[nodiscard]] std::size_t size() const { return entries.size() + single_entries.size(); }
  /// Entry e of the list, in double precision.
  [[nodiscard]] TableEntry entry(std::size_t e) const { return single_entries.empty() ? entries[e] : TableEntry(single_entries[e]); }
  [[nodiscard]] bool value_based() const { return point_values.empty(); }  ///< unknowns are values at the particles
  /// The entries of point q, in double precision.
  [[nodiscard]] TableRow row(std::size_t q) const {
    const bool single = !single_entries.empty();
    return {single ? nullptr : entries.data() + offsets[q], single ? single_entries.data() + offsets[q] : nullptr, offsets[q + 1] - offsets[q]};
  }
  /// The entries of point q as they are stored: Entry is TableEntry, or SingleTableEntry after use_single_precision().
  template <class Entry>
  [[nodiscard]] std::span<const Entry> stored_row(std::size_t q) const {
    if constexpr (std::is_same_v<Entry, SingleTableEntry>) return {single_entries.data() + offsets[q], offsets[q + 1] - offsets[q]};
    else return {entries.data() + offsets[q], offsets[q + 1] - offsets[q]};
  }

  /// Rounds the gradients to single precision and releases those in double precision. What each row loses in its sum is given to
  /// the owner in a further entry, so that sums over a row (which keep momentum) hold to 1e-14, while single gradients, and
  /// with them deformation gradients, are off by up to 6e-8 of their size. mass_shares must be released before.
  void use_single_precision();

  /// Weights of the stabilisation in row q: those of its first entries; the others have none.
  [[nodiscard]] std::span<const float> bonds(std::size_t q) const {
    if (bond_offsets.empty()) return {};
    return {bond_weights.data() + bond_offsets[q], bond_offsets[q + 1] - bond_offsets[q]};
  }
  /// Bytes that the table holds.
  [[nodiscard]] std::size_t memory() const;
};

}  // namespace tactoid

#if !defined(TACTOID_COMPILED)
#include <tactoid/quadrature/point_table.ipp>
#endif
