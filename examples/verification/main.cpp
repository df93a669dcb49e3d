// Every term of the equations against exact solutions, orders of convergence and theory. See README.md beside this
// file.
//
//   verification --out out/verification            all studies, under 40 minutes on two cores
//   verification --fast --study kernel             the part of one study that the tests run
#include <chrono>
#include <cmath>

#include <tactoid/core/parallel.hpp>
#include <tactoid/output/file.hpp>

#include "common/options.hpp"
#include "common/program.hpp"
#include "studies.hpp"

using namespace tactoid;
using namespace tactoid::verification;

namespace {

std::string markdown(const std::vector<Report>& reports) {
  std::string text = "| study | what | measured | expected | error | |\n|---|---|---|---|---|---|\n";
  for (const Report& report : reports)
    for (const Report::Line& line : report.lines()) {
      using Kind = Report::Line::Kind;
      const bool bound = line.kind == Kind::at_most || line.kind == Kind::at_least;
      const bool none = bound || std::isnan(line.reference);
      const std::string expected = bound
                                       ? fmt::format("{} {:.4g}", line.kind == Kind::at_most ? "≤" : "≥", line.allowed)
                                   : none ? ""
                                          : fmt::format("{:.5g}", line.reference);
      const std::string error = none ? "" : fmt::format("{:.2g}", line.error);
      text += fmt::format("| {} | {}; {} | {:.5g} | {} | {} | {} |\n", line.study, line.quantity, line.source,
                          line.value, expected, error,
                          line.kind == Kind::note ? "reported"
                          : line.passed           ? "pass"
                                                  : "**fail**");
    }
  return text;
}

std::string comma_separated(const std::vector<Report>& reports) {
  const auto quoted = [](std::string text) {
    for (std::size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) text.insert(i, 1, '"');
    return '"' + text + '"';
  };
  std::string text = "study,quantity,value,kind,reference,error,allowed,passed,source\n";
  constexpr std::array kinds{"compare", "at most", "at least", "reported"};
  for (const Report& report : reports)
    for (const Report::Line& line : report.lines())
      text += fmt::format("{},{},{},{},{},{},{},{},{}\n", line.study, quoted(line.quantity), line.value,
                          kinds[static_cast<std::size_t>(line.kind)], line.reference, line.error, line.allowed,
                          line.passed ? 1 : 0, quoted(line.source));
  return text;
}

int run(int argc, char** argv) {
  std::string out = "out/verification", chosen = "all";
  int threads = thread_count();
  bool fast = false;
  std::vector<std::string> names{"all"};
  for (const Study& study : studies) names.emplace_back(study.name);
  Options options("verification", "Compares every term of the equations with exact solutions and theory.");
  options.add("out", &out, "Folder of the results");
  options.add("threads", &threads, Range::between(1, 1024), "Threads");
  options.add("fast", &fast, "Only what the tests run");
  options.add_choice("study", &chosen, names, "The study to run");
  if (!options.parse(argc, argv)) return 0;
  set_thread_count(threads);
  prepare_folder(out);
  options.write_toml(std::filesystem::path(out) / "parameters.toml");

  std::vector<Report> reports;
  std::string failed;
  for (const Study& study : studies) {
    if (chosen != "all" && chosen != study.name) continue;
    fmt::print("{}: {}\n", study.name, study.purpose);
    const auto start = std::chrono::steady_clock::now();
    Report& report = reports.emplace_back(std::string(study.name), out);
    try {
      study.run(report, fast ? Level::fast : Level::full);
    } catch (const Error& error) {  // the other studies go on
      report.at_most(fmt::format("errors: {}", error.what()), 1.0, 0.0, "a study must end");
    }
    if (!report.passed()) failed += fmt::format(" {}", study.name);
    fmt::print("  {:.1f} s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    // After every study: what is computed is not lost.
    write_file(std::filesystem::path(out) / "table.csv", comma_separated(reports));
    write_file(std::filesystem::path(out) / "table.md", markdown(reports));
  }
  fmt::print("{} studies, {}\n", reports.size(), failed.empty() ? "all passed" : "FAILED:" + failed);
  return failed.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program("verification", [&] { return run(argc, argv); });
}
