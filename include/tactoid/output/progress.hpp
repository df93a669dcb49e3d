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
  void update(double time, std::uint64_t steps);

  /// Leaves the line as it stands and goes to the next one.
  void finish();

  /// The text of the line after `seconds` of computing.
  [[nodiscard]] std::string line(double time, std::uint64_t steps, double seconds) const;

 private:
  static std::string duration(double seconds);
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

#if !defined(TACTOID_COMPILED)
#include <tactoid/output/progress.ipp>
#endif
