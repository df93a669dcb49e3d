// Meshes of Gmsh become clouds: text and binary files, hexahedra and simplices, regions, surfaces; the patch test on them;
// damaged and impossible files are refused with place and cause.
#include <cstring>
#include <limits>
#include <string>
#include <tuple>

#include <doctest/doctest.h>

#include <tactoid/core/random.hpp>
#include <tactoid/geometry/all.hpp>
#include <tactoid/input/all.hpp>
#include <tactoid/kernel/all.hpp>
#include <tactoid/material/modified_mooney_rivlin.hpp>
#include <tactoid/output/vtu.hpp>
#include <tactoid/quadrature/all.hpp>
#include <tactoid/simulation/body.hpp>
#include <tactoid/verify/patch_test.hpp>

#include "input_files.hpp"
#include "relative.hpp"

namespace input_test {

using namespace tactoid;
using test::Folder;
using test::says;

namespace {

/// Writes an MSH 4.1 file, text or binary, entity by entity.
struct MshWriter {
  struct Block {
    int dimension, entity, type;
    std::vector<std::vector<std::size_t>> elements;  // tags of the nodes, counted from 1
  };
  bool binary = false;
  std::vector<Vector3> nodes;
  std::vector<Block> blocks;
  std::string names;     // content of $PhysicalNames
  std::string entities;  // content of $Entities, text files only
  std::string text;

