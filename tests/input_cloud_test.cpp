// Points without cells become bodies: Delaunay's triangulation, the alpha shape, volumes, surfaces, regions. Tables of
// points and VTU files in every encoding; what is no body, no table or no VTU file is refused with place and cause.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <tactoid/core/random.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/input/all.hpp>
#include <tactoid/output/vtu.hpp>

#include "input_files.hpp"
#include "relative.hpp"

namespace input_cloud_test {

using namespace tactoid;
using test::Folder;
using test::says;

namespace {

/// (n + 1)^D points of a lattice in the unit cube (square), those inside jittered by a part of the spacing.
template <int D>
std::vector<Point<D>> lattice(int n, double jitter_by = 0.0) {
  std::vector<Point<D>> points;
  Random random(5);
  for (int k = 0; k <= (D == 3 ? n : 0); ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        Vector3 x(i, j, k);
        for (int c = 0; c < D; ++c)
          if (x[c] > 0.5 && x[c] < n - 0.5) x[c] += jitter_by * random.uniform(-1.0, 1.0);
        points.push_back(x.head<D>() / n);
      }
  return points;
}

template <int D>
double volume_of(const PointCloud<D>& cloud) {
  double sum = 0.0;
  for (const double V : nodal_volumes(cloud)) {
    CHECK(V > 0.0);
    sum += V;
  }
  return sum;
}

/// The surface is closed and points outwards: Σ ∮ N n dA = 0 and its moment is the volume times the unit tensor.
template <int D>
void has_closed_surface(const PointCloud<D>& cloud) {
  const std::vector<Point<D>> normals = boundary_normal_integrals(cloud);
  Point<D> sum = Point<D>::Zero();
  Eigen::Matrix<double, D, D> moment = Eigen::Matrix<double, D, D>::Zero();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    sum += normals[i];
    moment += normals[i] * cloud.positions[i].transpose();
  }
  const double V = volume_of(cloud);
  CHECK(sum.norm() < 1e-12 * boundary_area(cloud));
  CHECK((moment / V - Eigen::Matrix<double, D, D>::Identity()).norm() < 1e-10);
}

template <int D = 3>
std::string refused_points(Points<D> points, const PointsOptions& options = {}) {
  return test::refusal([&] { return cloud_of_points<D>(std::move(points), options); });
}
template <int D = 3>
std::string refused_csv(const std::string& text, const PointsOptions& options = {}) {
  const Folder folder;
  return test::refusal([&] { return read_csv<D>(folder.write(text, "cell.csv"), options); });
}
template <int D = 3>
std::string refused_vtu(const std::string& text, const VtuOptions& options = {}) {
  const Folder folder;
  return test::refusal([&] { return read_vtu<D>(folder.write(text, "cell.vtu"), options); });
}

std::string table(const std::vector<Point<3>>& points, const std::string& more = "",
                  const std::string& separator = ",") {
  std::string text = "x" + separator + "y" + separator + "z" + (more.empty() ? "" : separator + more) + "\n";
  for (const Point<3>& X : points) text += fmt::format("{}{}{}{}{}\n", X[0], separator, X[1], separator, X[2]);
  return text;
}

/// Writes the VTU file of a cloud of hexahedra as VTK, ParaView and meshio do.
struct VtuFile {
  enum Encoding { ascii, binary, raw, base64 } encoding = ascii;
  bool wide_header = false, big_endian = false;
  bool padded_header = false;  // header and data in base64 for themselves
  std::uint32_t block = 0;     // "compressed" in blocks of that many bytes; here without making them smaller
  std::string appended{};

