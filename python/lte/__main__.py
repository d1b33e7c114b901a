"""The command-line tools as one program: `lte render room.glb`, or `python -m lte`."""

import os
import pathlib
import sys

from lte._lte import run_command
from lte._torch import Torch

FOLDER = pathlib.Path(__file__).parent


def main() -> int:
    os.environ.setdefault("LTE_VIEW_PAGE", str(FOLDER / "view"))
    torch = Torch()
    return int(run_command(["lte", *sys.argv[1:]], torch.program, torch.libraries, torch.advice))


if __name__ == "__main__":
    sys.exit(main())
