# Sourced by the run scripts: `install_packages NAME...` installs those Debian/Ubuntu packages that are missing.

# What every build needs.
build_packages=(g++ make cmake libeigen3-dev libnanoflann-dev libfmt-dev libcli11-dev libtomlplusplus-dev libhdf5-dev zlib1g-dev)
# And what the tests need for several processes, and for the solvers of SuiteSparse.
optional_packages=(libopenmpi-dev openmpi-bin libmetis-dev libsuitesparse-dev)

install_packages() {
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian or Ubuntu: what is missing of these must be installed by hand: $*" >&2
    return 0
  fi
  local name missing=()
  for name in "$@"; do
    dpkg-query -W -f='${Status}' "$name" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$name")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "Installing: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "Missing packages, and neither root nor sudo to install them; ask for: apt-get install ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq update </dev/null
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends \
    -o Dpkg::Use-Pty=0 "${missing[@]}" </dev/null >/dev/null
}

# configure_and_build PRESET [TARGET...]: the preset's configuration and its targets, with all processors; with another
# compiler than the preset's by the environment variable COMPILER.
configure_and_build() {
  local preset=$1
  shift
  cmake --preset "$preset" ${COMPILER:+-D "CMAKE_CXX_COMPILER=$COMPILER"} &&
    cmake --build --preset "$preset" --parallel "$(nproc 2>/dev/null || echo 2)" ${1:+--target "$@"}
}