  template <class T>
  [[nodiscard]] std::string bytes_of(const std::vector<T>& values) const {
    std::string bytes;
    for (const T value : values) {
      auto raw_bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
      if (big_endian) std::reverse(raw_bytes.begin(), raw_bytes.end());
      bytes.append(raw_bytes.data(), raw_bytes.size());
    }
    return bytes;
  }
  [[nodiscard]] static std::string in_base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
      std::uint32_t bits = 0;
      const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
      for (std::size_t b = 0; b < 3; ++b)
        bits = bits << 8 | (b < count ? static_cast<unsigned char>(bytes[k + b]) : 0u);
      for (std::size_t d = 0; d < 4; ++d) text += d <= count ? digits[bits >> (18 - 6 * d) & 63] : '=';
    }
    return text;
  }
  [[nodiscard]] std::string header(const std::vector<std::size_t>& numbers) const {
    std::vector<std::uint32_t> narrow(numbers.begin(), numbers.end());
    std::vector<std::uint64_t> wide(numbers.begin(), numbers.end());
    return wide_header ? bytes_of(wide) : bytes_of(narrow);
  }

  template <class T>
  std::string array(const std::string& type, const std::string& attributes, const std::vector<T>& values) {
    std::string text = fmt::format("<DataArray type=\"{}\" {} format=\"{}\"", type, attributes,
                                   encoding == ascii    ? "ascii"
                                   : encoding == binary ? "binary"
                                                        : "appended");
    if (encoding == ascii) {
      text += ">\n";
      for (const T value : values) text += fmt::format("{} ", +value);
      return text + "\n</DataArray>\n";
    }
    const std::string bytes = bytes_of(values);
    std::vector<std::size_t> numbers = {bytes.size()};
    if (block > 0) {
      const std::size_t blocks = (bytes.size() + block - 1) / block, last = bytes.size() % block;
      numbers = {blocks, block, last};
      for (std::size_t b = 0; b < blocks; ++b) numbers.push_back(b + 1 == blocks && last > 0 ? last : block);
    }
    const std::string head = header(numbers);
    const std::string coded = encoding == raw ? head + bytes
                              : padded_header ? in_base64(head) + in_base64(bytes)
                                              : in_base64(head + bytes);
    if (encoding == binary) return text + ">\n  " + coded + "\n</DataArray>\n";
    text += fmt::format(" offset=\"{}\"/>\n", appended.size());
    appended += coded;
    return text;
  }

  std::string write(const PointCloud<3>& cloud) {
    appended.clear();
    std::vector<double> points;
    std::vector<std::int64_t> connectivity, offsets;
    std::vector<std::uint8_t> types;
    std::vector<std::int32_t> regions;
    for (const Point<3>& X : cloud.positions) points.insert(points.end(), X.begin(), X.end());
    for (std::size_t c = 0; c < cloud.cells.size(); ++c) {
      for (const std::size_t a : {0u, 1u, 3u, 2u, 4u, 5u, 7u, 6u}) connectivity.push_back(cloud.cells[c][a]);
      offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
      types.push_back(12);
      regions.push_back(cloud.positions[cloud.cells[c][0]][0] < 0.2 ? 4 : -7);
    }
    connectivity.push_back(0);  // a point, which is left out
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    types.push_back(1);
    regions.push_back(99);
    std::string text = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- made by hand -->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
        "byte_order=\"{}\" header_type=\"{}\"{}>\n",
        big_endian ? "BigEndian" : "LittleEndian", wide_header ? "UInt64" : "UInt32",
        block > 0 ? " compressor='vtkZLibDataCompressor'" : "");
    text += fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
                        cloud.size(), types.size());
    text += array("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", points);
    text += "</Points>\n<Cells>\n";
    text += array("Int64", "Name=\"connectivity\"", connectivity);
    text += array("Int64", "Name=\"offsets\"", offsets);
    text += array("UInt8", "Name=\"types\"", types);
    text += "</Cells>\n<CellData Scalars=\"region\">\n";
    text += array("Int32", "Name=\"region\"", regions);
    text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n";
    if (encoding == raw || encoding == base64)
      text += fmt::format("<AppendedData encoding=\"{}\">\n   _", encoding == raw ? "raw" : "base64") + appended +
              "\n</AppendedData>\n";
    return text + "</VTKFile>\n";
  }
};

/// Stands for zlib's: the blocks of VtuFile are as they were.
std::string no_compression(std::string_view bytes, std::size_t size) {
  return bytes.size() == size ? std::string(bytes) : "";
}

}  // namespace

TEST_CASE("Delaunay's triangulation: no point in any ball, no gap, no flat simplex in a lattice however it lies") {
  const std::vector<Point<3>> points = lattice<3>(4, 0.3);
  const Eigen::Matrix3d metric = detail::Delaunay<3>::metric();
  double volume = 0.0;
  for (const auto& s : detail::Delaunay<3>(points).simplices()) {
    Eigen::Matrix3d e;
    for (int k = 0; k < 3; ++k) e.col(k) = points[s[static_cast<std::size_t>(k) + 1]] - points[s[0]];
    CHECK(e.determinant() > 0.0);
    volume += e.determinant() / 6.0;
    const Eigen::Matrix3d me = metric * e;
    const Point<3> c = me.transpose().fullPivLu().solve(Point<3>(0.5 * e.cwiseProduct(me).colwise().sum().transpose()));
    const double square = c.dot(metric * c);
    for (const Point<3>& X : points) {
      const Point<3> d = X - points[s[0]] - c;
      CHECK(d.dot(metric * d) > square * (1.0 - 1e-4));
    }
  }
  CHECK(volume == test::relative(1.0).epsilon(1e-12));

  // All eight points of a cube lie on a sphere: six tetrahedra per cube, or two triangles per square, of the same
  // volume.
  for (const auto& s : detail::Delaunay<3>(lattice<3>(3)).simplices()) {
    const std::vector<Point<3>> X = lattice<3>(3);
    Eigen::Matrix3d e;
    for (int k = 0; k < 3; ++k) e.col(k) = X[s[static_cast<std::size_t>(k) + 1]] - X[s[0]];
    CHECK(e.determinant() == test::relative(1.0 / 27.0).epsilon(1e-12));
  }
  CHECK(detail::Delaunay<3>(lattice<3>(3)).simplices().size() == 6 * 27);
  CHECK(detail::Delaunay<2>(lattice<2>(9)).simplices().size() == 2 * 81);
  CHECK_THROWS_WITH_AS((void)detail::Delaunay<2>({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1e-9}}),
                       doctest::Contains("points 1 and 3 coincide"), GeometryError);
}

