#!/usr/bin/env bash
# Installs what is missing (Debian/Ubuntu), builds the main job, runs it and draws its picture:
#   bash examples/run_spreading.sh [options of spreading_uniform, for example --stiffness 5 --end-time 2us]
# Results in out/spreading_uniform, or where --out says.
set -euo pipefail
project=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$project/cmake/install_packages.sh"

install_packages "${build_packages[@]}" libbenchmark-dev python3 python3-numpy python3-matplotlib
(cd "$project" && configure_and_build release spreading_uniform)

out=
previous=
for argument in "$@"; do
  case "$previous" in --out) out=$argument ;; esac
  case "$argument" in
    --out=*) out=${argument#--out=} ;;
    --help | --info) exec "$project/build/release/examples/spreading_uniform" "$@" ;;
  esac
  previous=$argument
done
if [ -z "$out" ]; then
  out=$project/out/spreading_uniform
  set -- --out "$out" "$@"
fi
"$project/build/release/examples/spreading_uniform" "$@"
/usr/bin/python3 "$project/examples/spreading_uniform/plot.py" "$out"