  template <class T>
  void put(T value) {
    if (!binary) {
      text += fmt::format("{} ", value);
      return;
    }
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    text.append(bytes, sizeof(T));
  }
  void line() {
    if (!binary) text.back() = '\n';
  }
  std::string str() {
    text = fmt::format("$MeshFormat\n4.1 {} 8\n", binary ? 1 : 0);
    if (binary) put(1), text += '\n';
    text += "$EndMeshFormat\n";
    if (!names.empty()) text += "$PhysicalNames\n" + names + "$EndPhysicalNames\n";
    if (!entities.empty()) text += "$Entities\n" + entities + "$EndEntities\n";
    text += "$Comments\nwhatever 1 2 3\n$EndComments\n$Nodes\n";
    for (const std::size_t n : {std::size_t{1}, nodes.size(), std::size_t{1}, nodes.size()}) put(n);
    line();
    for (const int n : {3, 1, 0}) put(n);
    put(nodes.size()), line();
    for (std::size_t i = 1; i <= nodes.size(); ++i) put(i), line();
    for (const Vector3& x : nodes) put(x[0]), put(x[1]), put(x[2]), line();
    if (binary) text += '\n';
    text += "$EndNodes\n$Elements\n";
    std::size_t total = 0, tag = 0;
    for (const Block& block : blocks) total += block.elements.size();
    for (const std::size_t n : {blocks.size(), total, std::size_t{1}, total}) put(n);
    line();
    for (const Block& block : blocks) {
      put(block.dimension), put(block.entity), put(block.type), put(block.elements.size()), line();
      for (const auto& element : block.elements) {
        put(++tag);
        for (const std::size_t node : element) put(node);
        line();
      }
    }
    if (binary) text += '\n';
    text += "$EndElements\n";
    return text;
  }
};

/// n³ jittered cubes, as hexahedra or (Kuhn) as six tetrahedra each, in units of 1 µm; n² squares where D = 2.
template <int D>
MshWriter grid(std::size_t n, bool simplices, double jitter_by = 0.15) {
  MshWriter mesh;
  Random random(3);
  const std::size_t m = n + 1, layers = D == 3 ? m : 1;
  const double h = 1.0 / static_cast<double>(n);
  for (std::size_t k = 0; k < layers; ++k)
    for (std::size_t j = 0; j < m; ++j)
      for (std::size_t i = 0; i < m; ++i) {
        Vector3 x(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        for (int c = 0; c < D; ++c)
          if (x[c] > 0.5 && x[c] < static_cast<double>(n) - 0.5) x[c] += jitter_by * random.uniform(-1.0, 1.0);
        mesh.nodes.push_back(h * x);
      }
  const auto node = [&](std::size_t i, std::size_t j, std::size_t k) { return 1 + i + m * (j + m * k); };
  MshWriter::Block block{D, 1, D == 3 ? (simplices ? 4 : 5) : (simplices ? 2 : 3), {}};
  for (std::size_t k = 0; k < (D == 3 ? n : 1); ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const auto corner = [&](std::size_t bits) { return node(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2 & 1)); };
        if (!simplices) {
          std::vector<std::size_t> loop;
          for (const std::size_t c : {0u, 1u, 3u, 2u, 4u, 5u, 7u, 6u})
            if (loop.size() < (std::size_t{1} << D)) loop.push_back(corner(c));
          block.elements.push_back(loop);
        } else if (D == 2) {
          block.elements.push_back({corner(0), corner(1), corner(3)});
          block.elements.push_back({corner(0), corner(3), corner(2)});
        } else {  // from corner 0 to corner 7 along the axes in every order
          for (const auto& [a, b, even] : {std::tuple{1, 2, true}, {2, 4, true}, {4, 1, true}, {2, 1, false}, {4, 2, false}, {1, 4, false}}) {
            const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(a | b);
            if (even) block.elements.push_back({corner(0), corner(first), corner(second), corner(7)});
            else block.elements.push_back({corner(0), corner(second), corner(first), corner(7)});
          }
        }
      }
  mesh.blocks.push_back(std::move(block));
  return mesh;
}

template <int D>
PointCloud<D> read(MshWriter mesh, const MeshOptions& options = {.scale = 1e-6}) {
  const Folder folder;
  return read_gmsh<D>(folder.write(mesh.str()), options);
}

template <int D = 3>
std::string refusal(const std::string& content, const MeshOptions& options = {}) {
  const Folder folder;
  return test::refusal([&] { return read_gmsh<D>(folder.write(content), options); });
}

template <int D>
void passes_patch_test(PointCloud<D> cloud, double support) {
  Body body{"patch", std::move(cloud), Rkpm<D>{.support = support}, NodalCentroids{}, Materials{Region{"body", ModifiedMooneyRivlin{}}}};
  Tensor3 F;
  F << 1.15, 0.10, -0.05, 0.05, 0.92, 0.10, -0.10, 0.08, 1.10;
  const PatchReport report = patch_test(body, F);
  MESSAGE(body.size() << " particles, " << static_cast<double>(body.table().pairs()) / static_cast<double>(body.table().points())
                      << " neighbours: displacement " << report.displacement_error << ", stress " << report.stress_error);
  CHECK(report.displacement_error < 1e-9);
  CHECK(report.stress_error < 1e-9);
}

}  // namespace

TEST_CASE("Hexahedra and quadrilaterals: particles, volume, surface; text and binary files give the same bits") {
  for (const bool binary : {false, true}) {
    MshWriter cubes = grid<3>(4, false), squares = grid<2>(6, false);
    cubes.binary = squares.binary = binary;
    const PointCloud<3> box = read<3>(cubes);
    CHECK(box.size() == 125);
    CHECK(box.cells.size() == 64);
    CHECK(box.facets.size() == 96);
    CHECK(box.regions == std::vector<std::string>{"body"});
    CHECK(volume(box) == test::relative(1e-18).epsilon(1e-12));
    CHECK(boundary_area(box) == test::relative(6e-12).epsilon(1e-12));
    const PointCloud<2> square = read<2>(squares);
    CHECK(square.size() == 49);
    CHECK(volume(square) == test::relative(1e-12).epsilon(1e-12));
    CHECK(boundary_area(square) == test::relative(4e-6).epsilon(1e-12));
  }
  MshWriter text = grid<3>(3, true), raw = text;
  raw.binary = true;
  CHECK(read<3>(text).positions == read<3>(raw).positions);
  // Without jitter it is the library's own box.
  const PointCloud<3> own = box({.size = {1e-6, 1e-6, 1e-6}, .cells = {4, 4, 4}}), from_file = read<3>(grid<3>(4, false, 0.0));
  REQUIRE(own.size() == from_file.size());
  for (std::size_t i = 0; i < own.size(); ++i) CHECK((own.positions[i] - from_file.positions[i]).norm() < 1e-20);
}

TEST_CASE("Simplices become quadrilaterals and hexahedra that fill them and fit together") {
  const PointCloud<3> cube = read<3>(grid<3>(3, true));
  CHECK(cube.cells.size() == 27 * 6 * 4);
  CHECK(volume(cube) == test::relative(1e-18).epsilon(1e-12));
  CHECK(boundary_area(cube) == test::relative(6e-12).epsilon(1e-12));
  CHECK(cube.facets.size() == 6 * 9 * 2 * 3);
  const PointCloud<2> square = read<2>(grid<2>(5, true));
  CHECK(square.cells.size() == 25 * 2 * 3);
  CHECK(volume(square) == test::relative(1e-12).epsilon(1e-12));
  CHECK(square.facets.size() == 4 * 5 * 2);
  // The four parts of a tetrahedron have equal volumes.
  MshWriter one;
  one.nodes = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.2, 1.1, 0.0}, {0.3, 0.1, 0.9}};
  one.blocks = {{3, 1, 4, {{1, 2, 3, 4}}}};
  const PointCloud<3> tetrahedron = read<3>(one, {});
  CHECK(tetrahedron.size() == 15);
  std::vector<double> parts(4, 0.0);
  for (const CellPoint<3>& point : gauss_points<2>(tetrahedron)) parts[point.cell] += point.weight;
  for (const double part : parts) CHECK(part == test::relative(1.0 * 1.1 * 0.9 / 24.0).epsilon(1e-12));
}