TEST_CASE("Points of a box: exact volume and surface, in any position, regular or not") {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  for (const double jitter_by : {0.0, 0.02, 0.2, 0.4})
    for (const bool turned : {false, true}) {
      std::vector<Point<3>> points = lattice<3>(5, jitter_by);
      for (Point<3>& X : points)
        if (turned) X = turn * X;
      CAPTURE(jitter_by);
      CAPTURE(turned);
      const PointCloud<3> cloud = cloud_of_points<3>({.positions = points}, {.scale = 1e-6});
      CHECK(volume_of(cloud) == test::relative(1e-18).epsilon(1e-10));
      CHECK(boundary_area(cloud) == test::relative(6e-12).epsilon(1e-6));
      has_closed_surface(cloud);
    }
  const PointCloud<2> square = cloud_of_points<2>({.positions = lattice<2>(8, 0.3)});
  CHECK(volume_of(square) == test::relative(1.0).epsilon(1e-12));
  CHECK(boundary_area(square) == test::relative(4.0).epsilon(1e-12));
  has_closed_surface(square);
  // Round-off of a turned and shaken plane leaves nothing flat on the surface.
  std::vector<Point<3>> shaken = lattice<3>(5);
  Random random(9);
  for (Point<3>& X : shaken)
    X = turn * X + 1e-7 * Point<3>(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  const PointCloud<3> cloud = cloud_of_points<3>({.positions = shaken});
  CHECK(volume_of(cloud) == test::relative(1.0).epsilon(1e-6));
  CHECK(boundary_area(cloud) == test::relative(6.0).epsilon(1e-5));
  CHECK(cloud.cells.size() == 4 * 6 * 125);
}

TEST_CASE("Points of a ball: the volume that is missing falls with the square of the spacing") {
  std::vector<double> missing;
  for (const int n : {4, 6}) {
    const PointCloud<3> cloud = cloud_of_points<3>(
        {.positions = ball({.radius = 1.0, .core_radius = 0.5, .core_cells = n, .shells = n / 2}).positions});
    has_closed_surface(cloud);
    missing.push_back(1.0 - volume_of(cloud) / (4.0 / 3.0 * std::numbers::pi));
    CHECK(boundary_area(cloud) == test::relative(4.0 * std::numbers::pi).epsilon(0.04));
  }
  MESSAGE("of the ball's volume are missing " << missing[0] << ", " << missing[1]);
  CHECK(missing[0] < 0.07);
  CHECK(missing[0] / missing[1] == test::relative(2.25).epsilon(0.15));
}

TEST_CASE(
    "Hollows and re-entrant edges: what is wider than alpha spacings stays open, edges are rounded by half a cell") {
  constexpr int n = 6;
  std::vector<Point<3>> corner, hollow;
  for (const Point<3>& X : lattice<3>(n))
    if (X[0] < 0.51 || X[1] < 0.51) corner.push_back(X);
  CHECK(volume_of(cloud_of_points<3>({.positions = corner})) == test::relative(0.75 + 0.5 / (n * n)).epsilon(1e-10));
  for (const Point<3>& X : lattice<3>(8))
    if ((X - Point<3>::Constant(0.5)).cwiseAbs().maxCoeff() > 0.26) hollow.push_back(X);
  const PointCloud<3> shell = cloud_of_points<3>({.positions = hollow});
  has_closed_surface(shell);
  CHECK(boundary_area(shell) > 6.0 + 6.0 * 0.4);  // the inner side is a surface, too
  CHECK(volume_of(shell) < 1.0 - 0.09);
  CHECK(volume_of(cloud_of_points<3>({.positions = hollow}, {.alpha = 4.0})) == test::relative(1.0).epsilon(1e-10));
}

TEST_CASE("Slivers are replaced by other tetrahedra in the same place") {
  for (const double jitter_by : {0.02, 0.1}) {
    const std::vector<Point<3>> points = lattice<3>(12, jitter_by);
    const detail::AlphaShape<3> shape(points, std::vector<double>(points.size(), 1.0 / 12.0), 1.4);
    int slivers = 0;
    for (const auto& s : detail::Delaunay<3>(points).simplices()) slivers += shape.quality(s) < shape.sliver ? 1 : 0;
    CHECK(slivers > 5);
    double volume = 0.0;
    for (const auto& s : shape.simplices()) {
      CHECK(shape.quality(s) >= shape.sliver);
      volume += shape.volume(s) / 6.0;
    }
    CHECK(volume == test::relative(1.0).epsilon(1e-12));
  }
}

TEST_CASE("Points at random: a surface that touched itself is mended") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Random random(seed);
    std::vector<Point<3>> points;
    for (int i = 0; i < 200; ++i)
      points.push_back({random.uniform(0.0, 1.0), random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)});
    const PointCloud<3> cloud = cloud_of_points<3>({.positions = points});
    has_closed_surface(cloud);
    CHECK(volume_of(cloud) > 0.5);
    std::vector<Point<2>> flat;
    for (const Point<3>& X : points) flat.push_back(X.head<2>());
    has_closed_surface(cloud_of_points<2>({.positions = flat}));
  }
  // Two blocks that have an edge in common. Along it they are joined.
  std::vector<Point<3>> blocks = lattice<3>(3);
  for (const Point<3>& X : lattice<3>(3))
    if (X[0] > 0.1 || X[1] > 0.1) blocks.push_back(X + Point<3>(1.0, 1.0, 0.0));
  has_closed_surface(cloud_of_points<3>({.positions = blocks}, {.alpha = 0.9}));
}

TEST_CASE("Regions of points meet in the middle between them") {
  Points<3> points{.positions = lattice<3>(3), .regions = {"left", "right"}};
  for (const Point<3>& X : points.positions) points.point_regions.push_back(X[0] < 0.5 ? 0 : 1);
  const PointCloud<3> cloud = cloud_of_points<3>(points);
  CHECK(cloud.regions == std::vector<std::string>{"left", "right"});
  std::vector<double> volumes(2, 0.0);
  for (const NodalCell<3>& part : nodal_cells(cloud)) volumes[part.region] += part.volume;
  CHECK(volumes[0] == test::relative(0.5).epsilon(1e-12));
  CHECK(volumes[1] == test::relative(0.5).epsilon(1e-12));
}

