#!/usr/bin/env python3
"""The page of lte_view in a real browser: headless Chromium, driven through DevTools.

usage: page_test.py BUILD [--screenshots FOLDER]

The exit code is 77, skipped, where there is no Chromium (Debian's package `chromium`).
"""
import argparse
import json
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from devtools import Browser, Page, find_browser  # noqa: E402
from view_server import ViewServer  # noqa: E402

SKIPPED = 77
ROOT = pathlib.Path(__file__).resolve().parents[4]
SCENE = ROOT / "assets/scenes/cornell_box.glb"
SIZE = "96x72"

# Linear light of the picture on the screen, as a list of RGB triples.
PIXELS = """(() => {
  const canvas = lteView.picture.picture;
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return [...data].filter((_, i) => i % 4 !== 3);
})()"""
READY = "globalThis.lteView?.caughtUp()"
CAMERA = "JSON.stringify(lteView.store.header.camera)"


def linear(byte):
    x = byte / 255
    return x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055)**2.4


def check(condition, text):
    if not condition:
        raise AssertionError(text)
    print(f"page_test: {text}", flush=True)


def settled(page):
    """Waits for the finished picture of all that was done so far."""
    time.sleep(0.1)  # messages go out with the next frame
    page.wait(READY, what="a finished picture")


def stage(page):
    return page.evaluate("""(() => {
      const box = document.getElementById("overlay").getBoundingClientRect();
      return [box.left, box.top, box.width, box.height];
    })()""")


def at(page, x, y):
    left, top, width, height = stage(page)
    return left + x * width, top + y * height


def set_input(page, selector, value):
    page.evaluate(f"""(() => {{
      const input = document.querySelector({json.dumps(selector)});
      input.value = {json.dumps(str(value))};
      for (const kind of ["input", "change"])
        input.dispatchEvent(new Event(kind, {{bubbles: true}}));
    }})()""")


def loads(page, server):
    page.open(server.address)
    page.wait(READY, what="the first finished picture")
    check(page.evaluate("document.getElementById('scene-name').textContent") == "cornell_box",
          "the page names the scene")
    check(page.evaluate("document.querySelectorAll('#outputs button').length") == 8,
          "eight outputs are offered")
    check(page.evaluate("document.querySelectorAll('.light').length") == 1, "one light is listed")
    check("gathered from traced light" in page.evaluate(
        "document.querySelector('#meter .answered').textContent"), "the meter says who answers")
    check("of traced" in page.evaluate("document.querySelector('#meter .check').textContent"),
          "the meter says how far it is from traced light")


def moves_the_camera(page):
    before = page.evaluate(CAMERA)
    page.drag(at(page, 0.5, 0.5), at(page, 0.7, 0.55))
    settled(page)
    turned = page.evaluate(CAMERA)
    check(turned != before, "a drag turns the camera")
    page.drag(at(page, 0.5, 0.5), at(page, 0.4, 0.5), button="right")
    settled(page)
    looked = json.loads(page.evaluate(CAMERA))
    check(looked["origin"] == json.loads(turned)["origin"] and
          looked["target"] != json.loads(turned)["target"], "a right drag looks around in place")
    page.key("KeyW", "w", seconds=0.3)
    settled(page)
    flown = json.loads(page.evaluate(CAMERA))
    ahead = [b - a for a, b in zip(looked["origin"], looked["target"])]
    way = [b - a for a, b in zip(looked["origin"], flown["origin"])]
    check(sum(a * b for a, b in zip(ahead, way)) > 0, "W flies ahead")
    page.key("Home", "Home")
    settled(page)
    back = json.loads(page.evaluate(CAMERA))
    first = json.loads(before)
    check(max(abs(a - b) for a, b in zip(back["origin"], first["origin"])) < 1e-4,
          "Home leads back to the first camera")


