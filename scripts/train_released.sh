#!/usr/bin/env bash
# Makes a released model from nothing: its data, its training, its files.
#
#   scripts/train_released.sh [--rehearse] MODEL [FOLDER]
#
# MODEL is lte, lte-paper or lte-radiance. FOLDER (data/released by default) takes the data and the
# run. A run that was stopped goes on where it was when the same line is given again. At its end the
# model, its configuration, its log, its card and its provenance are in FOLDER/release.
#
# lte makes its data, wild rooms, homes and boxes, beside its training, which begins with the first
# 600 scenes: some eight hours of two cores. lte-paper, the paper's network, learns from the same
# rooms, with fewer points and all there first: some two hours. FOLDER/release then has their
# curves, too, and their errors on the shipped homes, on boxes and wild rooms of other seeds and on
# assets/scenes/outside. lte-radiance starts from the shipped lte and takes a quarter of an hour;
# its figures are of glossy rooms.
#
# --rehearse goes the whole way on a few scenes and 8 steps, in minutes (FOLDER: data/rehearsed):
# whether a machine has what the night will need.
set -euo pipefail
cd "$(dirname "$0")/.."

usage() { sed -n '2,18s/^# \{0,1\}//p' "$0"; }
default=data/released fewer_scenes=() fewer_steps=() pictures=(--size 128x96)
first_scenes=600 session_steps=1600
if [ "${1:-}" = --rehearse ]; then
  shift
  default=data/rehearsed
  fewer_scenes=(--set scenes=16)
  first_scenes=4 session_steps=3 pictures=(--size 48x36 --reference-spp 4)
  fewer_steps=(--set train.steps=8 --set train.scenes_per_step=2 --set train.scenes_per_pass=1
    --set train.warmup_steps=2 --set train.checkpoint_every=4 --set train.validate_every=4
    --set train.log_every=1)
fi
case ${1:-} in
  lte | lte-paper | lte-radiance) ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
name=$1 folder=${2:-$default}
released=$folder/release/$name
bin=${LTE_BIN:-build/bin}
tools=(lte_datagen lte_train lte_eval)
[ "$name" != lte-radiance ] || tools+=(experiment_directions)  # needs -DLTE_EXPERIMENTS=ON
for tool in "${tools[@]}"; do
  if [ ! -x "$bin/$tool" ]; then
    echo "train_released.sh: $bin/$tool is missing: run scripts/build.sh first" >&2
    exit 1
  fi
done
mkdir -p "$folder"

# $1: folder below $folder, $2: configuration, then flags. Quick where the data are there.
make_data() {
  echo "train_released.sh: $folder/$1 from configs/data/$2.yaml"
  "$bin/lte_datagen" generate --config "configs/data/$2.yaml" --out "$folder/$1" --resume \
    "${@:3}" "${fewer_scenes[@]}"
}
# $1: training configuration, $2: data set, below $folder, then flags.
session() {
  local flags=(--config "configs/train/$1.yaml" --set "data.root=$folder/$2"
    --set "data.solved_light=$folder/solved_light/$2" --out "$folder/$name" "${fewer_steps[@]}")
  if compgen -G "$folder/$name/checkpoint*.safetensors" > /dev/null; then
    flags+=(--resume)
  fi
  "$bin/lte_train" "${flags[@]}" "${@:3}"
}
# The same, to the end.
train() {
  session "$@"
  mkdir -p "$folder/release"
  cp "$folder/$name/model.safetensors" "$released.safetensors"
  cp "$folder/$name/config.yaml" "$released.yaml"
  cp "$folder/$name/log.jsonl" "$released.log.jsonl"
}

# Data sets, then --test or --maps with what was measured.
write_card() {
  local card
  card=$(scripts/figures/model_card.py "$name" --log "$released.log.jsonl" \
    --provenance "$released.provenance.json" --command "scripts/train_released.sh $name" --data "$@")
  echo "$card" | tee "$released.md"
}

if [ "$name" = lte-radiance ]; then
  make_data glossy glossy
  make_data glossy_test glossy_test
  train lte_radiance glossy
  "$bin/experiment_directions" --checkpoint "$released.safetensors" --data "$folder/glossy_test" \
    --out "$released.rooms.html" --json "$released.rooms.json"
  write_card "$folder/glossy" --maps "glossy rooms=$released.rooms.json"
  exit
fi

# What a model learns from: the finished scenes of $rooms, and $clean ones, which validate. Names of
# scenes stay the same as it grows.
case $name in
  lte) rooms=mixed clean=clean joined=lte_data ;;
  lte-paper) rooms=mixed_paper clean=clean_paper joined=lte_paper_data ;;
esac
join_what_is_there() {
  "$bin/lte_datagen" generate --out "$folder/$rooms" --merge --quiet
  rm -rf "${folder:?}/$joined"
  "$bin/lte_datagen" join "$folder/$clean" "$folder/$rooms" --out "$folder/$joined" --quiet
}
all_steps_done() {
  local steps
  steps=$(sed -n 's/^  steps: *//p' "$folder/lte/config.yaml")
  grep -q "\"step\": *$steps[,}]" "$folder/lte/log.jsonl"
}
finished_scenes() { find "$folder/$rooms/scenes" -name '*.safetensors' 2> /dev/null | wc -l; }

# Of a model of the mixed data, once it is trained.
evaluate_mixed() {
  make_data wild_test wild_test
  make_data boxes_test boxes_test
  scripts/figures/learning_curves.py "$folder/$name" --out "$released.svg"
  "$bin/lte_eval" --fit-baselines "$folder/$joined" --out "$released.baselines.json"
  local tests=() test data
  for test in homes: boxes:boxes_test wild:wild_test; do
    data=${test#*:}
    "$bin/lte_eval" --checkpoint "$released.safetensors" ${data:+--data "$folder/$data"} \
      --split test --json "$released.${test%%:*}.json"
    tests+=(--test "${test%%:*}=$released.${test%%:*}.json")
  done
  "$bin/lte_eval" scenes assets/scenes/outside --checkpoint "$released.safetensors" \
    --methods network,decoded,gather --json "$released.outside.json" "${pictures[@]}" |
    tee "$released.outside.txt"
  write_card "$folder/$clean" "$folder/$rooms" "${tests[@]}"
}

fewer_scenes=("${fewer_scenes[@]/scenes=16/scenes=6}")  # as long as sixteen boxes take
make_data "$clean" "$rooms" --seed 391001 --set scenes=48 --set rays=512 --set val_share=1
if [ "$name" = lte-paper ]; then
  make_data "$rooms" "$rooms"
  join_what_is_there
  train lte_paper "$joined"
  evaluate_mixed
  exit
fi
make_data "$rooms" "$rooms" --quiet &
baker=$!
trap 'kill "$baker" 2> /dev/null || true' EXIT
while kill -0 "$baker" 2> /dev/null && [ "$(finished_scenes)" -lt "$first_scenes" ]; do
  sleep 5
done
while kill -0 "$baker" 2> /dev/null; do
  join_what_is_there
  session lte "$joined" --stop-after "$session_steps"
  all_steps_done && break  # before all of the data are there
done
# Scenes that failed are left out, with a warning.
all_steps_done || wait "$baker" || echo "train_released.sh: goes on without some scenes" >&2
join_what_is_there
train lte "$joined"
evaluate_mixed
