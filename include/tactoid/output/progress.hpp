#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <unistd.h>

#include <fmt/format.h>

#include <tactoid/core/quantity.hpp>
#include <tactoid/core/ranks.hpp>

namespace tactoid {

/// One line on the terminal that says how far a run is: fraction, simulated time, steps per second, time to go.
/// Where the error output is no terminal, and on all of several processes but the first, it stays silent. update() may be called in every step: it looks at the clock,
/// and writes at most five times per second.
class Progress {
 public:
  using Clock = std::chrono::steady_clock;  ///< of the time to go

  /// `total` and `start`: simulated times of the end and of the beginning, s.
  explicit Progress(double total, double start = 0.0, std::FILE* stream = stderr)
      : Progress(total, start, stream, is_first_rank() && ::isatty(::fileno(stream)) == 1) {}
  /// With the caller's word on whether `stream` is a terminal.
  Progress(double total, double start, std::FILE* stream, bool terminal)
      : total_(total), start_(start), stream_(stream), terminal_(terminal), begun_(Clock::now()) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { finish(); }

  /// The run stands at simulated time `time` (s), after `steps` steps since its beginning.
  void update(double time, std::uint64_t steps) {
    if (!terminal_ || finished_) return;
    const Clock::time_point now = Clock::now();
    if (shown_ && now - last_ < std::chrono::milliseconds(200) && time < total_) return;
    last_ = now;
    shown_ = true;
    show(line(time, steps, std::chrono::duration<double>(now - begun_).count()));
  }

  /// Leaves the line as it stands and goes to the next one.
  void finish() {
    if (terminal_ && shown_ && !finished_) {
      std::fputc('\n', stream_);
      std::fflush(stream_);
    }
    finished_ = true;
  }

  /// The text of the line after `seconds` of computing.
  [[nodiscard]] std::string line(double time, std::uint64_t steps, double seconds) const {
    const double fraction = total_ > start_ ? std::clamp((time - start_) / (total_ - start_), 0.0, 1.0) : 1.0;
    const double rate = seconds > 0.0 ? static_cast<double>(steps) / seconds : 0.0;
    std::string text =
        fmt::format("{:5.1f} %  {} of {}  {:.{}f} steps/s", 100.0 * fraction, format_quantity(time, Quantity::time, 4),
                    format_quantity(total_, Quantity::time, 4), rate, rate < 10.0 ? 1 : 0);
    if (fraction > 0.0 && seconds > 0.0) text += "  " + duration(seconds * (1.0 - fraction) / fraction) + " to go";
    return text;
  }

 private:
  static std::string duration(double seconds) {
    if (!(seconds < 360000.0)) return "> 100 h";
    const auto whole = static_cast<int>(std::lround(seconds));
    return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                         : fmt::format("{}:{:02}", whole / 60, whole % 60);
  }
  void show(const std::string& text) {
    fmt::print(stream_, "\r{:<{}}", text, width_);
    width_ = text.size();
    std::fflush(stream_);
  }

  double total_, start_;
  std::FILE* stream_;
  bool terminal_, shown_ = false, finished_ = false;
  Clock::time_point begun_, last_{};
  std::size_t width_ = 0;
};

}  // namespace tactoid