def shines_as_linear_light_says(page):
    set_input(page, "#view input[type=range]", -1)  # nothing but the lamp is clipped
    settled(page)
    bright = page.evaluate(PIXELS)
    set_input(page, ".light input[type=range]", 0.5)
    page.wait("lteView.store.scene.lights[0].gain === 0.5")
    settled(page)
    dim = page.evaluate(PIXELS)
    pairs = [(linear(a), linear(b)) for a, b in zip(bright, dim) if 60 < a < 250 and 30 < b < 250]
    ratio = sum(b for _, b in pairs) / sum(a for a, _ in pairs)
    check(len(pairs) > 5000 and abs(ratio - 0.5) < 0.015,
          f"half the gain is half the light ({ratio:.4f} over {len(pairs)} values)")
    page.key("KeyZ", "z", modifiers=2)
    page.wait("lteView.store.scene.lights[0].gain === 1", what="undo")
    settled(page)
    again = page.evaluate(PIXELS)
    check(sum(abs(a - b) for a, b in zip(again, bright)) / len(bright) < 1, "undo brings it back")
    set_input(page, "#view input[type=range]", 0)


def selects_and_moves(page):
    settled(page)
    x, y = page.evaluate("""(() => {
      // The middle of the smallest object that a click on it meets.
      const s = lteView.store.scene.objects.map((o, i) => [i, o])
        .filter(([, o]) => !o.shines)
        .sort(([, a], [, b]) => Math.max(...a.high.map((h, k) => h - a.low[k]))
                              - Math.max(...b.high.map((h, k) => h - b.low[k])));
      const o = s[0][1], m = o.low.map((l, k) => (l + o.high[k]) / 2);
      m[1] = o.low[1] + 0.9 * (o.high[1] - o.low[1]);
      return lteView.project(lteView.store.header.camera, lteView.picture.aspect, m);
    })()""")
    page.click(*at(page, x, y))
    page.wait("lteView.store.object >= 0", what="a click selects an object")
    check(page.evaluate("!document.querySelector('#objects .card').hidden"),
          "a click selects an object and shows its card")
    before = page.evaluate("lteView.store.selected().move")
    page.drag(at(page, x, y), at(page, x + 0.08, y), steps=5)
    page.wait("lteView.store.undo", what="the move has been made")
    settled(page)
    moved = page.evaluate("lteView.store.selected().move")
    check(moved != before and abs(moved[1]) < 1e-6, "a drag moves it across the floor")
    set_input(page, "#objects .card .pair input", 30)
    page.wait("lteView.store.selected().turn === 30")
    settled(page)
    picked = page.evaluate(
        "lteView.store.header.handled[lteView.store.client][1] > 0")
    check(picked, "numbers turn it, and a picture shows that")


def adds_and_removes(page):
    settled(page)
    count = "lteView.store.scene.{}.length"
    objects, lights = page.evaluate(count.format("objects")), page.evaluate(count.format("lights"))
    number = page.evaluate("lteView.store.selected().object")
    page.key("KeyD", "d", modifiers=2)
    page.wait(f"{count.format('objects')} === {objects + 1}", what="a copy of the object")
    page.wait(f"lteView.store.selected() && lteView.store.selected().object !== {number}",
              what="the copy is selected")
    settled(page)
    copy = page.evaluate("lteView.store.selected().object")
    page.key("Delete", "Delete")
    page.wait(f"{count.format('objects')} === {objects}", what="the copy is gone")
    check(page.evaluate(f"lteView.store.placeOf('object', {copy})") == -1 and
          page.evaluate(f"lteView.store.placeOf('object', {number})") >= 0,
          "Ctrl+D copies the selected object, Delete removes the copy alone")
    settled(page)
    dark = sum(linear(value) for value in page.evaluate(PIXELS))
    page.evaluate("document.querySelector('[data-add=point]').click()")
    page.wait(f"{count.format('lights')} === {lights + 1}", what="a lamp more")
    settled(page)
    bright = sum(linear(value) for value in page.evaluate(PIXELS))
    check(1.02 * dark < bright < 4 * dark,
          f"a lamp that is added gives light as the others do ({bright / dark:.2f} times)")
    page.evaluate("[...document.querySelectorAll('.light .remove')].pop().click()")
    page.wait(f"{count.format('lights')} === {lights}", what="the lamp is gone")
    settled(page)
    again = sum(linear(value) for value in page.evaluate(PIXELS))
    check(abs(again / dark - 1) < 0.01, "without it the picture is as before")
    page.key("KeyZ", "z", modifiers=2)
    page.wait(f"{count.format('lights')} === {lights + 1}", what="undo brings the lamp back")
    page.key("KeyZ", "z", modifiers=2)
    page.wait(f"{count.format('lights')} === {lights}", what="undo takes it away again")
    check(True, "lamps and objects come and go by undo, too")


