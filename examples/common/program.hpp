#pragma once

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/ranks.hpp>

#include <common/stop_signal.hpp>

namespace tactoid {

/// Runs `body()` as the whole of a program: its exit status, or a sentence on the error output and the status of the
/// failure: 2 for what the user can mend (parameters, geometry, files, a full disc), 3 for a computation that broke, 130 or
/// 143 for one that SIGINT or SIGTERM has ended. A file above the limit of the system (ulimit -f) fails as on a full disc.
/// Of several processes (<tactoid/mpi.hpp>) one writes the sentence, and a failure of one ends all.
template <class Body>
int run_program(std::string_view name, const Body& body) {
  const auto report = [&](std::string_view text, int status) {
    std::fflush(stdout);
    if (Ranks::current == nullptr || Ranks::current->reports_failure(fmt::format("{}: {}", name, text), status)) fmt::print(stderr, "{}: {}\n", name, text);
    return status;
  };
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return body();
  } catch (const Interrupted& interrupted) {
    return report(fmt::format("ended by {}.", interrupted.name()), interrupted.status());
  } catch (const ComputationError& error) {
    return report(error.what(), 3);
  } catch (const Error& error) {
    return report(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return report("There is not enough memory for this run.", 3);
  } catch (const std::exception& error) {
    return report(error.what(), 3);
  }
}

}  // namespace tactoid