TEST_CASE("Points that are no body are refused") {
  const Points<3> good{.positions = lattice<3>(3)};
  const auto bent = [&](auto change, const PointsOptions& options = {}) {
    Points<3> points = good;
    change(points);
    return refused_points(points, options);
  };
  CHECK(bent([](auto&) {}) == "accepted");
  CHECK(
      says(bent([](auto& p) { p.positions.resize(1); }), "there is 1 point: a body of 3 dimensions needs 4 at least"));
  CHECK(says(bent([](auto& p) { p.positions.clear(); }), "there are 0 points"));
  CHECK(says(bent([](auto& p) { p.positions.resize(16); }), "all points lie in a plane"));
  CHECK(says(refused_points<2>({.positions = {{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}}}),
             "all points lie on a line"));
  CHECK(says(bent([](auto& p) { p.positions[7][1] = std::numeric_limits<double>::infinity(); }),
             "point 7 has a position that is not finite"));
  CHECK(says(bent([](auto& p) { p.positions.push_back(p.positions[3] + Point<3>::Constant(1e-8)); }),
             "point 3 and point 64 coincide at (1, 0, 0) m"));
  CHECK(says(bent([](auto& p) {
               p.positions.push_back({9.0, 0.0, 0.0});
             }),
             "point 64 at (9, 0, 0) m is too far from the others to belong to the body: raise alpha = 1.4"));
  CHECK(says(bent([](auto& p) { p.volumes = {1.0}; }), "there are 64 points, but 1 volumes"));
  CHECK(says(bent([](auto& p) { p.point_regions = {0}; }), "there are 64 points, but 1 regions of points"));
  CHECK(says(bent([](auto& p) { p.point_regions.assign(64, 3); }),
             "point 0 is in region 3, but there are only 1 regions"));
  CHECK(says(bent([](auto& p) { p.volumes.assign(64, 1.0 / 64.0), p.volumes[5] = -1.0; }),
             "point 5 has the volume -1: it must be positive"));
  CHECK(bent([](auto& p) { p.volumes.assign(64, 1.0 / 64.0); }) == "accepted");
  CHECK(says(bent([](auto& p) { p.volumes.assign(64, 1.3 / 64.0); }),
             "the volumes of the points sum to 1.3 m^3, the body between them has 1: points must lie on its surface"));
  CHECK(says(bent([](auto&) {}, {.alpha = 0.5}), "the points enclose no volume"));
  CHECK(says(bent([](auto&) {}, {.alpha = -1.0}), "PointsOptions.alpha = -1 is not allowed"));
  CHECK(says(bent([](auto&) {}, {.scale = 0.0}), "PointsOptions.scale = 0 m is not allowed"));
  CHECK(says(bent([](auto&) {}, {.coincidence = 1.0}), "PointsOptions.coincidence = 1 is not allowed"));
  CHECK(says(bent([](auto&) {}, {.volume_tolerance = 0.0}), "PointsOptions.volume_tolerance = 0 is not allowed"));
}

TEST_CASE("Tables of points: separators, comments, columns in any order, regions, two dimensions") {
  const Folder folder;
  const std::vector<Point<3>> points = lattice<3>(3, 0.2);
  const PointCloud<3> cloud = read_csv<3>(folder.write(table(points)), {.scale = 1e-6});
  CHECK(volume_of(cloud) == test::relative(1e-18).epsilon(1e-12));
  CHECK(cloud.regions == std::vector<std::string>{"body"});
  CHECK(read_csv<3>(folder.write(table(points, "", ";")), {.scale = 1e-6}).positions == cloud.positions);
  CHECK(read_csv<3>(folder.write(table(points, "", "\t")), {.scale = 1e-6}).positions == cloud.positions);
  std::string text = "\xEF\xBB\xBF# points of a cell\r\n\r\n region ,z, \"y\" ,volume,x\r\n";
  for (const Point<3>& X : points)
    text += fmt::format("{},{}, {} ,{},\"{}\"\r\n# between\r\n", X[0] < 0.5 ? "\"nucleus, soft\"" : "2", X[2], X[1],
                        1.0 / 64.0, X[0]);
  text.resize(text.size() - 13);  // the last line ends with the file
  const PointCloud<3> parts = read_csv<3>(folder.write(text), {.scale = 1e-6});
  CHECK(parts.positions == cloud.positions);
  CHECK(parts.regions == std::vector<std::string>{"nucleus, soft", "region 2"});

  std::string flat = "y;x;z\n";
  for (const Point<2>& X : lattice<2>(4)) flat += fmt::format("{};{};0\n", X[1], 2.0 * X[0]);
  const PointCloud<2> sheet = read_csv<2>(folder.write(flat));
  CHECK(volume_of(sheet) == test::relative(2.0).epsilon(1e-12));
  CHECK(boundary_area(sheet) == test::relative(6.0).epsilon(1e-12));
}

