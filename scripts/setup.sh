#!/usr/bin/env bash
# Everything lte needs on Debian 12: packages, and LibTorch in .venv. Idempotent; takes a second
# when nothing is to do.
#
#   scripts/setup.sh            packages, LibTorch, Open Image Denoise, xatlas
#   scripts/setup.sh --tests    and what tests need besides: PyPI's tensorboard, nanobind, pytest,
#                               mypy, pyktx2, three.js
#   scripts/setup.sh --packages packages and xatlas alone, for -DLTE_TORCH=OFF
#   LTE_SKIP_APT=1 ...          never touch the system's packages
#   Torch_ROOT=/opt/libtorch .. use this LibTorch instead of the wheel
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly torch_version=2.11.0 oidn_version=2.5.1.0 xatlas_version=0.0.11
readonly xatlas_checksum=72f0bc6c42c19252be87e947d9dfe251c8d6c6943fd43e3d173ddc6b1afad693
packages=(build-essential cmake ninja-build ccache pkg-config python3 python3-venv
  libembree-dev libopenexr-dev libtinygltf-dev libstb-dev zlib1g-dev libdraco-dev libwebp-dev
  libflann-dev libcli11-dev libyaml-cpp-dev nlohmann-json3-dev libgloo-dev
  libboost-dev libturbojpeg0-dev
  libgtest-dev libgmock-dev libbenchmark-dev)

say() { printf 'setup: %s\n' "$*"; }
fail() { printf 'setup: %s\n' "$*" >&2; exit 1; }

missing_packages() {
  for package in "${packages[@]}"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || echo "$package"
  done
}

