#!/bin/sh
# The command-line tools as one program: `lte render room.glb` is `lte_render room.glb`.
here=$(dirname -- "$(readlink -f -- "$0")")
usage() {
  echo "usage: lte COMMAND ...; each COMMAND has --help"
  for line in "render   a picture of a scene, or a video" \
    "view     fly through a scene in the browser, dim lamps, move things" \
    "probe    light at the points of a table" \
    "bake     light maps of a scene" \
    "data     scenes and training data" \
    "info     what is in a scene or a data set"; do
    echo "  lte $line"
  done
}
case "${1-}" in
  --version) "$here/lte_render" --version | sed 's/^lte_render/lte/' ;;
  --help | -h) usage ;;
  "") usage >&2; exit 2 ;;
  render | view | probe | bake) tool=lte_$1; shift; exec "$here/$tool" "$@" ;;
  data) shift; exec "$here/lte_datagen" "$@" ;;
  info) exec "$here/lte_datagen" "$@" ;;
  *) echo "lte: there is no command $1" >&2; exit 2 ;;
esac
