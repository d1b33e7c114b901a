"""The command-line tools as one program: `lte render room.glb`, or `python -m lte`."""

import os
import pathlib
import sys

from lte import __version__
from lte._lte import run_tool

COMMANDS = {
    "render": (["lte_render"], "a picture of a scene, or a video"),
    "view": (["lte_view"], "fly through a scene in the browser, dim lamps, move things"),
    "probe": (["lte_probe"], "light at the points of a table"),
    "bake": (["lte_bake"], "light maps, without a GPU"),
    "data": (["lte_datagen"], "scenes and training data"),
    "info": (["lte_datagen", "info"], "what is in a scene or a data set"),
}


def usage() -> str:
    lines = [f"  lte {name:<7} {about}" for name, (_, about) in COMMANDS.items()]
    return "\n".join(["usage: lte COMMAND ...; each COMMAND has --help", *lines])


def main() -> int:
    words = sys.argv[1:]
    if words in (["--version"], ["--help"], ["-h"]):
        print(f"lte {__version__}" if words == ["--version"] else usage())
        return 0
    if not words or words[0] not in COMMANDS:
        print(f"lte: there is no command {words[0]}" if words else usage(), file=sys.stderr)
        return 2
    os.environ.setdefault("LTE_VIEW_PAGE", str(pathlib.Path(__file__).parent / "view"))
    return int(run_tool([*COMMANDS[words[0]][0], *words[1:]]))


if __name__ == "__main__":
    sys.exit(main())
