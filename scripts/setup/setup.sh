#!/usr/bin/env bash
# Installs what the build needs and is missing; does nothing, quickly, where nothing is.
#
#   scripts/setup/setup.sh         compiler, MPI, HDF5, muParser, CMake; Python packages in build/venv
#   scripts/setup/setup.sh --test  packages that only tests use in build/venv, and Chromium; else those tests say so
#   scripts/setup/setup.sh --dev   the tools of make lint, format, coverage and doc in build/venv
#
# On Debian and Ubuntu, as root or with a passwordless sudo, system packages come from apt. Elsewhere it says what is
# missing and how a cluster usually provides it, and ends with code 1.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

venv=build/venv

# ------------------------------------------------------------------------------------------------ what is there
has() { command -v "$1" > /dev/null 2>&1; }

has_muparser() {
  has pkg-config && pkg-config --exists muparser 2> /dev/null && return 0
  local dir
  local -a roots
  IFS=: read -r -a roots <<< "${CMAKE_PREFIX_PATH:-}:${CONDA_PREFIX:-}:${MUPARSER_ROOT:-}:/usr:/usr/local"
  for dir in "${roots[@]}"; do
    [ -n "$dir" ] && [ -e "$dir/include/muParserBytecode.h" ] && return 0
  done
  IFS=: read -r -a roots <<< "${CPATH:-}"
  for dir in "${roots[@]}"; do
    [ -n "$dir" ] && [ -e "$dir/muParserBytecode.h" ] && return 0
  done
  return 1
}