TEST_CASE("Tables that are none are refused with the line") {
  const std::string good = table(lattice<3>(3));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refused_csv(text);
  };
  CHECK(refused_csv(good) == "accepted");
  CHECK(says(refused_csv(""), "has no line with the names of the columns: x, y and z are needed"));
  CHECK(says(refused_csv("# x,y,z\n\n"), "has no line with the names of the columns"));
  CHECK(says(refused_csv("x,y,z\n"), "has no points below the names"));
  CHECK(says(refused_csv("0,0,0\n1,0,0\n"), "line 1: there is no column \"0\": x, y and z are needed"));
  CHECK(says(refused_csv("x y z\n0 0 0\n"),
             "line 1: \"x y z\" is no list of columns separated by comma, semicolon or tab"));
  CHECK(says(refused_csv("# one\nx,y\n0,0\n"), "line 2: the column z is missing"));
  CHECK(says(refused_csv("x;y,z\n"), "separated in two ways"));
  CHECK(says(refused_csv("x,y,z,x\n"), "the column x is there twice"));
  CHECK(says(refused_csv("x,y,z,regoin\n"), "there is no column \"regoin\""));
  CHECK(says(with("\n0,0,0\n", "\n0,0\n"), "line 2: there are 2 fields, but 3 columns"));
  CHECK(says(with("\n0,0,0\n", "\n0\n"), "line 2: there is 1 field, but 3 columns"));
  CHECK(says(with("\n0,0,0\n", "\n0,0,0,\n"), "line 2: there are 4 fields, but 3 columns"));
  CHECK(says(with("\n0,0,0\n", "\n0,zero,0\n"), "line 2: y = \"zero\" is no number"));
  CHECK(says(with("\n0,0,0\n", "\n0,,0\n"), "line 2: y = \"\" is no number"));
  CHECK(says(with("\n0,0,0\n", "\n0,1.5e,0\n"), "line 2: y = \"1.5e\" is no number"));
  CHECK(says(with("\n0,0,0\n", "\n0,nan,0\n"), "line 2: y = nan is not finite"));
  CHECK(says(with("\n0,0,0\n", "\n0,inf,0\n"), "line 2: y = inf is not finite"));
  CHECK(says(with("\n0,0,0\n", "\n0,\"0,0\n"), "line 2: a quotation mark is not closed"));
  CHECK(says(with("\n0,0,0\n", "\n0,\"0\"1,0\n"),
             "line 2: there is something between a quotation mark and the next column"));
  CHECK(says(with("\n0,0,0\n", "\n0,\xFF,0\n"), "line 2: there are bytes that are no text"));
  CHECK(says(with("\n0,0,0\n", "\n0,0,0\n0,0,1e-9\n"), "the point of line 2 and the point of line 3 coincide"));
  CHECK(says(refused_csv("x;y;z\n0,5;0;0\n"), "line 2: x = \"0,5\" is no number: write a point, no comma"));
  CHECK(says(refused_csv("x,y,z,region\n0,0,0,\n"), "line 2: the region is empty"));
  CHECK(says(refused_csv("x,y,z,volume\n0,0,0,0\n"), "line 2: volume = 0 is not allowed"));
  CHECK(
      says(refused_csv("x,y,z\n0,0,0\n1,0,0\n0,1,0\n"), "there are 3 points: a body of 3 dimensions needs 4 at least"));
  CHECK(says(refused_csv<2>("x,y,z\n0,0,1\n"),
             "line 2: z = 1 is not allowed: a cloud of 2 dimensions lies in the plane z = 0"));
  CHECK(says(refused_csv(good, {.alpha = 0.0}), "PointsOptions.alpha = 0 is not allowed"));
  const Folder folder;
  CHECK_THROWS_WITH_AS((void)read_csv<3>(folder.path / "none.csv"), doctest::Contains("No such file"), FileError);
  CHECK_THROWS_WITH_AS((void)read_csv<3>(folder.path), doctest::Contains("Cannot read \""), FileError);
}

TEST_CASE("VTU files: every encoding gives the same bits") {
  const PointCloud<3> body = jitter(box({.size = {1.0, 1.0, 1.0}, .cells = {3, 3, 3}}), 0.2);
  const Folder folder;
  const VtuOptions options{.scale = 1e-6, .region_names = {{4, "nucleus"}}};
  const PointCloud<3> expected = read_vtu<3>(folder.write(VtuFile{}.write(body)), options);
  CHECK(expected.regions.size() == 2);
  CHECK(std::set<std::string>(expected.regions.begin(), expected.regions.end()) ==
        std::set<std::string>{"nucleus", "region -7"});
  CHECK(volume_of(expected) == test::relative(1e-18).epsilon(1e-12));
  CHECK(boundary_area(expected) == test::relative(6e-12).epsilon(1e-12));
  int files = 0;
  for (const auto encoding : {VtuFile::binary, VtuFile::raw, VtuFile::base64})
    for (const bool wide : {false, true})
      for (const bool big : {false, true})
        for (const std::uint32_t block : {0u, 512u, 24u})
          for (const bool padded : {false, true}) {
            VtuFile file{
                .encoding = encoding, .wide_header = wide, .big_endian = big, .padded_header = padded, .block = block};
            VtuOptions how = options;
            if (block > 0) how.decompress = no_compression;
            const PointCloud<3> read = read_vtu<3>(folder.write(file.write(body)), how);
            CHECK(read.positions == expected.positions);
            CHECK(read.cells == expected.cells);
            CHECK(read.cell_regions == expected.cell_regions);
            ++files;
          }
  CHECK(files == 72);
}