TEST_CASE("The linear patch test on meshes from files") {
  passes_patch_test(read<2>(grid<2>(6, false)), 1.75);
  passes_patch_test(read<2>(grid<2>(5, true)), 1.3);
  passes_patch_test(read<3>(grid<3>(4, false)), 1.75);
  passes_patch_test(read<3>(grid<3>(2, true)), 1.3);
  const Folder folder;
  VtuGrid vtu;
  const PointCloud<3> cubes = jitter(box({.size = {1e-6, 1e-6, 1e-6}, .cells = {4, 4, 4}}), 0.2);
  vtu.points(cubes.positions);
  vtu.cells(cubes.cells);
  vtu.write(folder.path / "box.vtu");
  passes_patch_test(read_vtu<3>(folder.path / "box.vtu"), 1.75);
  // Nodes of the meshes without their cells, and points of a ball.
  const auto table = [&]<int D>(const MshWriter& mesh, const PointCloud<D>&) {
    std::string text = "x,y,z\n";
    for (const Vector3& x : mesh.nodes) text += fmt::format("{},{},{}\n", x[0], x[1], x[2]);
    return read_csv<D>(folder.write(text), {.scale = 1e-6});
  };
  passes_patch_test(table(grid<2>(5, true), PointCloud<2>{}), 1.3);
  passes_patch_test(table(grid<3>(2, false), PointCloud<3>{}), 1.3);
  std::string text = "z;y;x\n";
  for (const Point<3>& X : jitter(ball({.radius = 1.0, .core_radius = 0.5, .core_cells = 2, .shells = 1}), 0.1).positions)
    text += fmt::format("{};{};{}\n", X[2], X[1], X[0]);
  passes_patch_test(read_csv<3>(folder.write(text), {.scale = 1e-6}), 1.3);
}

TEST_CASE("Physical groups are regions") {
  MshWriter mesh = grid<3>(2, false);
  MshWriter::Block upper = mesh.blocks[0];
  upper.entity = 7;
  upper.elements.erase(upper.elements.begin(), upper.elements.begin() + 4);
  mesh.blocks[0].elements.resize(4);
  mesh.blocks.push_back(upper);
  mesh.blocks.push_back({2, 3, 3, {{1, 2, 5, 4}}});  // a facet of the mesh: left out
  mesh.blocks.push_back({0, 1, 15, {{1}}});          // a point
  mesh.names = "2\n3 5 \"soft part\"\n2 9 \"wall\"\n";
  mesh.entities = "0 0 1 2\n3 0 0 0 1 1 0 1 9 0\n1 0 0 0 1 1 0.5 1 5 0\n7 0 0 0.5 1 1 1 2 6 5 0\n";
  const PointCloud<3> cloud = read<3>(mesh);
  CHECK(cloud.regions == std::vector<std::string>{"soft part", "group 6"});
  double lower = 0.0;
  for (const CellPoint<3>& point : gauss_points<2>(cloud))
    if (cloud.regions[point.region] == "soft part") lower += point.weight;
  CHECK(lower == test::relative(0.5e-18).epsilon(0.2));
  CHECK(cloud.cells.size() == 8);
}

