#!/usr/bin/env bash
# Installs a build tree to a scratch prefix, then configures, builds and runs projects that find it
# there: one in C++, and the example in C, which is also built by the C compiler alone. README's
# commands run in share/lte of the prefix.
#   tests/install/run.sh BUILD_DIR
set -euo pipefail
build=$1
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$build" --prefix "$scratch/prefix" >/dev/null
cmake -S "$source" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$scratch/prefix" >/dev/null
cmake --build "$scratch/build" >/dev/null
[ "$("$scratch/build/consumer")" = "test 2" ]
"$scratch/prefix/bin/lte_train" --version

example=$source/../../examples/c
model=$scratch/prefix/share/lte/assets/models/lte.safetensors
cmake -S "$example" -B "$scratch/example" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$scratch/prefix" >/dev/null
cmake --build "$scratch/example" >/dev/null
"$scratch/example/render_room" "$model" "$scratch/cmake.ppm" "$scratch/cmake.pfm" 32 24
cc -std=c99 -I "$scratch/prefix/include" "$example/render_room.c" "$example/room.c" -o "$scratch/render_room" \
  -L "$scratch/prefix/lib" -llte_c_api -lm -Wl,-rpath,"$scratch/prefix/lib"
"$scratch/render_room" "$model" "$scratch/cc.ppm" "$scratch/cc.pfm" 32 24
cmp "$scratch/cmake.pfm" "$scratch/cc.pfm"

cmake -S "$source/../../examples/cpp" -B "$scratch/picture" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$scratch/prefix" >/dev/null
cmake --build "$scratch/picture" >/dev/null
"$scratch/picture/render_picture" "$scratch/prefix/share/lte/assets/scenes/cornell_box.glb" "$scratch/picture.png" >/dev/null
[ -s "$scratch/picture.png" ]

bin=$scratch/prefix/bin
cd "$scratch/prefix/share/lte"
for file in LICENSE README.md CHANGELOG.md docs/README.md view/index.html view/main.js examples/c/render_room.c configs/data/boxes.yaml; do
  [ -e "$file" ] || { echo "install: share/lte/$file is missing"; exit 1; }
done
"$bin/lte_datagen" generate --config configs/data/boxes.yaml --print-config >/dev/null
"$bin/lte_train" --config configs/train/demo.yaml --dry-run >/dev/null
"$bin/lte_render" assets/scenes/cornell_box.glb --size 16x12 --out "$scratch/cornell.png"
# The model that the tool takes by itself is the installed one: without it that is what is missed.
echo damaged >assets/models/lte.safetensors
if "$bin/lte_render" assets/scenes/cornell_box.glb --size 16x12 --integrator network \
    --out "$scratch/none.png" 2>"$scratch/said"; then
  echo "install: lte_render does not read the installed model"; exit 1
fi
grep -q "$scratch/prefix/share/lte/assets/models/lte.safetensors" "$scratch/said"
