#!/usr/bin/env bash
# Fails where a build without LibTorch answers otherwise than one with it, by a bit: every shipped
# model, at three numbers of scene points, and in bfloat16. Builds the program lte as packages have
# it, and takes the other one from a build that is there. Passes the tests of tensors and embeddings
# without LibTorch, too.
#
# usage: scripts/dev/check_no_torch.sh [BUILD]     build by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build}
[ -x "$build/bin/lte" ] || { echo "check_no_torch: there is no $build/bin/lte" >&2; exit 2; }
export CCACHE_BASEDIR=$PWD  # as scripts/build.sh
cmake --preset packages >/dev/null
cmake --build --preset packages --target lte_program >/dev/null
own=build-packages/bin/lte
# Names alone: an address may have c10 in it.
if ldd "$own" | grep -E '^\s*lib(torch|c10)'; then
  echo "check_no_torch: $own needs LibTorch" >&2
  exit 1
fi
cmake --preset no-torch >/dev/null
cmake --build --preset no-torch --target lte_tensor_test lte_runtime_test >/dev/null
for test in tensor runtime; do
  "build-no-torch/bin/lte_${test}_test" --gtest_brief=1
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
points="$folder/points.csv"
{
  echo px,py,pz,nx,ny,nz
  for x in -1.5 -0.5 0.5 1.5; do for z in -1.5 -0.5 0.5 1.5; do echo "$x,0,$z,0,1,0"; done; done
} >"$points"
# usage: answers PROGRAM NAME MODEL KEY=VALUE...: NAME.csv, and what the encoder made, NAME.lte
answers() {
  local program=$1 name=$2 model=$3
  shift 3
  "$program" probe assets/scenes/living_room.glb --integrator network --checkpoint "$model" --quiet \
    --points "$points" --spp 16 --set records=256 --set check=off "${@/#/--set=}" \
    --out "$folder/$name.csv" --save-embedding "$folder/$name.lte"
}
compared=0
for model in assets/models/*.safetensors; do
  for settings in scene_points=700 scene_points=3000 scene_points=9000 \
                  "scene_points=3000 precision=bf16"; do
    read -ra keys <<<"$settings"
    answers "$build/bin/lte" torch "$model" "${keys[@]}"
    answers "$own" own "$model" "${keys[@]}"
    for kind in csv lte; do
      if ! cmp -s "$folder/torch.$kind" "$folder/own.$kind"; then
        echo "check_no_torch: $model, $settings: the .$kind files differ" >&2
        exit 1
      fi
    done
    compared=$((compared + 1))
  done
done
echo "check_no_torch: $compared runs of all models answer the same with LibTorch and without"