TEST_CASE("VTU files that the library wrote come back with the same bits") {
  const Folder folder;
  const PointCloud<3> body = ball({.radius = 1e-6, .core_radius = 0.5e-6, .core_cells = 4, .shells = 2});
  VtuGrid grid;
  grid.points(body.positions);
  grid.cells(body.cells);
  grid.vertices(body.size());
  std::vector<std::int32_t> regions(body.cell_regions.begin(), body.cell_regions.end());
  regions.resize(grid.cell_count(), 7);
  grid.cell_data("region", regions);
  grid.point_data("speed", std::vector<float>(body.size(), 1.0F));
  grid.write(folder.path / "ball.vtu");
  VtuOptions options;
  for (std::size_t r = 0; r < body.regions.size(); ++r)
    options.region_names[static_cast<long long>(r)] = body.regions[r];
  const PointCloud<3> read = read_vtu<3>(folder.path / "ball.vtu", options);
  REQUIRE(read.positions == body.positions);
  REQUIRE(read.cells == body.cells);
  CHECK(read.facets == body.facets);
  for (std::size_t c = 0; c < body.cells.size(); ++c)
    CHECK(read.regions[read.cell_regions[c]] == body.regions[body.cell_regions[c]]);

  const PointCloud<2> sheet = rectangle({.size = {2.0, 1.0}, .cells = {4, 3}});
  VtuGrid plane;
  plane.points(sheet.positions);
  plane.cells(sheet.cells);
  plane.cells(sheet.facets);
  plane.write(folder.path / "sheet.vtu");
  CHECK(read_vtu<2>(folder.path / "sheet.vtu").cells == sheet.cells);
  const PointCloud<1> line = bar({.length = 2.0, .cells = 5});
  VtuGrid segments;
  segments.points(line.positions);
  segments.cells(line.cells);
  segments.write(folder.path / "line.vtu");
  CHECK(read_vtu<1>(folder.path / "line.vtu").positions == line.positions);
}

TEST_CASE("Voxels, pixels, triangles and tetrahedra of VTU files") {
  const auto file = [](const std::string& points, std::size_t n, int type, const std::string& nodes, int size) {
    return fmt::format(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints='{}' "
        "NumberOfCells='1'><PointData/><Points>"
        "<DataArray type='Float32' NumberOfComponents='3'>{}<InformationKey name='L2'/></DataArray></Points><Cells>"
        "<DataArray type='Int32' Name='connectivity'>{}</DataArray><DataArray type='Int32' Name='offsets' "
        "format='ascii'>{}</DataArray>"
        "<DataArray type='UInt8' Name='types'>{}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
        n, points, nodes, size, type);
  };
  const Folder folder;
  const std::string cube = "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1";
  CHECK(volume_of(read_vtu<3>(folder.write(file(cube, 8, 11, "0 1 2 3 4 5 6 7", 8)))) == test::relative(1.0));
  CHECK(volume_of(read_vtu<3>(folder.write(file(cube, 8, 10, "0 1 2 4", 4)))) == test::relative(1.0 / 6.0));
  CHECK(volume_of(read_vtu<2>(folder.write(file("0 0 0 2 0 0 0 1 0 2 1 0", 4, 8, "0 1 2 3", 4)))) ==
        test::relative(2.0));
  CHECK(volume_of(read_vtu<2>(folder.write(file("0 0 0 2 0 0 0 1 0 2 1 0", 4, 5, "0 1 2", 3)))) == test::relative(1.0));
  CHECK(read_vtu<3>(folder.write(file(cube, 8, 11, "0 1 2 3 4 5 6 7", 8))).regions == std::vector<std::string>{"body"});
}

