#!/usr/bin/env python3
"""Bakes the light of a scene into a texture, and shows the scene with it in the browser.

    bake_and_view.py [SCENE] [--out baked] [--texels-per-metre 16] [--three three.module.js]

The page needs three.js as an ES module with GLTFLoader and OrbitControls. Without it a GLB is
written that any viewer of glTF shows with its light, baked/scene_unlit.glb.
"""
import argparse
import functools
import http.server
import sys
import webbrowser

import lte
import numpy as np

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("scene", nargs="?", default=lte.living_room)
parser.add_argument("--out", default="baked")
parser.add_argument("--texels-per-metre", type=float, default=16)
parser.add_argument("--three", help="three.js; then a page is served until Ctrl-C")
parser.add_argument("--once", action="store_true", help="serve one request")
options = parser.parse_args([] if hasattr(sys, "ps1") else None)  # none in notebooks

scene = lte.load(options.scene)
baked = lte.bake(scene, texels_per_metre=options.texels_per_metre)
baked.save(options.out, format="three" if options.three else "gltf", three=options.three or "")
lit = baked.mask == lte.LightMap.LIT
height, width = lit.shape
print(f"{options.out}: {width} x {height}, {np.count_nonzero(lit)} texels with light, "
      f"{baked.irradiance[lit].mean():.2f} W/m² each, expected error "
      f"{100 * baked.expected_error:.0f} %")

if options.three:
    serve = functools.partial(http.server.SimpleHTTPRequestHandler, directory=options.out)
    with http.server.HTTPServer(("127.0.0.1", 0), serve) as server:
        address = f"http://127.0.0.1:{server.server_port}/index.html"
        print(address, flush=True)
        if options.once:
            server.handle_request()
        else:
            webbrowser.open(address)
            server.serve_forever()
