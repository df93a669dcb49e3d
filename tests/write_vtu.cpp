// Writes a folder as spreading_uniform does, with fields that are known: a ball flattened on a disc, at the paper's
// size. Other people's readers read it back (read_vtu.py), and the plot draws it.
//   write_vtu FOLDER

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <tactoid/core/ranks.hpp>
#include <tactoid/core/units.hpp>
#include <tactoid/geometry/ball.hpp>
#include <tactoid/geometry/disc.hpp>
#include <tactoid/output/all.hpp>
#include <tactoid/simulation/decomposition.hpp>

using namespace tactoid;

namespace {

/// Volume of the trilinear hexahedron, corners in tensor order: 2 × 2 × 2 Gauss points are exact.
double volume(const std::array<Index, 8>& cell, const std::vector<Vector4>& x) {
  double sum = 0.0;
  for (int point = 0; point < 8; ++point) {
    Vector3 s;
    for (int k = 0; k < 3; ++k) s[k] = 0.5 + ((point >> k & 1) != 0 ? 0.5 : -0.5) / std::sqrt(3.0);
    Tensor3 jacobian = Tensor3::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      for (int j = 0; j < 3; ++j) {
        double slope = 1.0;
        for (int k = 0; k < 3; ++k) {
          const bool upper = (corner >> k & 1) != 0;
          slope *= k == j ? (upper ? 1.0 : -1.0) : (upper ? s[k] : 1.0 - s[k]);
        }
        jacobian.col(j) += slope * x[cell[static_cast<std::size_t>(corner)]].head<3>();
      }
    }
    sum += jacobian.determinant() / 8.0;
  }
  return sum;
}

template <class Motion>
double write_body(const PointCloud<3>& cloud, double time, const std::filesystem::path& path, const Motion& motion) {
  std::vector<Vector4> position, displacement, velocity, director;
  std::vector<double> stress, pressure, jacobian, gap;
  std::vector<std::int32_t> region(cloud.size(), 1);
  for (std::size_t c = 0; c < cloud.cells.size(); ++c)
    for (const Index i : cloud.cells[c])
      if (cloud.cell_regions[c] == 0) region[i] = 0;
  for (const Point<3>& reference : cloud.positions) {
    const Vector3 x = motion(reference);
    position.push_back(pad(x));
    displacement.push_back(pad(x - reference));
    velocity.push_back(Vector4(1.0, 2.0, 3.0, 0.0));
    director.push_back(Vector4(std::cos(1e5 * x.z()), 0.0, std::sin(1e5 * x.z()), 0.0));
    stress.push_back(1e3 + 2e8 * std::abs(x.z()));
    pressure.push_back(-100.0);
    jacobian.push_back(1.0);
    gap.push_back(x.z());
  }
  VtuGrid grid(time);
  grid.points(position);
  grid.cells(cloud.cells);
  grid.vertices(position.size());
  grid.point_data("displacement", displacement);
  grid.point_data("velocity", velocity);
  grid.point_data("effective_stress", stress);
  grid.point_data("pressure", pressure);
  grid.point_data("J", jacobian);
  grid.point_data("region", region);
  grid.point_data("director", director);
  grid.point_data("gap", gap);
  std::vector<float> kind(cloud.cells.size(), 0.5f);
  kind.resize(grid.cell_count(), -0.5f);
  grid.cell_data("kind", kind);
  if (path.extension() == ".pvtu") grid.write_pieces(path);
  else grid.write(path);
  double sum = 0.0;
  for (const auto& cell : cloud.cells) sum += volume(cell, position);
  return sum;
}

