#!/usr/bin/env python3
"""What headless Chromium shows of a folder that lte_bake --format three has written.

usage: three_picture.py FOLDER VIEW.json OUT.png

VIEW.json has width, height and exposure (a factor before the sRGB curve); origin, target and vfov
of a camera, if it is not the page's own; and maybe a list of gains of the layers: a second picture,
OUT.gains.png, is by these.
The exit code is 77 where there is no Chromium.
"""
import base64
import functools
import http.server
import json
import pathlib
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "infer/view/browser"))
from devtools import Browser, Page, find_browser  # noqa: E402

SKIPPED = 77
SHOW = """(({origin, target, vfov, exposure}, gains) => {
  const {renderer, camera, controls, addLayers, draw} = lteBake;
  renderer.toneMappingExposure = exposure;
  if (origin) {
    camera.fov = vfov;
    camera.position.set(...origin);
    controls.target.set(...target);
    controls.update();
  }
  if (gains) addLayers(gains);
  draw();
  return renderer.domElement.toDataURL("image/png");
})"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def main(folder, view, out):
    if not find_browser():
        return SKIPPED
    view = json.loads(pathlib.Path(view).read_text())
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0),
                                             functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    # WebGL by the processor.
    browser = Browser("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
    try:
        page = Page(browser, view["width"], view["height"])
        page.open(f"http://127.0.0.1:{server.server_port}/")
        page.wait("globalThis.lteBake !== undefined", what="the page")
        for gains, name in ((None, out), (view.get("gains"), out.replace(".png", ".gains.png"))):
            if gains is None and name != out:
                continue
            picture = page.evaluate(f"{SHOW}({json.dumps(view)}, {json.dumps(gains)})")
            pathlib.Path(name).write_bytes(base64.b64decode(picture.split(",")[1]))
        # Chromium looks for an icon by itself.
        errors = [line for line in page.errors if "favicon" not in line]
        assert not errors, errors
    finally:
        browser.close()
        server.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
