"""lte.train() and the run that it gives. What runs it is imported when there is a run."""

from __future__ import annotations

import pathlib
from typing import Literal

from lte._arguments import Path, choice, path_text, seed_number, whole


class Training:
    """A training run, which begins with the first step that is asked for: (step, mean loss since
    the step before).

    Ctrl-C, close(), and the end of a `with` finish the step that is at work and write a checkpoint,
    from which train(resume=True) goes on.
    """

    def __init__(self, folder: pathlib.Path, words: list[str]) -> None:
        from lte._training_process import steps
        self.folder = folder
        self.model = folder / "model.safetensors"  #: for Model.load(), once there was a checkpoint
        self._steps = steps(folder, words)

    def __iter__(self) -> Training:
        return self

    def __next__(self) -> tuple[int, float]:
        return next(self._steps)

    def __enter__(self) -> Training:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()

    def close(self) -> None:
        self._steps.close()


def train(config: Path, *, data: Path | None = None, out: Path | None = None,
          steps: int | None = None, set: dict[str, object] | None = None, resume: bool = False,
          seed: int | None = None, device: Literal["cpu", "cuda"] = "cpu") -> Training:
    """Trains as `lte_train` does, and yields (step, loss) where its log has a line.

    `data` is a folder of generate_dataset(); `data`, `steps` and `set` override keys of the
    config; `out` is the run's folder. The key train.log_every is the steps between lines. Needs
    lte[torch]. Raises lte.Error, as the tool's line, for what cannot be trained.
    """
    from lte._training_process import output_folder
    words = ["--config", path_text(config), "--device", choice("device", device, "cpu", "cuda")]
    keys: dict[str, object] = {} if data is None else {"data.root": path_text(data)}
    if steps is not None:
        keys["train.steps"] = whole("steps", steps, 1, 1 << 40)
    for key, value in {**keys, **(set or {})}.items():
        words += ["--set", f"{key}={value}"]
    if seed is not None:
        words += ["--seed", str(seed_number(seed))]
    if out is not None:
        words += ["--out", path_text(out)]
    folder = output_folder(words)
    return Training(folder, [*words, "--resume"] if resume else words)