def saves_whole_pictures(page):
    """Also while the camera moves, when a draft is on the screen."""
    page.evaluate("""(() => {
      globalThis.saved = [];
      const address = URL.createObjectURL;
      URL.createObjectURL = (blob) => {
        blob.arrayBuffer().then((bytes) => {
          const header = new DataView(bytes);
          saved.push([header.getUint32(16), header.getUint32(20)]);  // of a PNG
        });
        return address(blob);
      };
      lteView.send({ type: "view", size: [640, 480] });
    })()""")
    page.wait("lteView.store.header.size[0] === 640", what="a larger view")
    page.evaluate("""(() => {
      const { origin, target, up, vfov } = lteView.store.camera;
      for (let i = 1; i <= 5; ++i) {
        lteView.send({ type: "camera", origin, target, up, vfov: vfov - 0.1 * i });
        if (i === 3) document.querySelector('[data-save=png]').click();
      }
    })()""")
    page.wait("saved.length === 1", what="a saved picture", seconds=120)
    check(page.evaluate("saved[0].join('x')") == "640x480",
          "a picture that is saved while the camera moves has the size of the view")
    width, height = SIZE.split("x")
    page.evaluate(f"lteView.send({{ type: 'view', size: [{width}, {height}] }})")
    page.key("Home", "Home")
    settled(page)


def shows_outputs(page):
    for shown in ("direct", "irradiance", "albedo", "normal", "indirect", "full"):
        page.evaluate(f"document.querySelector('[data-shown={shown}]').click()")
        page.wait(f"lteView.store.header.shown === '{shown}'")
    page.evaluate("document.querySelector('[data-shown=difference]').click()")
    page.wait("lteView.store.header.shown === 'difference' && lteView.store.header.paths > 0")
    check(True, "all outputs are shown, and a difference has paths")
    page.evaluate("document.querySelector('[data-shown=full]').click()")
    settled(page)


def fits(page):
    """Nothing overflows, and picture and panel can be seen, in three sizes."""
    for width, height, touch in ((1280, 720, False), (820, 1180, True), (390, 844, True)):
        page.resize(width, height, touch)
        time.sleep(0.5)
        wide = page.evaluate("document.documentElement.scrollWidth")
        left, top, w, h = stage(page)
        check(wide <= width and w >= 0.6 * min(width, 1280 - 320) * 0.5 and left >= 0 and h > 100,
              f"the page fits {width} x {height}")
    page.resize(1280, 720)
    time.sleep(0.3)


def comes_back(page, server, tool):
    code = server.stop()
    check(code == 0, "Ctrl-C ends the server with 0")
    page.wait("document.body.dataset.phase === 'lost'", what="the page says that it is alone")
    again = ViewServer(tool, SCENE, "--size", SIZE, "--threads", 2, port=server.port)
    page.wait(READY, what="the page is back after the server's restart")
    check(page.evaluate("lteView.store.scene.objects.every((o) => o.turn === 0)"),
          "after a restart the page shows the new server's scene")
    return again


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("--screenshots", help="where to leave pictures of the page")
    args = parser.parse_args()
    if not find_browser():
        print("page_test: skipped, as there is no Chromium")
        return SKIPPED
    tool = pathlib.Path(args.build) / "bin/lte_view"
    server = ViewServer(tool, SCENE, "--size", SIZE, "--threads", 2)
    browser = Browser()
    try:
        page = Page(browser)
        loads(page, server)
        moves_the_camera(page)
        shines_as_linear_light_says(page)
        selects_and_moves(page)
        adds_and_removes(page)
        saves_whole_pictures(page)
        shows_outputs(page)
        fits(page)
        check(not page.errors, f"no errors in the console {page.errors or ''}")
        server = comes_back(page, server, tool)
        if args.screenshots:
            page.screenshot(pathlib.Path(args.screenshots) / "page.png")
    finally:
        browser.close()
        server.stop()
    print("page_test: passed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