has_recent_cmake() {
  has cmake || return 1
  local version major minor
  version=$(cmake --version | sed -n '1s/^cmake version \([0-9]*\.[0-9]*\).*/\1/p')
  major=${version%.*}
  minor=${version#*.}
  [ "$major" -gt 3 ] || { [ "$major" -eq 3 ] && [ "$minor" -ge 21 ]; }
}

has_c_compiler() { has "${CC:-cc}" || has gcc; }
has_cxx_compiler() { has "${CXX:-c++}" || has g++; }
has_mpi_compiler() { has mpifort || has mpif90; }
has_python() { has python3 && python3 -c 'import sys; sys.exit(sys.version_info < (3, 8))'; }
has_python_venv() { has_python && python3 -c 'import venv, ensurepip' 2> /dev/null; }

# check | Debian package | what it is ("optional": the build does without) | how a cluster provides
# it: module load | spack install | conda install
needs() {
  cat << 'LIST'
has_c_compiler|gcc|a C compiler|gcc|gcc|c-compiler
has_cxx_compiler|g++|a C++17 compiler (GNU 11 or later)|gcc|gcc|cxx-compiler
has gfortran|gfortran|GNU Fortran 10 or later|gcc|gcc|gfortran
has_mpi_compiler|libopenmpi-dev|MPI with Fortran modules (mpifort)|openmpi|openmpi|openmpi-mpifort
has mpiexec|openmpi-bin|mpiexec|openmpi|openmpi|openmpi
has h5pfc|libhdf5-openmpi-dev|parallel HDF5 with Fortran (h5pfc)|hdf5-parallel|hdf5+mpi+fortran|"hdf5=*=mpi_openmpi*"
has_muparser|libmuparser-dev|muParser 2.3 or later (muParserBytecode.h)|muparser|muparser|muparser; CMAKE_PREFIX_PATH
has_recent_cmake|cmake|CMake 3.21 or later|cmake|cmake|cmake; pip install cmake
has make|make|make|gmake|gmake|make
has_python|python3|Python 3.8 or later|python|python|python
has_python_venv|python3-venv|Python's venv and ensurepip|python|python|python
has git|git|optional: git, for the commit in the log|git|git|git
LIST
}

missing_needs() {
  local check package what module spack conda
  while IFS='|' read -r check package what module spack conda; do
    $check || printf '%s|%s|module load %s; spack install %s; conda install %s\n' \
      "$package" "$what" "$module" "$spack" "$conda"
  done < <(needs)
}

# ---------------------------------------------------------------------------------------------------- apt-get
is_debian() { has apt-get && has dpkg; }

apt_prefix=()
can_install() {
  is_debian || return 1
  [ "$(id -u)" -eq 0 ] && return 0
  if has sudo && sudo -n true 2> /dev/null; then
    apt_prefix=(sudo -n)
    return 0
  fi
  return 1
}

apt_install() {
  local -a apt=("${apt_prefix[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -q)
  echo "setup: installing $*"
  "${apt[@]}" update < /dev/null || echo "setup: apt-get update failed; trying with the lists that are there" >&2
  "${apt[@]}" install --no-install-recommends "$@" < /dev/null
}

install_system_packages() {
  local missing
  missing=$(missing_needs)
  [ -n "$missing" ] || return 0
  if can_install; then
    local -a packages
    mapfile -t packages < <(cut -d'|' -f1 <<< "$missing" | sort -u)
    apt_install "${packages[@]}" || echo "setup: apt-get could not install them" >&2
    hash -r
    missing=$(missing_needs)
    [ -n "$missing" ] || return 0
  fi
  local package what cluster status=0
  {
    echo "setup: this is missing:"
    while IFS='|' read -r package what cluster; do
      printf '  %s\n      Debian, Ubuntu: apt-get install %s\n      cluster: %s\n' "$what" "$package" "$cluster"
      [[ $what == optional:* ]] || status=1
    done <<< "$missing"
    [ "$status" -eq 0 ] || echo "Install it (as root, or ask your administrator) and run make again."
  } >&2
  return "$status"
}

# ------------------------------------------------------------------------------------------------------ Python
venv_works() { [ -x "$venv/bin/python" ] && "$venv/bin/python" -c '' 2> /dev/null; }
imports() { "$1" -c 'import numpy, matplotlib' 2> /dev/null; }

# An environment that only borrows the system's packages, for machines that reach no package index.
borrow_system_python() {
  local system=/usr/bin/python3
  [ -x "$system" ] || system=$(command -v python3)
  if ! imports "$system" && can_install; then
    apt_install python3-numpy python3-matplotlib || true
  fi
  imports "$system" || return 1
  rm -rf "$venv"
  "$system" -m venv --system-site-packages --without-pip "$venv"
}

# Installs a list of requirements unless that very list is installed already.
install_requirements() {
  local list=$1 stamp
  stamp="$venv/.$(basename "$list").$(cksum < "$list" | tr ' ' '-')"
  if venv_works; then
    [ ! -e "$stamp" ] || return 0
  else
    rm -rf "$venv"
    mkdir -p build
    python3 -m venv "$venv" || return 1
  fi
  echo "setup: Python packages of $list"
  "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input -r "$list" < /dev/null || return 1
  touch "$stamp"
}

install_python_packages() {
  install_requirements scripts/setup/requirements.txt && return 0
  echo "setup: pip could not install scripts/setup/requirements.txt; looking for the system's own packages" >&2
  if borrow_system_python; then
    touch "$venv/.requirements.txt.$(cksum < scripts/setup/requirements.txt | tr ' ' '-')"
    return 0
  fi
  # The solver does without them: go on, and let the scripts that draw say so again.
  echo "setup: numpy and matplotlib are missing: no pictures, and tests that need them will fail." >&2
  echo "  Debian, Ubuntu: apt-get install python3-numpy python3-matplotlib" >&2
  echo "  cluster: module load scipy-stack or python-scientific; spack install py-numpy py-matplotlib;" >&2
  echo "    conda install numpy matplotlib" >&2
}

install_test_packages() {
  install_requirements scripts/setup/requirements-test.txt && return 0
  echo "setup: pip could not install scripts/setup/requirements-test.txt; the tests that need it will be skipped" >&2
}

# The browser that shows pages of reports and documents to a test. Tried once: without it the pages are parsed only.
install_browser() {
  has chromium || has chromium-browser || has google-chrome || [ -e "$venv/.no-browser" ] && return 0
  can_install && apt_install chromium > /dev/null 2>&1 && return 0
  echo "setup: no Chromium (Debian, Ubuntu: apt-get install chromium); pages will be parsed, not shown" >&2
  touch "$venv/.no-browser" 2> /dev/null || true
}

install_developer_tools() {
  install_requirements scripts/setup/requirements-dev.txt && return 0
  echo "setup: could not install the tools of scripts/setup/requirements-dev.txt into $venv:" >&2
  sed 's/^/  pip install /' scripts/setup/requirements-dev.txt >&2
  return 1
}

case "${1:-}" in
  "") install_system_packages && install_python_packages ;;
  --test) install_test_packages; install_browser ;;
  --dev) install_developer_tools ;;
  *) echo "usage: scripts/setup/setup.sh [--test | --dev]" >&2; exit 2 ;;
esac
