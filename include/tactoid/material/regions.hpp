#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <tactoid/core/errors.hpp>
#include <tactoid/material/graded.hpp>
#include <tactoid/material/material.hpp>

namespace tactoid {

/// The material of a named region of a point cloud.
template <class M>
struct Region {
  static_assert(Material<typename detail::LawOf<M>::type>, "A Region is made of a Material or a Graded one.");

  std::string name;  ///< name of the region in PointCloud::regions
  M material;        ///< a Material, or a Graded one
};
/// Deduced from any kind of text and the material.
template <class Name, class M>
Region(Name, M) -> Region<M>;

/// The materials of a body: `Materials{Region{"nucleus", ModifiedMooneyRivlin{}}, Region{"cytoplasm", NematicGel{}}}`.
template <class... M>
struct Materials {
  static_assert(sizeof...(M) > 0, "Materials needs at least one Region.");
  static constexpr std::size_t size = sizeof...(M);  ///< number of regions

  std::tuple<Region<M>...> regions;  ///< with their names

  explicit Materials(Region<M>... region) : regions(std::move(region)...) {}  ///< names must differ: see validate()

  /// Calls f(i, region) for each region, in order; i is a std::size_t.
  template <class Function>
  void for_each(Function&& f) const {
    std::size_t i = 0;
    std::apply([&](const auto&... region) { (f(i++, region), ...); }, regions);
  }

  /// Position of the region of that name; throws ParameterError, with the names there are, if there is none.
  [[nodiscard]] std::size_t index_of(std::string_view name) const {
    std::size_t found = size;
    std::string names;
    for_each([&](std::size_t i, const auto& region) {
      if (region.name == name) found = i;
      names += (i == 0 ? "" : ", ") + region.name;
    });
    if (found == size)
      throw ParameterError("Materials has no region named '" + std::string(name) + "'; its regions are: " + names +
                           ".");
    return found;
  }

  /// Validates every material that is not graded (those are validated where they are evaluated), and that no name
  /// occurs twice. Throws ParameterError.
  void validate() const {
    for_each([&](std::size_t i, const auto& region) {
      if constexpr (requires { region.material.validate(); }) region.material.validate();
      for_each([&](std::size_t j, const auto& other) {
        if (j < i && other.name == region.name)
          throw ParameterError("Materials has two regions named '" + region.name + "'; each name must be given once.");
      });
    });
  }
};

}  // namespace tactoid
