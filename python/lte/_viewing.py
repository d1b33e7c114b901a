"""The live view, as a process of its own."""

from __future__ import annotations

import pathlib
import re
import subprocess
import sys
import tempfile
from typing import Any

from lte._lte import Error


class View:
    """A page that shows a scene until close(), or the end of a `with`."""

    def __init__(self, scene: Any) -> None:
        self._folder = tempfile.TemporaryDirectory()
        file = pathlib.Path(self._folder.name) / "scene.glb"
        try:
            scene.save(file)
            self._server = subprocess.Popen(
                [sys.executable, "-m", "lte", "view", str(file), "--port", "0"], text=True,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
        except BaseException:
            self._folder.cleanup()
            raise
        self.url = ""  #: where a browser finds it
        last = ""
        assert self._server.stdout
        for line in self._server.stdout:
            last = line.strip() or last
            if found := re.search(r"http://\S+", line):
                self.url = found.group(0)
                return
        self.close()
        raise Error(f"view: {last}")

    def close(self) -> None:
        if self._server.poll() is None:
            self._server.terminate()
        self._server.communicate()
        self._folder.cleanup()

    def __enter__(self) -> View:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()
