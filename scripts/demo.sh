#!/usr/bin/env bash
# The whole chain on 2 cores: rooms, path-traced ground truth, training, evaluation on unseen rooms, rendering, export.
# Ends with out/demo/report.html.
#
#   scripts/demo.sh           at most 10 minutes after set-up and build
#   scripts/demo.sh --quick   at most 3 minutes, smaller in everything
#   scripts/demo.sh --render  under a minute: pictures of a bundled home by the released model, in out/render
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scenes=160 steps=1800 size=384x288 spp=256 held_out=0.1
render() {
  local out=out/render scene=assets/scenes/living_room.glb size=640x480 exposure
  mkdir -p "$out"
  # Path tracing of as many paths as takes about as long; its exposure holds for both pictures.
  build/bin/lte_render "$scene" --mode reference --spp 8 --size "$size" --out "$out/path_traced.png" --json "$out/path_traced.json"
  exposure=$(sed -n 's/.*"exposure": *\([0-9.e+-]*\).*/\1/p' "$out/path_traced.json")
  build/bin/lte_render "$scene" --size "$size" --exposure "$exposure" --out "$out/network.png" --json "$out/network.json"
  printf '\nDone in %d s: open %s/network.png, and path_traced.png beside it\n' "$SECONDS" "$out"
}

case "${1:-}" in
  --render) scripts/build.sh release && SECONDS=0 && render && exit ;;
  --quick) scenes=40 steps=150 size=192x144 spp=64 held_out=0.2 ;;
  "") ;;
  *) echo "usage: scripts/demo.sh [--quick | --render]"; [ "$1" = --help ] && exit 0 || exit 2 ;;
esac

scripts/build.sh release
readonly bin=$PWD/build/bin out=out/demo
readonly data=$out/data run=$out/run
rm -rf "$out"
mkdir -p "$out"
step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

SECONDS=0
step "1/6 generating and baking $scenes furnished rooms"
"$bin/lte_datagen" generate --config configs/data/demo.yaml --out "$data" --scenes "$scenes" \
  --set "val_share=$held_out" --set "test_share=$held_out"

step "2/6 training for $steps steps"
"$bin/lte_train" --config configs/train/demo.yaml --out "$run" --set "data.root=$data" --set "train.steps=$steps"

step "3/6 evaluating on rooms it has not seen"
"$bin/lte_eval" --fit-baselines "$data" --out "$run/model.baselines.json"
"$bin/lte_eval" --checkpoint "$run/model.safetensors" --data "$data" --split test --report "$out/eval" --json "$out/eval.json"

step "4/6 rendering an unseen room and a Cornell box, predicted and path-traced"
"$bin/lte_datagen" generate --config configs/data/demo.yaml --out "$out/unseen" --scenes 1 --seed 990017 --glb
cp "$out"/unseen/scenes/*.glb "$out/room.glb"
cp assets/scenes/cornell_box.glb "$out/cornell.glb"
for scene in room cornell; do
  # The reference fixes the exposure of all three pictures of a scene.
  "$bin/lte_render" "$out/$scene.glb" --mode reference --spp "$spp" --size "$size" --out "$out/${scene}_reference.png" \
    --json "$out/${scene}_reference.json"
  exposure=$(sed -n 's/.*"exposure": *\([0-9.e+-]*\).*/\1/p' "$out/${scene}_reference.json")
  for model in shipped trained; do
    checkpoint=$run/model.safetensors
    [ $model = shipped ] && checkpoint=assets/models/lte-small.safetensors
    "$bin/lte_render" "$out/$scene.glb" --checkpoint "$checkpoint" --size "$size" --exposure "$exposure" \
      --out "$out/${scene}_$model.png" --json "$out/${scene}_$model.json"
  done
  "$bin/lte_render" "$out/$scene.glb" --size "$size" --out "$out/$scene.exr" --quiet
done

step "5/6 exporting TorchScript"
"$bin/lte_export" --checkpoint "$run/model.safetensors" --out "$out/model.pt" --portable --verify

step "6/6 writing the report"
"$bin/lte_train" report "$run"
python3 scripts/figures/report.py "$out"
printf '\nDone in %d s: open %s/report.html\n' "$SECONDS" "$out"
