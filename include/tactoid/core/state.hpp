#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/tensor.hpp>

namespace tactoid {

/// Numbers with a name elsewhere: shape {} is a single one, {n} a list, {n, k} a list of vectors.
struct StateArray {
  std::vector<std::size_t> shape;  ///< extents, the slowest first; empty for a single number
  std::vector<double> values;  ///< whole numbers too, which are exact up to 2⁵³
  bool whole = false;          ///< the numbers are whole ones
  std::vector<std::size_t> rows = {};  ///< of a list of which several processes have entries each: the numbers in the whole of those that are here; empty: all are
  std::size_t length = 0;      ///< entries of the whole list, where some are here
  friend bool operator==(const StateArray&, const StateArray&) = default;  ///< exact: NaN differs from itself
};

/// Which entries of a list that each of several processes has a part of belong to this one: those that it saves, and gets back.
struct StateRows {
  std::size_t size = 0;             ///< of the list here
  std::size_t length = 0;           ///< of the whole list
  std::vector<std::size_t> here;    ///< places in the list here
  std::vector<std::size_t> number;  ///< beside `here`: places in the whole list

  /// One more entry.
  void add(std::size_t place, std::size_t in_whole) {
    here.push_back(place);
    number.push_back(in_whole);
  }
};

/// The whole state of something, by name: "cell/displacement". Of what several processes have parts of, each has its own entries.
using SavedState = std::map<std::string, StateArray, std::less<>>;

namespace detail {

/// How an element of a list is k numbers.
template <class T>
struct StateElement {
  static_assert(std::is_arithmetic_v<T>, "A state consists of numbers, of Eigen vectors and matrices of fixed size, and of lists of them.");
  static constexpr std::size_t size = 1;
  static constexpr bool whole = std::is_integral_v<T>;
  static double get(const T& x, std::size_t) { return static_cast<double>(x); }
  static void set(T& x, std::size_t, double value) { x = static_cast<T>(value); }
};
template <class Scalar, int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
struct StateElement<Eigen::Matrix<Scalar, Rows, Columns, Options, MaxRows, MaxColumns>> {
  using T = Eigen::Matrix<Scalar, Rows, Columns, Options, MaxRows, MaxColumns>;
  static_assert(Rows > 0 && Columns > 0 && std::is_same_v<Scalar, double>);
  static constexpr std::size_t size = static_cast<std::size_t>(Rows * Columns);
  static constexpr bool whole = false;
  static double get(const T& x, std::size_t k) { return x.data()[k]; }
  static void set(T& x, std::size_t k, double value) { x.data()[k] = value; }
};

}  // namespace detail

/// What has a state that it does not compute anew in each step (histories, closest points that are followed) has a
///
///   template <class Archive>
///   void state(Archive& archive) {
///     archive("bonds", bonds_);            // a number, a vector or matrix of fixed size, or a std::vector of them
///     archive.part("tracker", tracker_);   // something that has a state itself
///   }
///
/// which saves it (StateWriter) or restores it (StateReader); Archive::restoring says which. What is given when the object is
/// composed (parameters, clouds, tables) is no state.
template <class T, class Archive, class... More>
concept HasState = requires(T& t, Archive& archive, const More&... more) { t.state(archive, more...); };

/// Collects a state.
class StateWriter {
 public:
  static constexpr bool restoring = false;                    ///< this archive saves
  explicit StateWriter(SavedState& saved) : saved_(saved) {}  ///< `saved` must outlive the writer

  /// Keeps a number, or a vector or matrix of fixed size. Throws ParameterError for a name that is taken.
  template <class T>
  void operator()(std::string_view name, const T& x) {
    using Element = detail::StateElement<T>;
    StateArray& array = insert(name);
    if (Element::size > 1) array.shape = {Element::size};
    array.whole = Element::whole;
    for (std::size_t k = 0; k < Element::size; ++k) array.values.push_back(Element::get(x, k));
  }
  /// Keeps a list. Throws ParameterError for a name that is taken.
  template <class T>
  void operator()(std::string_view name, const std::vector<T>& list) {
    using Element = detail::StateElement<T>;
    StateArray& array = insert(name);
    array.shape = {list.size()};
    if (Element::size > 1) array.shape.push_back(Element::size);
    array.whole = Element::whole;
    array.values.reserve(list.size() * Element::size);
    for (const T& x : list)
      for (std::size_t k = 0; k < Element::size; ++k) array.values.push_back(Element::get(x, k));
  }
  /// Keeps the entries of a list that belong to this process; all of them where `rows` is null.
  template <class T>
  void operator()(std::string_view name, const std::vector<T>& list, const StateRows* rows) {
    if (rows == nullptr || (list.empty() && rows->size > 0)) return (*this)(name, list);
    using Element = detail::StateElement<T>;
    StateArray& array = insert(name);
    array.shape = {rows->here.size()};
    if (Element::size > 1) array.shape.push_back(Element::size);
    array.whole = Element::whole;
    array.rows = rows->number;
    array.length = rows->length;
    for (const std::size_t i : rows->here)
      for (std::size_t k = 0; k < Element::size; ++k) array.values.push_back(Element::get(list[i], k));
  }
  /// A value that tells one composition from another.
  template <class T>
  void expect(std::string_view name, const T& x) { (*this)(name, x); }
  /// A list that does; as above.
  template <class T>
  void expect(std::string_view name, const std::vector<T>& list, const StateRows* rows) { (*this)(name, list, rows); }
  /// Saves what x has as its state, under names that begin with "name/"; nothing where it has none. `more` is for x.state(archive, more…).
  template <class T, class... More>
  void part(std::string_view name, T& x, const More&... more) {
    if constexpr (HasState<T, StateWriter, More...>) {
      const std::string outer = prefix_;
      prefix_ += std::string(name) + "/";
      x.state(*this, more...);
      prefix_ = outer;
    }
  }

