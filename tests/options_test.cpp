#include <doctest/doctest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include <unistd.h>

#include <common/options.hpp>
#include <common/program.hpp>

namespace options_test {

using namespace tactoid;
namespace fs = std::filesystem;

namespace {

struct Program {
  double stiffness = 10.0, end_time = 5e-6, nucleus = 0.382, activity = -1.0;
  int frames = 10;
  std::uint64_t seed = 1;
  bool reaction = false;
  std::string out = "out", preset = "printed";
  Options options{"spreading", "A cell spreads."};

  Program() {
    options.add("stiffness", &stiffness, Range::positive(), "factor on the base substrate");
    options.add_quantity("end-time", &end_time, Quantity::time, {.min = 0.0, .max = 1e-3, .without_min = true},
                         "simulated time");
    options.add("nucleus", &nucleus, Range::inside(0.0, 1.0), "radius of the nucleus over that of the cell");
    options.add_quantity("activity", &activity, Quantity::pressure, Range::any(), "active stress");
    options.add("frames", &frames, Range::at_least(1), "pictures");
    options.add("seed", &seed, Range::any(), "random seed");
    options.add("reaction", &reaction, "reaction on the substrate");
    options.add("out", &out, "folder of the results");
    options.add_choice("preset", &preset, {"printed", "viscous/10", "elastic"}, "viscous constants");
  }

