// Checkpoints: what is written is what is read, and what is damaged is refused with a sentence.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include <tactoid/output/checkpoint.hpp>

namespace output_checkpoint_test {

using namespace tactoid;

namespace {

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / ("checkpoint_test_" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directory(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

Checkpoint sample() {
  Checkpoint c{"program", "end-time = 1e-06\n", {}};
  c.state["simulation/time"] = {{}, {1.5e-6}, false};
  c.state["simulation/steps"] = {{}, {9007199254740992.0}, true};
  c.state["simulation/cell/displacement"] = {{2, 4}, {1.0, -0.0, 3.0, 5e-324, 5.0, 6.0, 7.0, std::numeric_limits<double>::infinity()}, false};
  c.state["simulation/cell/anchored"] = {{0}, {}, true};
  for (int k = 0; k < 50; ++k) {
    StateArray list{{100}, std::vector<double>(100), false};
    for (std::size_t i = 0; i < 100; ++i) list.values[i] = std::sin(static_cast<double>(i) + k);
    c.state["simulation/contact_" + std::to_string(k) + "/list"] = list;
  }
  return c;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
void put(const std::filesystem::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace

TEST_CASE("A checkpoint is read as it was written, to the bit") {
  const Folder folder;
  const auto path = folder.path / "run.h5";
  write_checkpoint(path, sample());
  const Checkpoint read = read_checkpoint(path);
  CHECK(read.program == "program");
  CHECK(read.parameters == "end-time = 1e-06\n");
  CHECK(read.state == sample().state);
  CHECK(std::signbit(read.state.at("simulation/cell/displacement").values[1]));
  CHECK(bytes_of(path).starts_with("Tactoid checkpoint, format 2\n"));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("Damaged, foreign and newer checkpoints are refused in one sentence") {
  const Folder folder;
  const auto path = folder.path / "run.h5";
  write_checkpoint(path, sample());
  const std::string whole = bytes_of(path);
  REQUIRE(whole.size() > 40000);
  const auto refused = [&](const std::string& bytes, const char* why) {
    put(path, bytes);
    CHECK_THROWS_WITH_AS((void)read_checkpoint(path), doctest::Contains(why), FileError);
  };
  for (std::size_t size = 1024; size < whole.size(); size += 1024) refused(whole.substr(0, size), "damaged checkpoint");
  refused(whole + "x", "damaged checkpoint");
  for (std::size_t at = 40; at < whole.size(); at += 97) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    refused(bytes, "damaged checkpoint");
  }
  refused("", "is no checkpoint of Tactoid");
  refused("\211HDF\r\n\032\n" + whole.substr(520), "is no checkpoint of Tactoid");
  std::string newer = whole;
  newer.replace(newer.find("format 2"), 8, "format 3");
  refused(newer, "is a checkpoint of format \"3\", but this version of Tactoid");
  CHECK_THROWS_WITH_AS((void)read_checkpoint(folder.path / "none.h5"), doctest::Contains("Cannot read"), FileError);
  CHECK_THROWS_AS((void)read_checkpoint(folder.path), FileError);
  // What has the right head, and is no HDF5 inside.
  refused(detail::checkpoint_head(detail::block_hash("nonsense")) + "nonsense", "that HDF5 cannot read");
}

TEST_CASE("A checkpoint that cannot be written leaves the former one") {
  const Folder folder;
  const auto path = folder.path / "run.h5";
  write_checkpoint(path, sample());
  const std::string before = bytes_of(path);
  std::filesystem::create_directory(path.string() + ".part");  // where the new one would be made
  Checkpoint other = sample();
  other.program = "another";
  CHECK_THROWS_WITH_AS(write_checkpoint(path, other), doctest::Contains("Cannot write"), FileError);
  CHECK(bytes_of(path) == before);
  CHECK_THROWS_AS(write_checkpoint(folder.path / "nowhere" / "run.h5", other), FileError);
}

}  // namespace output_checkpoint_test
