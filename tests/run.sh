#!/usr/bin/env bash
# Installs what is missing (Debian/Ubuntu), builds the tests and runs them:
#   bash tests/run.sh [options of ctest, for example -R kernel or -L static]
# Another preset of CMakePresets.json by the environment variable PRESET (test, clang, sanitize).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source cmake/install_packages.sh

install_packages "${build_packages[@]}" "${optional_packages[@]}" doctest-dev libbenchmark-dev doxygen python3 python3-numpy python3-matplotlib python3-h5py
preset=${PRESET:-test}
configure_and_build "$preset"
exec ctest --preset "$preset" --parallel "$(nproc 2>/dev/null || echo 2)" "$@" </dev/null