install_packages() {
  local missing; missing=$(missing_packages)
  if [ -z "$missing" ]; then say "packages: all there"; return; fi
  [ -z "${LTE_SKIP_APT:-}" ] || fail "LTE_SKIP_APT is set and these packages are missing:" $missing
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "not root and no sudo; install as root: apt-get install" $missing
    as_root=(sudo)
  fi
  say "packages: installing" $missing
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

install_torch() {
  if [ -n "${Torch_ROOT:-}" ]; then say "LibTorch: $Torch_ROOT (Torch_ROOT)"; return; fi
  local marker=.venv/lte-torch-$torch_version
  if [ -e "$marker" ]; then say "LibTorch: $torch_version in .venv"; return; fi
  say "LibTorch: installing torch $torch_version into .venv (1.3 GB)"
  make_environment .venv
  # libtorch_cpu of the wheel names these two CUDA libraries; nothing else of CUDA is needed on the
  # CPU.
  .venv/bin/pip install --quiet --disable-pip-version-check --no-deps "torch==$torch_version" \
    'nvidia-cuda-runtime==13.0.*' 'nvidia-cuda-cupti==13.0.*'
  touch "$marker"
}

# lte finds this library when it runs, and goes without where it is missing. The wheel carries
# modules for GPUs too, which are not needed.
install_oidn() {
  local marker=.venv/lte-oidn-$oidn_version
  if [ -e "$marker" ]; then say "Open Image Denoise: $oidn_version in .venv"; return; fi
  say "Open Image Denoise: installing pyoidn $oidn_version into .venv (88 MB to fetch, 65 MB kept)"
  [ -x .venv/bin/pip ] || make_environment .venv
  if .venv/bin/pip install --quiet --disable-pip-version-check --no-deps --no-compile \
    "pyoidn==$oidn_version"; then
    local folder; folder=$(echo .venv/lib/python3*/site-packages/pyoidn/oidn)
    rm -rf "$folder/bin" "$folder"/lib/libOpenImageDenoise_device_{cuda,hip,sycl}.so* \
      "$folder"/lib/lib{sycl,umf,ur_}*
    touch "$marker"
  else
    say "Open Image Denoise: could not be installed; lte denoises by a filter of its own"
  fi
}

# Charts of light maps (lte_bake): two files of the source package, compiled with lte.
install_xatlas() {
  if [ -e .venv/xatlas/xatlas.cpp ]; then say "xatlas: $xatlas_version in .venv"; return; fi
  say "xatlas: taking two files of its source package $xatlas_version into .venv/xatlas"
  [ -x .venv/bin/pip ] || make_environment .venv
  local folder file; folder=$(mktemp -d)
  file=$folder/xatlas-$xatlas_version.tar.gz
  if .venv/bin/pip download --quiet --disable-pip-version-check --no-deps --no-binary xatlas \
    --dest "$folder" "xatlas==$xatlas_version" &&
    echo "$xatlas_checksum  $file" | sha256sum --check --quiet; then
    mkdir -p .venv/xatlas
    tar xzf "$file" -C .venv/xatlas --strip-components=5 \
      "xatlas-$xatlas_version/extern/xatlas/source/xatlas"
  else
    say "xatlas: could not be fetched; lte_bake will not be built"
  fi
  rm -rf "$folder"
}

# The system's python3, so that neither wheel nor environment depends on whichever version manager
# is active.
make_environment() {
  local python=python3; [ -x /usr/bin/python3 ] && python=/usr/bin/python3
  "$python" -m venv "$1"
}

# An environment of its own: LibTorch's holds the wheel without what the wheel depends on, of which
# pip would complain.
install_tensorboard() {
  local marker=.venv/tests/lte-tensorboard-2
  if [ -e "$marker" ]; then say "TensorBoard: in .venv/tests"; return; fi
  say "TensorBoard: installing into .venv/tests"
  if make_environment .venv/tests &&
    .venv/tests/bin/pip install --quiet --disable-pip-version-check 'tensorboard==2.*' 'setuptools<81'; then
    touch "$marker"
  else
    say "TensorBoard: could not be installed; its test will skip"
  fi
}

# The Python package (-DLTE_PYTHON=ON), and what its tests import; a reader of KTX2 files.
install_python_package_needs() {
  local marker=.venv/tests/lte-python-3
  if [ -e "$marker" ]; then say "Python package: nanobind, pytest, mypy and pyktx2 in .venv/tests"; return; fi
  say "Python package: installing nanobind, NumPy, pytest, hypothesis, mypy and pyktx2 into .venv/tests"
  [ -x .venv/tests/bin/pip ] || make_environment .venv/tests
  .venv/tests/bin/pip install --quiet --disable-pip-version-check 'nanobind>=3.1,<4' numpy pytest \
    hypothesis mypy pyktx2
  touch "$marker"
}

# three.js as an ES module with its loader of glTF, for light maps in a browser: nicegui's wheel has
# it bundled.
install_three() {
  if [ -e .venv/tests/three.js ]; then say "three.js: in .venv/tests"; return; fi
  say "three.js: taking it out of nicegui's wheel into .venv/tests"
  [ -x .venv/tests/bin/pip ] || make_environment .venv/tests
  local folder; folder=$(mktemp -d)
  if .venv/tests/bin/pip download --quiet --disable-pip-version-check --no-deps --dest "$folder" \
    'nicegui==3.18.0' && .venv/tests/bin/python -m zipfile -e "$folder"/nicegui-*.whl "$folder"; then
    cp "$folder/nicegui/elements/scene/dist/index.js" .venv/tests/three.js
  else
    say "three.js: could not be taken; its test will skip"
  fi
  rm -rf "$folder"
}

tests='' packages_alone=''
case "${1:-}" in
  --tests) tests=1; packages+=(python3-dev) ;;
  --packages) packages_alone=1 ;;
  "") ;;
  *) fail "unknown argument $1 (see the head of scripts/setup.sh)" ;;
esac
if command -v dpkg-query >/dev/null; then install_packages; else say "packages: not Debian, see README for the list"; fi
install_xatlas
if [ -n "$packages_alone" ]; then say "done"; exit; fi
install_torch
install_oidn
[ -z "$tests" ] || { install_tensorboard; install_python_package_needs; install_three; }
say "done"