TEST_CASE("VTU files that are damaged or no bodies are refused with place and cause") {
  const PointCloud<3> body = box({.size = {1.0, 1.0, 1.0}, .cells = {2, 2, 2}});
  const std::string good = VtuFile{}.write(body);
  const auto with = [&](const std::string& from, const std::string& to, const VtuOptions& options = {}) {
    std::string text = good;
    REQUIRE(text.find(from) != std::string::npos);
    text.replace(text.find(from), from.size(), to);
    return refused_vtu(text, options);
  };
  CHECK(refused_vtu(good) == "accepted");
  // No XML, or another file.
  CHECK(says(refused_vtu(""), "is no XML file"));
  CHECK(says(refused_vtu("# vtk DataFile Version 3.0\n"), "is no XML file"));
  CHECK(says(refused_vtu("<svg/>"), "is no VTU file: its first element is <svg>"));
  CHECK(says(with("\"UnstructuredGrid\"", "\"PolyData\""), "line 3: files of type \"PolyData\" are not read"));
  CHECK(says(with("LittleEndian", "PDP"), "byte_order = \"PDP\" is not allowed"));
  CHECK(says(with("UInt32", "UInt16"), "header_type = \"UInt16\" is not allowed"));
  CHECK(says(with("\"UnstructuredGrid\"", "\"UnstructuredGrid\" type=\"x\""),
             "the attribute type of <VTKFile> is there twice"));
  CHECK(says(with("type=\"UnstructuredGrid\"", "type=UnstructuredGrid"),
             "the value of the attribute type of <VTKFile> is not in quotation marks"));
  CHECK(says(with(" version=\"1.0\" byte", " =\"1.0\" byte"), "an attribute of <VTKFile> is expected here"));
  CHECK(says(with("</Points>", "</Cells>"), "</Points> is expected, not </Cells>"));
  CHECK(says(with("made by hand -->", "made by hand"), "line 2: a comment or an instruction is not closed"));
  CHECK(says(refused_vtu(good.substr(0, good.find("</Points>") - 30)), "line 8: the file ends inside <DataArray>"));
  std::string deep;
  for (int k = 0; k < 40; ++k) deep += "<a>";
  CHECK(says(with("<Points>", deep), "nested too deeply"));
  // Pieces and arrays.
  CHECK(says(with("<Piece", "<Piece NumberOfPoints=\"0\"/><Piece"), "line 4: there are 2 pieces"));
  CHECK(says(with("NumberOfPoints=\"27\"", "NumberOfPoints=\"28\""),
             "line 7: array \"Points\": 84 numbers are expected, 81 are there"));
  CHECK(says(with("NumberOfPoints=\"27\"", "NumberOfPoints=\"999999999\""),
             "999999999 points are announced, more than the file can hold"));
  CHECK(says(with("NumberOfPoints=\"27\"", "NumberOfPoints=\"-1\""),
             "line 5: NumberOfPoints of <Piece> must be a whole number, not \"-1\""));
  CHECK(says(with("NumberOfCells=\"9\"", ""), "NumberOfCells of <Piece> must be a whole number"));
  CHECK(says(with("NumberOfCells=\"9\"", "NumberOfCells=\"10\""),
             "array \"types\": 10 numbers are expected, 9 are there"));
  CHECK(
      says(with("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\""), "points must have NumberOfComponents=\"3\""));
  CHECK(says(with("Name=\"types\"", "Name=\"kinds\""), "<Cells> has no array types"));
  CHECK(says(with("<Cells>", "<Cells><DataArray Name=\"offsets\"/>"), "<Cells> has two arrays offsets"));
  CHECK(says(with("<Cells>", "<Cell/><Other>"), "</Other> is expected, not </Cells>"));
  CHECK(says(with("\"Float64\"", "\"Float16\""), "array \"Points\": the type \"Float16\" is not read"));
  CHECK(says(with("\"Float64\"", "\"String\""), "the type \"String\" is not read"));
  CHECK(says(with("\"UInt8\"", "\"Float32\""),
             "array \"types\": the type \"Float32\" is not allowed: it must be one of whole numbers"));
  CHECK(says(with("format=\"ascii\"", "format=\"hex\""), "format = \"hex\" is not allowed"));
  CHECK(says(with("format=\"ascii\"", "format=\"appended\" offset=\"0\""),
             "its data are appended, but the file has no <AppendedData>"));
  CHECK(says(with("0.5 ", "0.5x "), "array \"Points\": a number is expected, not \"0.5x\""));
  CHECK(says(with("\n12 12", "\n1.5 12"), "array \"types\": a whole number is expected, not \"1.5\""));
  // Cells.
  CHECK(says(with("12 12 12 12 12 12 12 12 1", "12 12 13 12 12 12 12 12 1"), "cell 2 of VTK's type 13 is not read"));
  CHECK(says(with("12 12 12 12 12 12 12 12 1", "12 12 10 12 12 12 12 12 1"),
             "cell 2 of VTK's type 10 has 8 nodes, not 4"));
  CHECK(says(with("12 12 12 12 12 12 12 12 1", "1 1 1 1 1 1 1 1 1"), "there are no cells of 3 dimensions"));
  CHECK(says(with("8 16 24", "8 16 14"), "the offset 14 of cell 2 is not allowed: it must lie between 16 and 65"));
  CHECK(says(with(" 65 ", " 66 "), "the offset 66 of cell 8 is not allowed"));
  CHECK(says(with(" 65 ", " 64 "), "the cells use 64 entries of the connectivity, 65 are there"));
  const std::string first = fmt::format("{} {} ", body.cells[0][0], body.cells[0][1]);
  CHECK(says(with("\n" + first, fmt::format("\n{} 27 ", body.cells[0][0])),
             "cell 0 uses node 27, but there are 27 nodes, counted from 0"));
  CHECK(says(with("\n" + first, fmt::format("\n{} -1 ", body.cells[0][0])), "cell 0 uses node -1"));
  CHECK(says(with("\n" + first, fmt::format("\n{} {} ", body.cells[0][0], body.cells[0][0])),
             "cell 0 uses a node twice"));
  CHECK(says(with("\n" + first, fmt::format("\n{} {} ", body.cells[0][1], body.cells[0][0])),
             "cell 0 is inverted or degenerate at ("));
  CHECK(says(with("0.5 ", "nan "), "has a position that is not finite"));
  CHECK(says(refused_vtu<2>(good), "does not lie in the plane z = 0"));
  // Regions.
  CHECK(says(with("Name=\"region\"", "Name=\"kind\"", {.region = "region"}),
             "has no cell array \"region\"; its cell arrays: \"kind\""));
  CHECK(says(with("Name=\"region\"", "Name=\"region\" NumberOfComponents=\"2\""),
             "array \"region\": regions must have one component"));
  CHECK(says(
      with("\"Int32\" Name=\"region\" format=\"ascii\">\n4 ", "\"Float32\" Name=\"region\" format=\"ascii\">\n4.5 "),
      "array \"region\": 4.5, the region of cell 0, is no whole number"));
  CHECK(says(refused_vtu(good, {.scale = -1.0}), "MeshOptions.scale = -1 m is not allowed"));

  // Binary data.
  VtuFile file{.encoding = VtuFile::raw};
  const std::string raw = file.write(body);
  const auto raw_with = [&](const std::string& from, const std::string& to) {
    std::string text = raw;
    text.replace(text.find(from), from.size(), to);
    return refused_vtu(text);
  };
  CHECK(refused_vtu(raw) == "accepted");
  CHECK(
      says(raw_with("encoding=\"raw\"", "encoding=\"hex\""), "encoding = \"hex\" of the appended data is not allowed"));
  CHECK(says(raw_with("   _", "   -"), "appended data must begin with \"_\""));
  CHECK(says(raw_with("offset=\"0\"", "offset=\"99999\""), "offset = 99999 is beyond the"));
  CHECK(says(raw_with("offset=\"0\"", "offset=\"8\""), "array \"Points\": "));
  CHECK(says(raw_with("Float64", "Float32"), "array \"Points\": 81 numbers are expected, 162 are there"));
  CHECK(says(raw_with("</AppendedData>", ""), "the file ends before </AppendedData>"));
  CHECK(says(refused_vtu(raw.substr(0, raw.size() - 60) + "</AppendedData></VTKFile>"), "its data end early"));
  std::string coded = VtuFile{.encoding = VtuFile::binary}.write(body);
  coded[coded.find("iAIAA") + 8] = '?';
  CHECK(says(refused_vtu(coded), "its data end early, or are no base64 where they should be"));
  const std::string packed = VtuFile{.encoding = VtuFile::raw, .block = 64}.write(body);
  CHECK(
      says(refused_vtu(packed), "it is compressed: write the file without compression, or give VtuOptions.decompress"));
  CHECK(refused_vtu(packed, {.decompress = no_compression}) == "accepted");
  CHECK(says(refused_vtu(packed, {.decompress = [](std::string_view, std::size_t) { return std::string("x"); }}),
             "its compressed data are damaged"));
  std::string other = packed;
  other.replace(other.find("vtkZLib"), 7, "vtkLZMA");
  CHECK(says(refused_vtu(other), "data compressed by \"vtkLZMADataCompressor\" are not read"));
}

