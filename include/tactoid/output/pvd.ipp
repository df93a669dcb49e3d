#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/output/pvd.hpp>

namespace tactoid {

TACTOID_INLINE void PvdSeries::keep_until(double time) {
  std::ifstream file(path_);
  const std::string mark = "<DataSet timestep=\"";
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(mark)) continue;
    double at = 0.0;
    if (std::from_chars(line.data() + mark.size(), line.data() + line.size(), at).ec != std::errc{} || at > time) continue;
    entries_ += line + '\n';
    (void)part_number(at);
  }
}

TACTOID_INLINE void PvdSeries::add(double time, std::string_view file, std::string_view part) {
  const std::size_t before = entries_.size();
  entries_ += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n", time, part_number(time),
                          escaped(part), escaped(file));
  try {
    write_file(path_, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n" +
                          entries_ + "</Collection>\n</VTKFile>\n");
  } catch (...) {
    entries_.resize(before);
    throw;
  }
}

TACTOID_INLINE std::string PvdSeries::escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

}  // namespace tactoid