/// One of two processes, for the pieces of a grid.
struct OneOfTwo final : Ranks {
  explicit OneOfTwo(int number) : number_(number) { Ranks::current = this; }
  ~OneOfTwo() override { Ranks::current = nullptr; }
  [[nodiscard]] int rank() const override { return number_; }
  [[nodiscard]] int size() const override { return 2; }
  [[nodiscard]] long largest(long number) override { return number; }
  [[nodiscard]] std::string text_of(int, const std::string& text) override { return text; }
  void gather(std::span<double>, std::span<const std::size_t>) override {}
  void gather(std::span<Index>, std::span<const std::size_t>) override {}
  [[nodiscard]] std::vector<std::vector<double>> exchange(std::vector<std::vector<double>> lists) override { return lists; }
  [[nodiscard]] std::unique_ptr<SharedFile> open_shared(const std::filesystem::path&) override { return nullptr; }
  [[nodiscard]] std::shared_ptr<RowShare> divide(const TableOutline&) override { return nullptr; }
  [[nodiscard]] std::shared_ptr<RowShare> share_of(const PointTable&, std::shared_ptr<const CloudPart>) override { return nullptr; }
  [[nodiscard]] std::unique_ptr<Decomposition> decompose(std::vector<SharedBody>) override { return nullptr; }
  [[nodiscard]] bool reports_failure(std::string_view, int) override { return true; }

 private:
  int number_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("write_vtu FOLDER\n", stderr);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  prepare_folder(folder / "fields");
  const PointCloud<3> cell =
      ball({.radius = 5.0_um, .core_radius = 0.382 * 5.0_um, .center = Point<3>(0.0, 0.0, 5.2_um)});
  const PointCloud<3> substrate = disc({.radius = 15.0_um, .height = 5.0_um});

  PvdSeries series(folder / "fields.pvd");
  HistoryWriter history(folder / "history.csv",
                        {"time", "spread_area", "kinetic_energy", "strain_energy", "adhesion_energy", "surface_energy",
                         "dissipated_energy", "external_work"});
  Summary summary;
  for (int frame = 0; frame <= 2; ++frame) {
    const double time = frame * 2.5e-6;
    const double flat = 1.0 - 0.25 * frame;  // the ball is pressed down and widens
    const std::string number = fmt::format("{:04}", frame);
    const double volume_cell =
        write_body(cell, time, folder / "fields" / ("cell_" + number + ".vtu"), [&](const Point<3>& x) -> Vector3 {
          const double widening = 1.0 / std::sqrt(flat);
          return {x.x() * widening, x.y() * widening, 0.2_um + flat * (x.z() - 0.2_um) - 0.15_um * frame};
        });
    const double volume_substrate = write_body(
        substrate, time, folder / "fields" / ("substrate_" + number + ".vtu"), [&](const Point<3>& x) -> Vector3 {
          const double r = x.head<2>().norm() / 5.0_um;
          return {x.x(), x.y(), x.z() - 0.25_um * frame * std::exp(-r * r) * (1.0 + x.z() / 5.0_um)};
        });
    series.add(time, "fields/cell_" + number + ".vtu", "cell");
    series.add(time, "fields/substrate_" + number + ".vtu", "substrate");
    history.write(std::vector<double>{time, frame * 4e-11, frame * 1e-15, frame * 2e-15, -frame * 8e-15, frame * 1e-15,
                                      frame * 4e-15, 0.0});
    summary.set("volume_cell", volume_cell).set("volume_substrate", volume_substrate);
  }
  // Both bodies as the pieces of one grid.
  const auto at_rest = [](const Point<3>& x) -> Vector3 { return x; };
  for (const int rank : {1, 0}) {
    const OneOfTwo ranks(rank);
    write_body(rank == 0 ? cell : substrate, 0.0, folder / "pieces.pvtu", at_rest);
  }
  summary.set("points_cell", cell.size()).set("points_substrate", substrate.size());
  summary.set("hexahedra_cell", cell.cells.size()).set("hexahedra_substrate", substrate.cells.size());
  summary.set("facets_cell", cell.facets.size()).set("facets_substrate", substrate.facets.size());
  summary.write(folder / "summary.json");
}
