"""Training by the program of lte-torch."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import tempfile
import time
from collections.abc import Generator
from typing import Any

from lte._lte import Error
from lte._torch import Torch


def command(words: list[str]) -> tuple[list[str], dict[str, str]]:
    """What runs `lte train`, and its environment."""
    torch = Torch()
    if not torch.program:
        raise Error(f"train: {torch.advice}")
    return [torch.program, "train", *words], {**os.environ, "LD_LIBRARY_PATH": torch.libraries}


def output_folder(words: list[str]) -> pathlib.Path:
    """The run's folder, as the configuration has it, which this checks."""
    line, environment = command([*words, "--print-config"])
    checked = subprocess.run(line, env=environment, text=True, capture_output=True)
    if checked.returncode:
        raise Error(_problem(checked.stderr))
    for row in checked.stdout.splitlines():
        if row.startswith("output: "):
            text = row.removeprefix("output: ").strip()
            return pathlib.Path(json.loads(text) if text.startswith('"') else text)
    raise Error("train: the configuration names no output: out= does")


def steps(folder: pathlib.Path, words: list[str]) -> Generator[tuple[int, float], None, None]:
    """Runs, and yields what log.jsonl says of training. Ends the run when it is closed."""
    log = _Log(folder / "log.jsonl")
    line, environment = command(words)
    with tempfile.TemporaryFile("w+") as said:
        # A session of its own: Ctrl-C comes once, from here.
        run = subprocess.Popen(line, env=environment, stdout=subprocess.DEVNULL, stderr=said,
                               start_new_session=True)
        try:
            ended = False
            while not ended:
                ended = run.poll() is not None
                for about in log.read():
                    if about.get("loss") is not None:
                        yield about["step"], about["loss"]
                if not ended:
                    time.sleep(0.05)
        finally:
            if run.poll() is None:
                run.terminate()  # the step ends, and a checkpoint is written
                run.wait()
        if run.returncode:
            said.seek(0)
            raise Error(_problem(said.read()))


class _Log:
    """Lines that come to a log. One that goes on begins as its checkpoint has it, maybe shorter."""

    def __init__(self, path: pathlib.Path) -> None:
        self._path, self._at, self._known = path, 0, frozenset[bytes]()
        self._known = frozenset(self._lines())
        self._at = 0

    def read(self) -> list[dict[str, Any]]:
        lines = [line for line in self._lines() if line not in self._known]
        if not lines:
            self._at = 0 if self._known else self._at
        else:
            self._known = frozenset()
        return [json.loads(line) for line in lines]

    def _lines(self) -> list[bytes]:
        try:
            with open(self._path, "rb") as file:
                file.seek(self._at)
                whole, newline, _ = file.read().rpartition(b"\n")
        except OSError:  # not yet there, or never: the program says why
            return []
        self._at += len(whole) + len(newline)
        return whole.splitlines()


def _problem(said: str) -> str:
    lines = said.strip().splitlines() or ["train: ended without a word"]
    return lines[-1].removeprefix("lte_train: ").removeprefix("error: ")
