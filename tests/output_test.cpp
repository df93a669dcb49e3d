#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

#include <tactoid/output/all.hpp>

namespace output_test {

using namespace tactoid;
namespace fs = std::filesystem;

namespace {

/// A folder of its own for each test, gone at its end.
struct Scratch {
  fs::path path;
  Scratch() {
    static int count = 0;
    path = fs::temp_directory_path() / ("tactoid_output_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    fs::create_directories(path);
  }
  ~Scratch() { fs::remove_all(path); }
};

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::size_t count_files(const fs::path& folder) {
  std::size_t n = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++n;
  return n;
}

/// The appended block of the array `name`, found as a reader finds it: by its offset in the head.
template <class T>
std::vector<T> block(const std::string& text, const std::string& name) {
  const std::size_t place = text.find("Name=\"" + name + "\"");
  REQUIRE(place != std::string::npos);
  const std::size_t offset = text.find("offset=\"", place) + 8;
  const std::size_t data = text.find("<AppendedData encoding=\"raw\">\n_") + 31 + std::stoul(text.substr(offset));
  std::uint64_t size = 0;
  std::memcpy(&size, text.data() + data, sizeof size);
  std::vector<T> values(size / sizeof(T));
  if (size > 0) std::memcpy(values.data(), text.data() + data + sizeof size, size);
  return values;
}

template <class Exception, class Function>
std::string message(const Function& function) {
  try {
    function();
  } catch (const Exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace

TEST_CASE("a grid keeps points, mixed cells in VTK's order, and data to the bit") {
  const Scratch scratch;
  std::vector<Vector4> points;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) points.push_back(Vector4(i, j + 1.0 / 3.0, k, 77.0));
  const std::vector<std::array<Index, 8>> hexahedra{{0, 1, 2, 3, 4, 5, 6, 7}};
  const std::vector<std::array<Index, 4>> facets{{0, 1, 2, 3}};
  const std::vector<std::array<Index, 2>> lines{{6, 7}};
  VtuGrid grid(0.1 + 0.2);
  grid.points(points);
  grid.cells(hexahedra);
  grid.cells(facets, 4);
  grid.cells(lines);
  grid.vertices(2, 3);
  CHECK(grid.cell_count() == 5);
  std::vector<double> pressure(8);
  for (std::size_t i = 0; i < 8; ++i) pressure[i] = std::sin(double(i));
  pressure[3] = std::numeric_limits<double>::quiet_NaN();
  std::vector<Tensor3> stress(8, Tensor3::Zero());
  stress[2](0, 1) = 5.0;
  grid.point_data("pressure", pressure);
  grid.point_data("displacement", points);
  grid.point_data("stress", stress);
  grid.point_data("uv", std::vector<float>(16, 0.5f), 2);
  grid.cell_data("region", std::vector<std::int32_t>{1, 2, 3, 4, 5});
  grid.write(scratch.path / "a.vtu");
  CHECK(count_files(scratch.path) == 1);

  const std::string text = read(scratch.path / "a.vtu");
  CHECK(text.find(">0.30000000000000004</DataArray>") != std::string::npos);
  CHECK(text.find("NumberOfPoints=\"8\" NumberOfCells=\"5\"") != std::string::npos);
  const auto xyz = block<double>(text, "Points");
  REQUIRE(xyz.size() == 24);
  CHECK(xyz[4 * 3 + 1] == 1.0 / 3.0);
  CHECK(xyz[4 * 3 + 2] == 1.0);
  CHECK(block<std::int64_t>(text, "connectivity") ==
        std::vector<std::int64_t>{0, 1, 3, 2, 4, 5, 7, 6, 4, 5, 7, 6, 6, 7, 3, 4});
  CHECK(block<std::int64_t>(text, "offsets") == std::vector<std::int64_t>{8, 12, 14, 15, 16});
  CHECK(block<std::uint8_t>(text, "types") == std::vector<std::uint8_t>{12, 9, 3, 1, 1});
  const auto read_pressure = block<double>(text, "pressure");
  CHECK(std::memcmp(read_pressure.data(), pressure.data(), 64) == 0);
  CHECK(block<double>(text, "displacement") == xyz);
  const auto read_stress = block<double>(text, "stress");
  CHECK(read_stress.size() == 72);
  CHECK(read_stress[2 * 9 + 1] == 5.0);  // by rows
  CHECK(read_stress[2 * 9 + 3] == 0.0);
  CHECK(text.find("Name=\"uv\" NumberOfComponents=\"2\"") != std::string::npos);
  CHECK(block<std::int32_t>(text, "region") == std::vector<std::int32_t>{1, 2, 3, 4, 5});
}

TEST_CASE("points of two dimensions and an empty grid") {
  const Scratch scratch;
  VtuGrid plane;
  plane.points(std::vector<Point<2>>{Point<2>(1.0, 2.0)});
  plane.point_data("velocity", std::vector<Point<2>>{Point<2>(3.0, 4.0)});
  plane.write(scratch.path / "plane.vtu");
  CHECK(block<double>(read(scratch.path / "plane.vtu"), "Points") == std::vector<double>{1.0, 2.0, 0.0});
  CHECK(block<double>(read(scratch.path / "plane.vtu"), "velocity") == std::vector<double>{3.0, 4.0, 0.0});
  VtuGrid().write(scratch.path / "empty.vtu");
  CHECK(block<double>(read(scratch.path / "empty.vtu"), "Points").empty());
}

TEST_CASE("what does not fit the grid is refused before a file exists") {
  const Scratch scratch;
  const auto attempt = [&](auto&& change) {
    VtuGrid grid;
    grid.points(std::vector<Vector4>(3, Vector4::Zero()));
    grid.vertices(3);
    change(grid);
    return message<ParameterError>([&] { grid.write(scratch.path / "a.vtu"); });
  };
  CHECK(attempt([](VtuGrid& g) { g.point_data("p", std::vector<double>(2)); }) ==
        "VtuGrid: the array p of 1 component(s) has 2 entries, but there are 3 points.");
  CHECK(attempt([](VtuGrid& g) { g.cell_data("p", std::vector<float>(4)); }) ==
        "VtuGrid: the array p of 1 component(s) has 4 entries, but there are 3 cells.");
  CHECK(attempt([](VtuGrid& g) { g.point_data("p", std::vector<double>(7), 2); }) != "nothing was thrown");
  CHECK(attempt([](VtuGrid& g) { g.point_data("a\"b", std::vector<double>(3)); }) != "nothing was thrown");
  CHECK(attempt([](VtuGrid& g) { g.vertices(1, 3); }) == "VtuGrid: a cell names point 3, but there are 3 points.");
  CHECK(attempt([](VtuGrid& g) {
          g.point_data("p", std::vector<double>(3));
          g.point_data("p", std::vector<double>(3));
        }) == "VtuGrid: two arrays of the points have the name p.");
  CHECK(count_files(scratch.path) == 0);
}

TEST_CASE("failures name the path and the system's reason, and leave nothing half-written") {
  const Scratch scratch;
  CHECK(message<FileError>([&] { VtuGrid().write(scratch.path / "no" / "a.vtu"); }) ==
        "Cannot write \"" + (scratch.path / "no" / "a.vtu").string() + "\": No such file or directory.");
  std::ofstream(scratch.path / "file") << "x";
  CHECK(message<FileError>([&] { prepare_folder(scratch.path / "file" / "sub"); }) ==
        "Cannot make the folder \"" + (scratch.path / "file" / "sub").string() + "\": Not a directory.");
  CHECK(message<FileError>([&] { prepare_folder(scratch.path / "file"); }) != "nothing was thrown");
  CHECK(message<FileError>([&] { prepare_folder(""); }) != "nothing was thrown");
  prepare_folder(scratch.path / "new" / "folder");
  prepare_folder(scratch.path / "new" / "folder");
  CHECK(fs::is_directory(scratch.path / "new" / "folder"));
  if (::geteuid() != 0) {
    fs::permissions(scratch.path / "new", fs::perms::owner_read | fs::perms::owner_exec);
    CHECK(message<FileError>([&] { prepare_folder(scratch.path / "new"); }) ==
          "Cannot write in the folder \"" + (scratch.path / "new").string() + "\": Permission denied.");
    fs::permissions(scratch.path / "new", fs::perms::owner_all);
  }
  CHECK(message<FileError>([&] { HistoryWriter(scratch.path / "no" / "h.csv", {"time"}); }) != "nothing was thrown");

  // An earlier file survives a write that is given up.
  write_file(scratch.path / "kept", "old");
  {
    AtomicFile file(scratch.path / "kept");
    file.write("new");
  }
  CHECK(read(scratch.path / "kept") == "old");
  CHECK_FALSE(fs::exists(scratch.path / "kept.part"));

  if (fs::exists("/dev/full")) {  // a disc that is always full
    fs::create_symlink("/dev/full", scratch.path / "full.vtu.part");
    CHECK(message<FileError>([&] { VtuGrid().write(scratch.path / "full.vtu"); }) ==
          "Cannot write \"" + (scratch.path / "full.vtu").string() + "\": No space left on device.");
    CHECK_FALSE(fs::exists(scratch.path / "full.vtu"));
    CHECK_FALSE(fs::exists(scratch.path / "full.vtu.part"));
    CHECK(message<FileError>([] { HistoryWriter("/dev/full", {"time"}); }) ==
          "Cannot write \"/dev/full\": No space left on device.");
  }
}

TEST_CASE("a series can be read after each frame") {
  const Scratch scratch;
  PvdSeries series(scratch.path / "fields.pvd");
  series.add(0.0, "fields/cell_0000.vtu", "cell");
  const std::string first = read(scratch.path / "fields.pvd");
  CHECK(first.ends_with("</Collection>\n</VTKFile>\n"));
  series.add(0.0, "fields/substrate_0000.vtu", "substrate");
  series.add(1e-7, "fields/a&b.vtu", "cell");
  CHECK(read(scratch.path / "fields.pvd") ==
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n"
        "<DataSet timestep=\"0\" part=\"0\" name=\"cell\" file=\"fields/cell_0000.vtu\"/>\n"
        "<DataSet timestep=\"0\" part=\"1\" name=\"substrate\" file=\"fields/substrate_0000.vtu\"/>\n"
        "<DataSet timestep=\"1e-07\" part=\"0\" name=\"cell\" file=\"fields/a&amp;b.vtu\"/>\n"
        "</Collection>\n</VTKFile>\n");
  CHECK(count_files(scratch.path) == 1);
}

TEST_CASE("a history is on the disc line by line, at full precision") {
  const Scratch scratch;
  HistoryWriter history(scratch.path / "h.csv", {"time", "area"});
  CHECK(read(scratch.path / "h.csv") == "time,area\n");
  history.write(std::vector<double>{0.1, 1.0 / 3.0});
  CHECK(read(scratch.path / "h.csv") == "time,area\n0.1,0.3333333333333333\n");
  history.write(std::vector<double>{2.0, std::numeric_limits<double>::quiet_NaN()});
  CHECK(read(scratch.path / "h.csv").ends_with("\n2,nan\n"));
  CHECK(message<ParameterError>([&] { history.write(std::vector<double>{1.0}); }) ==
        "HistoryWriter: 1 values were given for the 2 columns of \"" + (scratch.path / "h.csv").string() + "\".");
  CHECK(message<ParameterError>([&] { HistoryWriter(scratch.path / "b.csv", {"a", "a"}); }) ==
        "HistoryWriter: two columns have the name \"a\".");
  CHECK(message<ParameterError>([&] { HistoryWriter(scratch.path / "b.csv", {"a,b"}); }) != "nothing was thrown");
  CHECK_FALSE(fs::exists(scratch.path / "b.csv"));
}

TEST_CASE("a history and a series are continued behind a time") {
  const Scratch scratch;
  const fs::path csv = scratch.path / "h.csv", pvd = scratch.path / "fields.pvd";
  {
    HistoryWriter history(csv, {"time", "area"});
    PvdSeries series(pvd);
    for (const double t : {0.1, 0.2, 0.3}) {
      history.write(std::vector<double>{t, 1.0});
      series.add(t, "a.vtu", "a");
      series.add(t, "b.vtu", "b");
    }
  }
  const std::string lines = read(csv), frames = read(pvd);
  std::ofstream(csv, std::ios::app) << "0.4,1";  // cut off
  {
    HistoryWriter history(csv, {"time", "area"}, 0.2);
    CHECK(read(csv) == "time,area\n0.1,1\n0.2,1\n");
    PvdSeries series(pvd);
    series.keep_until(0.2);
    history.write(std::vector<double>{0.3, 1.0});
    series.add(0.3, "a.vtu", "a");
    series.add(0.3, "b.vtu", "b");
  }
  CHECK(read(csv) == lines);
  CHECK(read(pvd) == frames);
  CHECK(message<ParameterError>([&] { HistoryWriter(csv, {"time", "radius"}, 0.2); }) ==
        "HistoryWriter: \"" + csv.string() + "\" has other columns, and cannot be continued.");
  CHECK(read(csv) == lines);
  // The time may be another column.
  const fs::path curve = scratch.path / "curve.csv";
  {
    HistoryWriter history(curve, {"force", "time", "area"});
    for (const double t : {0.1, 0.2, 0.3}) history.write(std::vector<double>{1.0 - t, t, 2.0});
  }
  { const HistoryWriter history(curve, {"force", "time", "area"}, 0.2, "time"); }
  CHECK(read(curve) == "force,time,area\n0.9,0.1,2\n0.8,0.2,2\n");
  { const HistoryWriter history(curve, {"force", "time", "area"}, 1.5, "area"); }
  CHECK(read(curve) == "force,time,area\n");
  CHECK(message<ParameterError>([&] { HistoryWriter(curve, {"force", "time", "area"}, 0.2, "times"); }) ==
        "HistoryWriter: \"times\" is no column of \"" + curve.string() + "\".");
  const HistoryWriter none(scratch.path / "new.csv", {"time"}, 0.2);
  CHECK(read(scratch.path / "new.csv") == "time\n");
}

TEST_CASE("a summary is JSON, in the order of its keys") {
  const Scratch scratch;
  Summary summary;
  summary.set("time", 5e-6)
      .set("steps", 12345678901L)
      .set("ok", true)
      .set("text",
           "a\"\\\n\xff"
           "é");
  summary.set("nan", std::numeric_limits<double>::quiet_NaN()).set("inf", -std::numeric_limits<double>::infinity());
  summary.set("array", std::vector<double>{1.0, 0.1})
      .set("none", std::vector<int>{})
      .set("flags", std::vector<bool>{true, false});
  summary.set("part", Summary().set("x", 1u).set("y", std::string("z")));
  summary.set("time", 6e-6);
  summary.write(scratch.path / "s.json");
  CHECK(read(scratch.path / "s.json") ==
        "{\n  \"time\": 6e-06,\n  \"steps\": 12345678901,\n  \"ok\": true,\n"
        "  \"text\": \"a\\\"\\\\\\u000a\xEF\xBF\xBDé\",\n  \"nan\": null,\n  \"inf\": null,\n"
        "  \"array\": [1, 0.1],\n  \"none\": [],\n  \"flags\": [true, false],\n"
        "  \"part\": {\n    \"x\": 1,\n    \"y\": \"z\"\n  }\n}\n");
  CHECK(Summary().json() == "{}");
}

TEST_CASE("the progress line is for terminals") {
  const Scratch scratch;
  const auto written = [&](bool terminal, int updates) {
    const fs::path path = scratch.path / "progress";
    std::FILE* stream = std::fopen(path.c_str(), "wb");
    {
      Progress progress(1e-6, 0.0, stream, terminal);
      for (int i = 1; i <= updates; ++i) progress.update(1e-8, 10);
      if (updates > 0) progress.update(1e-6, 1000);
    }
    std::fclose(stream);
    return read(path);
  };
  CHECK(written(false, 100).empty());
  CHECK(written(true, 0).empty());
  const std::string text = written(true, 100000);  // well below a fifth of a second per line
  CHECK(text.starts_with("\r  1.0 %  10 ns of 1 us  "));
  CHECK(text.find("\r100.0 %  1 us of 1 us  ") != std::string::npos);
  CHECK(std::count(text.begin(), text.end(), '\r') <= 10);
  CHECK(std::count(text.begin(), text.end(), '\n') == 1);
  CHECK(text.back() == '\n');

  const Progress progress(5e-6, 1e-6, stderr, false);
  CHECK(progress.line(2e-6, 1000, 10.0) == " 25.0 %  2 us of 5 us  100 steps/s  0:30 to go");
  CHECK(progress.line(1e-6, 0, 0.0) == "  0.0 %  1 us of 5 us  0.0 steps/s");
  CHECK(progress.line(2e-6, 5, 3600.0) == " 25.0 %  2 us of 5 us  0.0 steps/s  3:00:00 to go");
}

}  // namespace output_test
