#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactoid/tactoid.hpp>

namespace tactoid {

/// The frames of a run for ParaView: fields.pvd in its folder, and a file per body and frame in fields/.
class FrameSeries {
 public:
  /// `names` of the files of the bodies. Removes the frames of a former run; or, with `resumed_at` (s, as the times of the
  /// frames), goes on with those that are there, and awaits its state. Throws FileError.
  FrameSeries(std::filesystem::path folder, std::vector<std::string> names, std::optional<double> resumed_at = {})
      : folder_(std::move(folder)), names_(std::move(names)), series_(folder_ / "fields.pvd") {
    prepare_folder(folder_ / "fields");
    if (!is_first_rank()) return;
    if (resumed_at) series_.keep_until(*resumed_at);
    else remove_old();
  }

  template <class Archive>
  void state(Archive& archive) {
    archive("frame", frame_);
  }

  /// Begins the next frame, which add() fills.
  void next() { ++frame_; }
  /// A body in it, by the number of its name. Throws FileError.
  template <class Body>
  void add(std::size_t name, Body& body, const ParticleFields& fields, double time, std::span<const double> gaps = {}) {
    const std::string file = fmt::format("fields/{}_{:04d}.vtu", names_[name], frame_ - 1);
    write_body_frame(folder_ / file, body, fields, stress_fields(body), time, gaps);
    series_.add(time, file, body.name());
  }

 private:
  void remove_old() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "fields")) {
      const std::string file = entry.path().filename().string();
      const std::size_t line = file.rfind('_'), dot = file.rfind(".vtu");
      if (line == std::string::npos || dot == std::string::npos || dot + 4 != file.size() || line + 1 >= dot) continue;
      if (std::find(names_.begin(), names_.end(), file.substr(0, line)) == names_.end()) continue;
      if (file.find_first_not_of("0123456789", line + 1) == dot) std::filesystem::remove(entry.path());
    }
  }

  std::filesystem::path folder_;
  std::vector<std::string> names_;
  PvdSeries series_;
  int frame_ = 0;  // frames that were begun
};

}  // namespace tactoid
