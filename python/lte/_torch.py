"""The program of lte-torch, and the torch whose libraries it runs with. Neither is imported."""

import os
import pathlib
import re
from importlib.util import find_spec


class Torch:
    """What was found: a program, or advice to the user."""

    def __init__(self) -> None:
        self.program, self.advice = "", ""
        self.libraries = ""  #: LD_LIBRARY_PATH of the program
        if find_spec("lte_torch") is None:
            self.advice = "pip install lte[torch]"
            return
        import lte_torch
        spec = find_spec("torch")
        folder = pathlib.Path(spec.origin).parent if spec and spec.origin else None
        version = _version(folder) if folder else None
        if folder is None or version is None:
            self.advice = f"torch is not installed: pip install 'torch=={lte_torch.torch}.*'"
        elif version.split(".")[:2] != lte_torch.torch.split("."):
            self.advice = (f"lte-torch is built for torch {lte_torch.torch}, and torch {version} "
                           f"is installed: pip install 'torch=={lte_torch.torch}.*'")
        else:
            self.program = str(lte_torch.program)
            # Wherever each was installed; the wheel of lte has Embree and others.
            ours = pathlib.Path(__file__).parents[1] / "lte.libs"
            paths = [str(folder / "lib"), str(ours)]
            if earlier := os.environ.get("LD_LIBRARY_PATH"):
                paths.append(earlier)
            self.libraries = ":".join(paths)


def _version(folder: pathlib.Path) -> str | None:
    try:
        text = (folder / "version.py").read_text()
    except OSError:
        return None
    found = re.search(r"^__version__ = '([^'+]+)", text, re.MULTILINE)
    return found.group(1) if found else None
