// Clouds in files, and parts of them that are read without the whole.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <tactoid/geometry/all.hpp>
#include <tactoid/input/cloud_file.hpp>

#include "input_files.hpp"

namespace input_cloud_file_test {
using namespace tactoid;
using tactoid::test::Folder;

template <int D>
void check_same(const PointCloud<D>& a, const PointCloud<D>& b) {
  CHECK(a.positions == b.positions);
  CHECK(a.cells == b.cells);
  CHECK(a.cell_regions == b.cell_regions);
  CHECK(a.regions == b.regions);
  CHECK(a.facets == b.facets);
  CHECK(a.period == b.period);
  CHECK(a.axisymmetric == b.axisymmetric);
}

template <int D>
void check_file(const PointCloud<D>& cloud, double support) {
  const Folder folder;
  const auto path = folder.path / "cloud.h5";
  write_cloud(path, cloud);
  CHECK(!std::filesystem::exists(folder.path / "cloud.h5.part"));
  check_same(read_cloud<D>(path), cloud);
  for (const bool surface : {false, true})
    for (const int ranks : {1, 3})
      for (int rank = 0; rank < ranks; ++rank) {
        const Part part{.rank = rank, .ranks = ranks, .support = support, .surface = surface};
        const PointCloud<D> read = read_cloud_part<D>(path, part), made = part_of(cloud, part);
        check_same(read, made);
        CHECK(read.part->number == made.part->number);
        CHECK(read.part->owner == made.part->owner);
        CHECK(read.part->own == made.part->own);
        CHECK(read.part->complete == made.part->complete);
        CHECK(read.part->spacing == made.part->spacing);
        CHECK(read.part->whole == cloud.size());
      }
}

TEST_CASE("A cloud in a file is that cloud, and parts that are read are those of it") {
  check_file(ball({.radius = 1.0, .core_radius = 0.4, .core_cells = 4, .shells = 3}), 1.3);  // two regions
  check_file(box({.size = Point<3>(3.0, 0.5, 1.0), .cells = {24, 4, 6}, .periodic = {true, false, false}}), 1.2);
  check_file(meridian(Disc{.radius = 1.0, .height = 0.5, .core_cells = 8, .rings = 4, .layers = 6}), 1.5);
  check_file(bar({.length = 1.0, .cells = 30, .periodic = true}), 2.0);
}

TEST_CASE("A file that is read in more than one piece") {
  const PointCloud<2> sheet = rectangle({.size = {3.0, 1.0}, .cells = {500, 180}});
  CHECK(sheet.size() > detail::rows_at_a_time);
  const Folder folder;
  write_cloud(folder.path / "sheet.h5", sheet);
  check_same(read_cloud<2>(folder.path / "sheet.h5"), sheet);
  const Part part{.rank = 1, .ranks = 4, .support = 2.0};
  check_same(read_cloud_part<2>(folder.path / "sheet.h5", part), part_of(sheet, part));
}

TEST_CASE("What is no file of a cloud is refused") {
  const Folder folder;
  const PointCloud<2> square = rectangle({.size = {1.0, 1.0}, .cells = {4, 4}});
  const auto path = folder.path / "square.h5";
  write_cloud(path, square);
  CHECK_THROWS_WITH_AS((void)read_cloud<3>(path), doctest::Contains("is a cloud of 2 dimensions, not of 3."), FileError);
  CHECK_THROWS_WITH_AS((void)read_cloud<2>(folder.path / "none.h5"), doctest::Contains("Cannot read"), FileError);
  CHECK_THROWS_WITH_AS((void)read_cloud<2>(folder.write("no HDF5")), doctest::Contains("is no cloud of Tactoid"), FileError);
  CHECK_THROWS_WITH_AS(write_cloud(folder.path / "nowhere" / "square.h5", square), doctest::Contains("Cannot write"), FileError);
  CHECK_THROWS_AS(write_cloud(path, part_of(square, {.rank = 0, .ranks = 2, .support = 1.0})), ParameterError);
  CHECK_THROWS_AS((void)read_cloud_part<2>(path, {.rank = 2, .ranks = 2, .support = 1.0}), ParameterError);
  CHECK_THROWS_AS((void)read_cloud_part<2>(path, {.rank = 0, .ranks = 26, .support = 1.0}), ParameterError);
  // A byte of a position, and a cell of a particle that there is not.
  std::string bytes = read_file(path);
  const double X = square.positions[7][0];
  const std::string_view number(reinterpret_cast<const char*>(&X), sizeof X);
  const std::size_t place = bytes.find(number);
  REQUIRE(place != std::string::npos);
  bytes[place + 3] = static_cast<char>(bytes[place + 3] ^ 1);
  CHECK_THROWS_WITH_AS((void)read_cloud<2>(folder.write(bytes, "damaged.h5")), doctest::Contains("is a damaged cloud."), FileError);
  CHECK_THROWS_AS((void)read_cloud<2>(folder.write(bytes.substr(0, bytes.size() / 2), "short.h5")), FileError);
}

}  // namespace input_cloud_file_test
