#!/usr/bin/env bash
# The environment of make_rooms.py: Infinigen and Blender as a module, from PyPI, in
# out/infinigen-venv. Needs Python 3.11, 2 GB of disk. Idempotent.
#
#   PYTHON=python3.11 scripts/assets/infinigen/setup.sh
#
# Infinigen's wheel asks for scikit-image < 0.20, of which there is no wheel for Python 3.11, so it
# is installed without its dependencies and they are named here.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

readonly python=${PYTHON:-python3.11} venv=out/infinigen-venv
"$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' ||
  { echo "setup: Infinigen needs Python 3.11; set PYTHON to one" >&2; exit 1; }
[ -x "$venv/bin/python" ] || "$python" -m venv "$venv"
"$venv/bin/python" -m pip install --quiet bpy==4.2.0 coacd \
  DracoPy==2.2.0 'gin_config>=0.5.0' 'imageio<2.32.0' \
  matplotlib networkx 'numpy<2' 'opencv-python<4.9.0' pandas psutil scikit-image==0.20.0 \
  'scikit-learn<1.4.0' scipy 'shapely<=2.0.5' tqdm 'trimesh<3.23.0' OpenEXR submitit geomdl \
  python-fcl rtree
"$venv/bin/python" -m pip install --quiet --no-deps infinigen==1.15.5
"$venv/bin/python" -c 'import bpy, infinigen
print("setup: Infinigen", infinigen.__version__, "with Blender", bpy.app.version_string)'
