#!/usr/bin/env bash
# Makes a released model from nothing: its data, its training, its files.
#
#   scripts/train_released.sh lte-base|lte-hybrid|lte-radiance [FOLDER]
#
# FOLDER (data/released by default) takes the data and the run. A run that was stopped goes on where
# it was when the same line is given again. At its end the model, its configuration and its log are
# in FOLDER/release, and its figures are printed: on the shipped test homes and on test boxes, and
# of lte-radiance on glossy rooms. Many hours of two cores. lte-hybrid and lte-radiance start from
# the shipped lte-base.
set -euo pipefail
cd "$(dirname "$0")/.."

usage() { sed -n '2,10s/^# \{0,1\}//p' "$0"; }
case ${1:-} in
  lte-base | lte-hybrid | lte-radiance) ;;
  -h | --help) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac
name=$1 folder=${2:-data/released}
bin=${LTE_BIN:-build/bin}
for tool in lte_datagen lte_train lte_eval; do
  if [ ! -x "$bin/$tool" ]; then
    echo "train_released.sh: $bin/$tool is missing: run scripts/build.sh first" >&2
    exit 1
  fi
done
mkdir -p "$folder"

# $1: folder below $folder, $2: configuration. Quick where the data are there.
make_data() {
  echo "train_released.sh: $folder/$1 from configs/data/$2.yaml"
  "$bin/lte_datagen" generate --config "configs/data/$2.yaml" --out "$folder/$1" --resume
}
# $1: training configuration, $2: data set, below $folder.
train() {
  local flags=(--config "configs/train/$1.yaml" --set "data.root=$folder/$2"
    --set "data.solved_light=$folder/solved_light/$2" --out "$folder/$name")
  if compgen -G "$folder/$name/checkpoint*.safetensors" > /dev/null; then
    flags+=(--resume)
  fi
  "$bin/lte_train" "${flags[@]}"
  mkdir -p "$folder/release"
  cp "$folder/$name/model.safetensors" "$folder/release/$name.safetensors"
  cp "$folder/$name/config.yaml" "$folder/release/$name.yaml"
  cp "$folder/$name/log.jsonl" "$folder/release/$name.log.jsonl"
}

if [ "$name" = lte-radiance ]; then
  make_data glossy glossy
  make_data glossy_test glossy_test
  train lte_radiance glossy
  "$bin/lte_eval" incident --checkpoint "$folder/release/$name.safetensors" \
    --data "$folder/glossy_test" --split test --report "$folder/release/$name"
  exit
fi

make_data boxes boxes_many
make_data open boxes_open
make_data sky boxes_sky
make_data shut boxes_shut
make_data homes homes_many
make_data daylight homes_daylight
make_data boxes_test boxes_test
if [ ! -f "$folder/base/dataset.json" ]; then
  rm -rf "$folder/base"
  "$bin/lte_datagen" join "$folder/boxes" "$folder/open" "$folder/sky" "$folder/shut" \
    "$folder/homes" "$folder/daylight" --out "$folder/base"
fi
train "${name//-/_}" base
"$bin/lte_eval" --fit-baselines "$folder/base" --out "$folder/release/$name.baselines.json"
"$bin/lte_eval" --checkpoint "$folder/release/$name.safetensors" --split test
"$bin/lte_eval" --checkpoint "$folder/release/$name.safetensors" --data "$folder/boxes_test" \
  --split test