TEST_CASE("Meshes whose surface is none of a body are refused") {
  const auto mesh = [](const std::vector<Point<3>>& corners, bool again = false) {
    PointCloud<3> cloud;
    for (const Point<3>& corner : corners) {
      PointCloud<3>::Cell cell;
      for (std::size_t a = 0; a < 8; ++a) {
        const Point<3> X = corner + Point<3>(static_cast<double>(a & 1), static_cast<double>(a >> 1 & 1),
                                             static_cast<double>(a >> 2 & 1));
        auto found = std::find(cloud.positions.begin(), cloud.positions.end(), X);
        if (found == cloud.positions.end()) found = cloud.positions.insert(cloud.positions.end(), X);
        cell[a] = static_cast<Index>(found - cloud.positions.begin());
      }
      cloud.cells.push_back(cell);
    }
    if (again) {  // another cell on the side that two cells share, over one of them
      PointCloud<3>::Cell cell = cloud.cells[1];
      for (const std::size_t a : {1u, 3u, 5u, 7u}) {
        cloud.positions.push_back(cloud.positions[cell[a]] + Point<3>(0.5, 0.0, 0.0));
        cell[a] = static_cast<Index>(cloud.positions.size() - 1);
      }
      cloud.cells.push_back(cell);
    }
    return refused_vtu(VtuFile{}.write(cloud));
  };
  CHECK(mesh({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}}) == "accepted");
  CHECK(says(mesh({{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}}), "the surface is not that of a body at (1, 1, 0) m"));
  CHECK(says(mesh({{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}), "the surface is not that of a body at (1, 1, 1) m"));
  CHECK(says(mesh({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, true),
             "cells 1 and 2 overlap: they stand on the same side of a face at (1, 0, 0) m"));
}

TEST_CASE("No truncation and no changed byte of a table or a VTU file is more than an error") {
  Random random(13);
  const PointCloud<3> body = box({.size = {1.0, 1.0, 1.0}, .cells = {2, 2, 2}});
  for (const auto encoding : {VtuFile::ascii, VtuFile::binary, VtuFile::raw, VtuFile::base64}) {
    VtuFile file{.encoding = encoding, .block = encoding == VtuFile::raw ? 48u : 0u};
    const VtuOptions options{.decompress = no_compression};
    const std::string good = file.write(body);
    REQUIRE(refused_vtu(good, options) == "accepted");
    for (std::size_t cut = 0; cut + 2 < good.size(); cut += 61)
      CHECK(refused_vtu(good.substr(0, cut), options) != "accepted");
    int refused = 0;
    for (int k = 0; k < 200; ++k) {
      std::string bad = good;
      bad[static_cast<std::size_t>(random.uniform() * static_cast<double>(bad.size()))] =
          static_cast<char>(256.0 * random.uniform());
      refused += refused_vtu(bad, options) != "accepted" ? 1 : 0;
    }
    CHECK(refused > 60);
  }
  const std::string good = table(lattice<3>(2), "", ";");
  int refused = 0;
  for (int k = 0; k < 300; ++k) {
    std::string bad = good;
    bad[static_cast<std::size_t>(random.uniform() * static_cast<double>(bad.size()))] =
        static_cast<char>(256.0 * random.uniform());
    refused += refused_csv(bad) != "accepted" ? 1 : 0;
  }
  CHECK(refused > 150);
}

}  // namespace input_cloud_test