  std::string error(const std::vector<std::string>& arguments) {
    try {
      return options.parse(arguments) ? "accepted" : "printed";
    } catch (const ParameterError& failure) {
      return failure.what();
    } catch (const FileError& failure) {
      return std::string("file: ") + failure.what();
    }
  }
};

std::string error(const std::vector<std::string>& arguments) {
  return Program().error(arguments);
}

struct ConfigFile {
  fs::path path = fs::temp_directory_path() / ("tactoid_options_" + std::to_string(::getpid()) + ".toml");
  explicit ConfigFile(std::string_view text) { std::ofstream(path, std::ios::binary) << text; }
  ~ConfigFile() { fs::remove(path); }
  std::string name() const { return path.filename().string(); }
  std::vector<std::string> use() const { return {"--config", path.string()}; }
};

}  // namespace

TEST_CASE("options are read from the command line in every spelling") {
  Program p;
  CHECK(p.options.parse(std::vector<std::string>{}));
  CHECK(p.end_time == 5e-6);
  CHECK(p.options.parse({"--stiffness", "2", "--end-time=3us", "--activity", "-0.5 kPa", "--frames", "+7", "--reaction",
                         "--out", "a folder", "--preset", "viscous/10", "--seed", "18446744073709551615"}));
  CHECK(p.stiffness == 2.0);
  CHECK(p.end_time == 3e-6);
  CHECK(p.activity == -500.0);
  CHECK(p.frames == 7);
  CHECK(p.reaction);
  CHECK(p.out == "a folder");
  CHECK(p.preset == "viscous/10");
  CHECK(p.seed == std::numeric_limits<std::uint64_t>::max());
  CHECK(p.options.parse({"--no-reaction", "--out", "[a,b]", "--activity", "-3"}));
  CHECK_FALSE(p.reaction);
  CHECK(p.out == "[a,b]");
  CHECK(p.activity == -3.0);
  const char* arguments[] = {"program", "--frames", "3"};
  CHECK(p.options.parse(3, arguments));
  CHECK(p.frames == 3);
}

TEST_CASE("what is wrong on the command line is one sentence") {
  CHECK(error({"--stifness", "5"}) == "unknown option --stifness; did you mean --stiffness?");
  CHECK(error({"--stifness=5"}) == "unknown option --stifness; did you mean --stiffness?");
  CHECK(error({"--zzz"}) == "unknown option --zzz; --help lists all.");
  CHECK(error({"-x"}) == "unknown option -x; --help lists all.");
  CHECK(error({"5"}) == "unexpected argument \"5\"; every option has the form --name value.");
  CHECK(error({"--end-time", "5 parsecs"}) ==
        "--end-time: \"5 parsecs\" has an unknown unit \"parsecs\"; allowed units of time are s, ms, us, ns, ps (or a "
        "plain number in s).");
  CHECK(error({"--end-time", "-1us"}) == "--end-time = -1 us is not allowed: it must be above 0 and at most 1 ms.");
  CHECK(error({"--end-time", "0"}) == "--end-time = 0 s is not allowed: it must be above 0 and at most 1 ms.");
  CHECK(error({"--end-time", "1.1ms"}) == "--end-time = 1.1 ms is not allowed: it must be above 0 and at most 1 ms.");
  CHECK(error({"--end-time", "1ms"}) == "accepted");
  CHECK(error({"--stiffness", "nan"}) == "--stiffness: \"nan\" is not a finite number.");
  CHECK(error({"--stiffness", "0"}) == "--stiffness = 0 is not allowed: it must be positive.");
  CHECK(error({"--nucleus", "1"}) == "--nucleus = 1 is not allowed: it must be above 0 and below 1.");
  CHECK(error({"--frames", "2.5"}) == "--frames: \"2.5\" is not a whole number.");
  CHECK(error({"--frames", "1e3"}) == "--frames: \"1e3\" is not a whole number.");
  CHECK(error({"--frames", "0"}) == "--frames = 0 is not allowed: it must be at least 1.");
  CHECK(error({"--frames", "99999999999"}) == "--frames: \"99999999999\" is outside the range of numbers.");
  CHECK(error({"--seed", "-1"}) == "--seed: \"-1\" is not a whole number.");
  CHECK(error({"--preset", "elestic"}) ==
        "--preset: \"elestic\" is not one of printed, viscous/10, elastic; did you mean elastic?");
  CHECK(error({"--preset", "x"}) == "--preset: \"x\" is not one of printed, viscous/10, elastic.");
  CHECK(error({"--out", ""}) == "--out: the value is empty; a text is needed.");
  CHECK(error({"--out="}) == "--out= needs a value.");
  CHECK(error({"--frames", ""}) == "--frames: the value is empty; a whole number is needed.");
  CHECK(error({"--stiffness", ""}) == "--stiffness: the value is empty; a number is needed.");
  CHECK(error({"--out"}) == "--out needs a value.");
  CHECK(error({"--out", "--frames", "5"}) == "--out needs a value, but --frames follows.");
  CHECK(error({"--frames", "5", "--frames", "6"}) == "--frames is given twice: \"5\" and \"6\".");
  CHECK(error({"--reaction", "--no-reaction"}) == "--reaction and --no-reaction contradict each other.");
  CHECK(error({"--out", "\xff"}) == "The argument \"\\xff\" is not UTF-8.");
  CHECK(error({"--config", "/nowhere/a.toml"}) == "file: Cannot read \"/nowhere/a.toml\": No such file or directory.");
  CHECK(error({"--config", "/"}) == "file: Cannot read \"/\": Is a directory.");
}

TEST_CASE("a configuration file sets options, and the command line wins") {
  const ConfigFile file(
      "# comment\nend-time = \"2 us\" # another\nstiffness = 5\nactivity = -1e3\nout = 'C:\\x # y'\nreaction = true\n"
      "preset = \"elastic\"\nframes = 1_000\n");
  Program p;
  CHECK(p.options.parse({"--stiffness", "7", "--config", file.path.string(), "--no-reaction"}));
  CHECK(p.end_time == 2e-6);
  CHECK(p.stiffness == 7.0);
  CHECK(p.activity == -1000.0);
  CHECK(p.out == "C:\\x # y");
  CHECK(p.preset == "elastic");
  CHECK(p.frames == 1000);
  CHECK_FALSE(p.reaction);
}

TEST_CASE("what is wrong in a configuration file is one sentence with its place") {
  const auto in_file = [](std::string_view text) {
    const ConfigFile file(text);
    std::string message = error(file.use());
    for (std::size_t at; (at = message.find(file.name())) != std::string::npos;)
      message.replace(at, file.name().size(), "F");
    return message;
  };
  CHECK(in_file("stifness = 5\n") == "F: unknown key \"stifness\"; did you mean stiffness?");
  CHECK(in_file("config = 'x'\n") == "F: unknown key \"config\"; --help lists all options.");
  CHECK(in_file("end-time = '5 parsecs'\n").starts_with("F: end-time: \"5 parsecs\" has an unknown unit"));
  CHECK(in_file("end-time = nan\n") == "F: end-time: \"nan\" is not a finite number with a unit of time.");
  CHECK(in_file("end-time = true\n") == "F: end-time: true is not allowed: it must be a number.");
  CHECK(in_file("reaction = 'yes'\n") == "F: reaction: yes is not allowed: it must be true or false.");
  CHECK(in_file("out = 5\n") == "F: out: 5 is a number, but a text in quotes is needed.");
  CHECK(in_file("frames = 2.5\n") == "F: frames: \"2.5\" is not a whole number.");
  CHECK(in_file("\n[cell]\nx = 1\n") ==
        "F, line 2: \"cell\" is a section, but only numbers, texts and truth values are allowed.");
  CHECK(in_file("frames = [1]\n") ==
        "F, line 1: \"frames\" is an array, but only numbers, texts and truth values are allowed.");
  CHECK(in_file("frames = 1\nframes = 2\n").starts_with("F, line 2: "));
  CHECK(in_file("frames 1\n").starts_with("F, line 1: "));
  CHECK(in_file("out = \"\xff\"\n").starts_with("F, line 1: "));
  CHECK(in_file("") == "accepted");
  CHECK(error({"--config", ""}) == "--config: the value is empty; a text is needed.");
  CHECK(error({"--config", "a", "--config", "b"}) == "--config is given twice: \"a\" and \"b\".");
}

TEST_CASE("the written parameters are a configuration that gives the same run") {
  Program p;
  CHECK(p.options.parse({"--end-time", "1.2345678901234567us", "--nucleus", "0.1", "--activity", "-3e-20", "--out",
                         "a \"b\"\t\\ é", "--preset", "viscous/10", "--reaction", "--frames", "3"}));
  const std::string text = p.options.toml();
  CHECK(text.find("\n# simulated time, s; above 0 and at most 1 ms\nend-time = 1.2345678901234567e-06\n") !=
        std::string::npos);
  const ConfigFile file("");
  p.options.write_toml(file.path);
  Program q;
  CHECK(q.options.parse(file.use()));
  CHECK(q.end_time == p.end_time);
  CHECK(q.nucleus == 0.1);
  CHECK(q.activity == -3e-20);
  CHECK(q.out == "a \"b\"\t\\ é");
  CHECK(q.preset == "viscous/10");
  CHECK(q.reaction);
  CHECK(q.frames == 3);
  CHECK(q.stiffness == 10.0);
  CHECK(q.options.toml() == text);
}

TEST_CASE("help and information end the program without an error") {
  CHECK(error({"--help"}) == "printed");
  CHECK(error({"--info"}) == "printed");
  const std::string info = info_text();
  CHECK(info.starts_with(std::string("Tactoid    ") + version));
  for (const char* name :
       {"\ncompiler   ", "\nEigen      3", "\nnanoflann  1.", "\nfmt        ", "\nCLI11      ", "\ntoml++     3"})
    CHECK_MESSAGE(info.find(name) != std::string::npos, name);
}

TEST_CASE("ranges say what they allow") {
  CHECK(Range::any().text() == "");
  CHECK(Range::between(0.0, 2.0).text() == "between 0 and 2");
  CHECK(Range::non_negative().text() == "zero or positive");
  CHECK(Range{.max = 3.0, .without_max = true}.text() == "below 3");
  CHECK(Range::between(1e-9, 5e-6).text(Quantity::length) == "between 1 nm and 5 um");
  CHECK(Range::inside(0.0, 1.0).contains(0.5));
  CHECK_FALSE(Range::inside(0.0, 1.0).contains(0.0));
  CHECK_FALSE(Range::inside(0.0, 1.0).contains(1.0));
  CHECK(Range::between(0.0, 1.0).contains(0.0));
  CHECK(Range::between(0.0, 1.0).contains(1.0));
  CHECK_FALSE(Range::any().contains(std::numeric_limits<double>::quiet_NaN()));
}

TEST_CASE("the nearest name") {
  CHECK(edit_distance("kitten", "sitting") == 3);
  CHECK(edit_distance("ab", "ba") == 1);
  CHECK(edit_distance("", "abc") == 3);
  CHECK(nearest_name("--ouput", {"--out", "--output"}) == "--output");
  CHECK(nearest_name("xyz", {"--out", "abc"}).empty());
}

TEST_CASE("a program ends with the status of its failure") {
  CHECK(run_program("p", [] { return 0; }) == 0);
  CHECK(run_program("p", []() -> int { throw ParameterError("parameter"); }) == 2);
  CHECK(run_program("p", []() -> int { throw GeometryError("geometry"); }) == 2);
  CHECK(run_program("p", []() -> int { throw FileError("file"); }) == 2);
  CHECK(run_program("p", []() -> int { throw ComputationError("computation"); }) == 3);
  CHECK(run_program("p", []() -> int { throw std::bad_alloc(); }) == 3);
}

}  // namespace options_test