 private:
  StateArray& insert(std::string_view name) {
    const auto [at, is_new] = saved_.try_emplace(prefix_ + std::string(name));
    if (!is_new) throw ParameterError("A state has two values of the name \"" + at->first + "\".");
    return at->second;
  }
  SavedState& saved_;
  std::string prefix_;
};

/// Gives a state back. Throws ParameterError, naming the value, where the saved state is that of something else.
class StateReader {
 public:
  static constexpr bool restoring = true;                           ///< this archive restores
  explicit StateReader(const SavedState& saved) : saved_(saved) {}  ///< `saved` must outlive the reader

  /// Gives back a number, or a vector or matrix of fixed size.
  template <class T>
  void operator()(std::string_view name, T& x) {
    using Element = detail::StateElement<T>;
    const StateArray& array = find(name, Element::whole);
    if (array.values.size() != Element::size || array.shape.size() != (Element::size > 1 ? 1 : 0)) fail(name, "is not of the expected size");
    for (std::size_t k = 0; k < Element::size; ++k) Element::set(x, k, array.values[k]);
  }
  /// A list that is not empty keeps its length: one per particle, say, of a body that is composed already.
  template <class T>
  void operator()(std::string_view name, std::vector<T>& list) {
    using Element = detail::StateElement<T>;
    const StateArray& array = find(name, Element::whole);
    const bool fits = array.shape.size() == (Element::size > 1 ? 2 : 1) && array.values.size() == array.shape[0] * Element::size;
    if (!fits || (!list.empty() && list.size() != array.shape[0])) fail(name, "is not of the expected size");
    list.resize(array.shape[0]);
    for (std::size_t i = 0; i < list.size(); ++i)
      for (std::size_t k = 0; k < Element::size; ++k) Element::set(list[i], k, array.values[i * Element::size + k]);
  }
  /// The entries of a list that belong to this process, from these or from the whole list; the others stay. As above where `rows` is null.
  template <class T>
  void operator()(std::string_view name, std::vector<T>& list, const StateRows* rows) {
    if (rows == nullptr) return (*this)(name, list);
    using Element = detail::StateElement<T>;
    const StateArray& array = find(name, Element::whole);
    if (array.shape.size() != (Element::size > 1 ? 2 : 1) || array.values.size() != array.shape[0] * Element::size) fail(name, "is not of the expected size");
    const bool is_whole = array.rows.empty() && array.length == 0;
    if (is_whole && array.shape[0] == 0) return list.clear();
    if (is_whole ? array.shape[0] != rows->length : array.length != rows->length) fail(name, "is not of the expected size");
    if (!is_whole && array.rows != rows->number) fail(name, "has the entries of another process");
    list.resize(rows->size);
    for (std::size_t j = 0; j < rows->here.size(); ++j)
      for (std::size_t k = 0; k < Element::size; ++k) Element::set(list[rows->here[j]], k, array.values[(is_whole ? rows->number[j] : j) * Element::size + k]);
  }
  /// Restores what x has as its state from the names that begin with "name/"; nothing where it has none. `more` is for x.state(archive, more…).
  template <class T, class... More>
  void part(std::string_view name, T& x, const More&... more) {
    if constexpr (HasState<T, StateReader, More...>) {
      const std::string outer = prefix_;
      prefix_ += std::string(name) + "/";
      x.state(*this, more...);
      prefix_ = outer;
    }
  }
  /// The state is of something else, unless the value is this one.
  template <class T>
  void expect(std::string_view name, const T& x) {
    T saved = x;
    (*this)(name, saved);
    if (saved != x) fail(name, "differs");
  }
  /// The same of the entries of a list that belong to this process.
  template <class T>
  void expect(std::string_view name, const std::vector<T>& list, const StateRows* rows) {
    std::vector<T> saved = list;
    (*this)(name, saved, rows);
    if (saved != list) fail(name, "differs");
  }
  /// Whether there is a value of this name.
  [[nodiscard]] bool has(std::string_view name) const { return saved_.find(prefix_ + std::string(name)) != saved_.end(); }

 private:
  [[noreturn]] void fail(std::string_view name, std::string_view what) const {
    throw ParameterError("The saved state is of another simulation: \"" + prefix_ + std::string(name) + "\" " + std::string(what) + ".");
  }
  const StateArray& find(std::string_view name, bool whole) const {
    const auto at = saved_.find(prefix_ + std::string(name));
    if (at == saved_.end()) fail(name, "is not in it");
    if (at->second.whole != whole) fail(name, "is of another type");
    return at->second;
  }
  const SavedState& saved_;
  std::string prefix_;
};

/// The state of a list at some places of it, as a list of its own: what a term keeps of each particle of a surface, of which each of several processes has other particles behind them.
template <class Archive, class T>
void state_at(Archive& archive, std::string_view name, std::vector<T>& list, const std::vector<Index>& places) {
  std::vector<T> there;
  for (const Index i : places) there.push_back(list[i]);
  archive(name, there);
  if constexpr (Archive::restoring)
    for (std::size_t k = 0; k < there.size(); ++k) list[places[k]] = there[k];
}

/// Everything that `x` needs to go on.
template <class T>
[[nodiscard]] SavedState save_state(T& x) {
  SavedState saved;
  StateWriter writer(saved);
  x.state(writer);
  return saved;
}
/// Puts `x`, composed as the one that was saved, into that state; then it goes on with the same bits. A failure leaves it in a
/// state between both: throw it away.
template <class T>
void restore_state(T& x, const SavedState& saved) {
  StateReader reader(saved);
  x.state(reader);
}

}  // namespace tactoid
