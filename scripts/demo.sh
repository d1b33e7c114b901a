#!/usr/bin/env bash
# The whole chain on 2 cores: rooms, path-traced ground truth, training, evaluation on unseen rooms,
# rendering, export. Ends with out/demo/report.html.
#
#   scripts/demo.sh           at most 10 minutes after set-up and build
#   scripts/demo.sh --quick   at most 3 minutes, smaller in everything
#   scripts/demo.sh --render  under a minute: pictures of a bundled home by the released model, in
#                             out/render; builds lte_render alone
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scenes=160 steps=1800 size=384x288 spp=256 held_out=0.1
readonly living_room=assets/scenes/living_room.glb

# Renders by path tracing and takes over its exposure for the pictures beside it.
reference() {  # SCENE PICTURE [OPTION ...]
  build/bin/lte_render "$1" --integrator path --out "$2.png" --json "$2.json" "${@:3}"
  exposure=$(sed -n 's/.*"exposure": *\([0-9.e+-]*\).*/\1/p' "$2.json")
}

render() {
  local out=out/render
  mkdir -p "$out"
  # Path tracing of as many paths as takes about as long.
  reference "$living_room" "$out/path_traced" --spp 8 --size 640x480
  build/bin/lte_render "$living_room" --size 640x480 --set "exposure=$exposure" \
    --out "$out/gathered.png" --json "$out/gathered.json"
  build/bin/lte_render "$living_room" --size 640x480 --set "exposure=$exposure" \
    --integrator network --quality preview --out "$out/network.png" --json "$out/network.json"
  printf '\nDone in %d s: open %s/gathered.png, and network.png and path_traced.png beside it\n' \
    "$SECONDS" "$out"
}

case "${1:-}" in
  --render) scripts/build.sh release lte_render && SECONDS=0 && render && exit ;;
  --quick) scenes=40 steps=150 size=192x144 spp=64 held_out=0.2 ;;
  "") ;;
  *) echo "usage: scripts/demo.sh [--quick | --render]"; [ "$1" = --help ] && exit 0 || exit 2 ;;
esac

scripts/build.sh release lte_datagen lte_train lte_eval lte_render lte_export
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
"$bin/lte_train" --config configs/train/demo.yaml --out "$run" --set "data.root=$data" \
  --set "train.steps=$steps"

step "3/6 evaluating on rooms it has not seen"
"$bin/lte_eval" --fit-baselines "$data" --out "$run/model.baselines.json"
"$bin/lte_eval" --checkpoint "$run/model.safetensors" --data "$data" --split test \
  --report "$out/eval" --json "$out/eval.json"

step "4/6 rendering a home, an unseen room and a Cornell box, predicted and path-traced"
"$bin/lte_datagen" generate --config configs/data/demo.yaml --out "$out/unseen" --scenes 1 \
  --seed 3 --glb
cp "$living_room" "$out/home.glb"
cp "$out"/unseen/scenes/*.glb "$out/room.glb"
cp assets/scenes/cornell_box.glb "$out/cornell.glb"
for scene in home room cornell; do
  # The reference fixes the exposure of all three pictures of a scene.
  reference "$out/$scene.glb" "$out/${scene}_reference" --spp "$spp" --size "$size"
  for model in shipped trained; do
    checkpoint=$run/model.safetensors
    [ $model = shipped ] && checkpoint=assets/models/lte.safetensors
    # Without correction by paths, so that the picture shows what the network knows.
    "$bin/lte_render" "$out/$scene.glb" --integrator network --checkpoint "$checkpoint" \
      --size "$size" --set "exposure=$exposure" --set correct=off \
      --out "$out/${scene}_$model.png" --json "$out/${scene}_$model.json"
  done
  "$bin/lte_render" "$out/$scene.glb" --size "$size" --out "$out/$scene.exr" --quiet
done

step "5/6 exporting TorchScript"
"$bin/lte_export" --checkpoint "$run/model.safetensors" --out "$out/model.pt" --portable --verify

step "6/6 writing the report"
python3 scripts/figures/learning_curves.py "demo=$run" --out "$run/curves.svg"
python3 scripts/figures/report.py "$out"
printf '\nDone in %d s: open %s/report.html\n' "$SECONDS" "$out"
