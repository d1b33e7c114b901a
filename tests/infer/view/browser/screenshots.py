#!/usr/bin/env python3
"""Pictures of lte_view's page in several sizes, for docs/images and for looking at.

usage: screenshots.py BUILD SCENE FOLDER [--size WxH]

docs/images/view.jpg is view.jpg of the living room at 800x600.
"""
import argparse
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from devtools import Browser, Page  # noqa: E402
from page_test import READY, settled  # noqa: E402
from view_server import ViewServer  # noqa: E402

SELECT = """(() => {
  const lamp = lteView.store.scene.objects.findIndex((o) => o.name.includes("piece 9"));
  if (lamp >= 0) lteView.store.select(lamp);
})()"""


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("scene")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", default="640x480")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    server = ViewServer(pathlib.Path(args.build) / "bin/lte_view", args.scene, "--size", args.size)
    browser = Browser()
    try:
        page = Page(browser)
        page.open(server.address)
        page.wait("globalThis.lteView?.store?.header?.pass >= 26", seconds=600)  # before paths
        page.evaluate(SELECT)
        time.sleep(0.5)
        page.screenshot(args.folder / "view.jpg")
        page.wait(READY, what="the first finished picture", seconds=600)
        page.screenshot(args.folder / "lights.png")
        page.evaluate("document.querySelector('[data-tab=objects]').click()")
        time.sleep(0.3)
        page.screenshot(args.folder / "objects.png")
        page.evaluate("document.querySelector('[data-tab=view]').click()")
        page.evaluate("document.querySelector('[data-shown=difference]').click()")
        page.wait("lteView.store.header.shown === 'difference' && lteView.store.header.paths >= 2",
                  seconds=120)
        time.sleep(0.3)
        page.screenshot(args.folder / "difference.png")
        page.evaluate("document.querySelector('[data-shown=full]').click()")
        page.evaluate("document.querySelector('[data-tab=materials]').click()")
        settled(page)
        sizes = {"tablet": (820, 1180), "wide": (1180, 820), "phone": (390, 844)}
        for name, (width, height) in sizes.items():
            page.resize(width, height, touch=True)
            time.sleep(0.6)
            page.screenshot(args.folder / f"{name}.png")
        page.resize(1280, 720)
        page.evaluate("document.getElementById('help').showModal()")
        time.sleep(0.3)
        page.screenshot(args.folder / "help.png")
        print("errors:", page.errors)
    finally:
        browser.close()
        server.stop()


if __name__ == "__main__":
    main()
