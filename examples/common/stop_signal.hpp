#pragma once

#include <csignal>
#include <string_view>

namespace tactoid {

/// SIGINT or SIGTERM asked the run to end, and it did, in a state that can be continued.
struct Interrupted {
  int signal;
  [[nodiscard]] std::string_view name() const { return signal == SIGINT ? "SIGINT" : "SIGTERM"; }
  /// The exit status of a program that a signal has ended.
  [[nodiscard]] int status() const { return 128 + signal; }
};

/// While it lives, SIGINT (Ctrl-C) and SIGTERM are noted and not obeyed at once; the second one ends the program.
class StopSignal {
 public:
  StopSignal() {
    received_ = 0;
    struct sigaction action {};
    action.sa_handler = [](int signal) { received_ = signal; };
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // a file that is being written is finished
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, &interrupt_);
    sigaction(SIGTERM, &action, &terminate_);
  }
  ~StopSignal() {
    sigaction(SIGINT, &interrupt_, nullptr);
    sigaction(SIGTERM, &terminate_, nullptr);
  }
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The signal that has come; 0: none.
  [[nodiscard]] int received() const { return received_; }
  /// Throws Interrupted once a signal has come.
  void check() const {
    if (received_ != 0) throw Interrupted{received_};
  }

 private:
  static inline volatile std::sig_atomic_t received_ = 0;
  struct sigaction interrupt_ {}, terminate_ {};
};

}  // namespace tactoid
