#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/output/progress.hpp>

namespace tactoid {

TACTOID_INLINE void Progress::update(double time, std::uint64_t steps) {
  if (!terminal_ || finished_) return;
  const Clock::time_point now = Clock::now();
  if (shown_ && now - last_ < std::chrono::milliseconds(200) && time < total_) return;
  last_ = now;
  shown_ = true;
  show(line(time, steps, std::chrono::duration<double>(now - begun_).count()));
}

TACTOID_INLINE void Progress::finish() {
  if (terminal_ && shown_ && !finished_) {
    std::fputc('\n', stream_);
    std::fflush(stream_);
  }
  finished_ = true;
}

TACTOID_INLINE std::string Progress::line(double time, std::uint64_t steps, double seconds) const {
  const double fraction = total_ > start_ ? std::clamp((time - start_) / (total_ - start_), 0.0, 1.0) : 1.0;
  const double rate = seconds > 0.0 ? static_cast<double>(steps) / seconds : 0.0;
  std::string text =
      fmt::format("{:5.1f} %  {} of {}  {:.{}f} steps/s", 100.0 * fraction, format_quantity(time, Quantity::time, 4),
                  format_quantity(total_, Quantity::time, 4), rate, rate < 10.0 ? 1 : 0);
  if (fraction > 0.0 && seconds > 0.0) text += "  " + duration(seconds * (1.0 - fraction) / fraction) + " to go";
  return text;
}

TACTOID_INLINE std::string Progress::duration(double seconds) {
  if (!(seconds < 360000.0)) return "> 100 h";
  const auto whole = static_cast<int>(std::lround(seconds));
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace tactoid