TEST_CASE("Meshes that are no bodies are refused with place and cause") {
  const auto bent = [](auto change) {
    MshWriter mesh = grid<3>(2, false, 0.0);
    change(mesh);
    return refusal(mesh.str());
  };
  CHECK(bent([](MshWriter&) {}) == "accepted");
  CHECK(says(bent([](auto& m) { m.nodes[13] += Vector3(0.6, 0.6, 0.6); }), "is inverted or degenerate at ("));
  CHECK(says(bent([](auto& m) { m.nodes[4][1] = std::numeric_limits<double>::quiet_NaN(); }), "node 5 has a position that is not finite"));
  CHECK(says(bent([](auto& m) { m.blocks[0].elements.push_back(m.blocks[0].elements[2]); }), "cells 3 and 9 have the same nodes"));
  CHECK(says(bent([](auto& m) { m.blocks[0].elements[1][2] = m.blocks[0].elements[1][3]; }), "cell 2 uses a node twice"));
  CHECK(says(bent([](auto& m) { m.blocks[0].elements[1][2] = 99; }), "element 2 uses node 99, which is not there"));
  CHECK(says(bent([](auto& m) {
               m.nodes.push_back(m.nodes[13]);  // the middle again: two cells do not hold together
               m.blocks[0].elements[0][6] = m.nodes.size();
             }),
             "two nodes coincide at (0.5, 0.5, 0.5) m"));
  CHECK(says(bent([](auto& m) { m.blocks[0].type = 6; }), "elements of type 6 and dimension 3 are not read"));
  CHECK(says(bent([](auto& m) { m.blocks[0].type = 3; }), "elements of type 3 and dimension 3 are not read"));
  CHECK(says(bent([](auto& m) { m.blocks.clear(); }), "there are no cells of 3 dimensions"));
  CHECK(says(bent([](auto& m) { m.blocks.push_back({3, 1, 4, {{1, 2, 4, 10}}}); }), "simplices stand beside hexahedra"));
  CHECK(says(bent([](auto& m) { m.blocks = {{3, 1, 4, {{1, 4, 2, 10}}}}; }), "cell 1 at (0, 0, 0) m is inverted or flat"));
  CHECK(says(refusal<2>(grid<3>(2, false).str()), "does not lie in the plane z = 0"));
  CHECK(says(refusal(grid<3>(2, false).str(), {.scale = 0.0}), "MeshOptions.scale = 0 m is not allowed"));
}

TEST_CASE("Files that are damaged are refused with the line") {
  const std::string good = grid<3>(2, false, 0.0).str();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusal(text);
  };
  CHECK(says(refusal("solid body\n"), "is no MSH file"));
  CHECK(says(refusal(""), "is no MSH file"));
  CHECK(says(with("4.1 0 8", "2.2 0 8"), "MSH version 2.2 is not read: write version 4.1"));
  CHECK(says(with("4.1 0 8", "4.1 0 4"), "line 2: the format line must be"));
  CHECK(says(with("1 27 1 27", "1 27000000 1 27"), "27000000 entries are announced, more than the file can hold"));
  CHECK(says(with("1 27 1 27", "1 28 1 28"), "28 nodes are announced, 27 are there"));
  CHECK(says(with("1 27 1 27", "1 -27 1 27"), "a count or tag is expected, not \"-27\""));
  CHECK(says(with("\n0 0.5", "\n0 0.5x"), "a number is expected, not \"0.5x\""));
  CHECK(says(with("$EndNodes", "$EndNoodles"), "$EndNodes is expected here"));
  CHECK(says(with("$EndComments", "$EndCommands"), "$Comments has no $EndComments"));
  CHECK(says(with("\n2\n", "\n1\n"), "node 1 is there twice"));
  const Folder folder;
  CHECK_THROWS_WITH_AS((void)read_gmsh<3>(folder.path / "none.msh"), doctest::Contains("Cannot read \""), FileError);
  CHECK_THROWS_WITH_AS((void)read_gmsh<3>(folder.path), doctest::Contains("Cannot read \""), FileError);
}

TEST_CASE("No truncation and no changed byte is more than an error") {
  Random random(11);
  for (const bool binary : {false, true}) {
    MshWriter mesh = grid<3>(2, true);
    mesh.binary = binary;
    const std::string good = mesh.str();
    const std::size_t needed = good.size() - (binary ? 13 : 14);  // without the last line
    for (std::size_t cut = 0; cut < needed; cut += 23) CHECK(refusal(good.substr(0, cut)) != "accepted");
    int refused = 0;
    for (int k = 0; k < 300; ++k) {
      std::string bad = good;
      bad[static_cast<std::size_t>(random.uniform() * static_cast<double>(bad.size()))] = static_cast<char>(256.0 * random.uniform());
      refused += refusal(bad) != "accepted" ? 1 : 0;  // most are; a coordinate may have changed a little
    }
    CHECK(refused > 100);
  }
}

}  // namespace input_test
