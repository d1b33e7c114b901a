"""Networks that have learnt light, and what they have encoded."""

from __future__ import annotations

import functools
import pathlib
from typing import TYPE_CHECKING, Literal, TypeAlias, overload

from lte import _lte
from lte._arguments import Path, choice, path_text, seed_number, whole
from lte._scene import Scene, made_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from lte._arrays import Floats

Integrator: TypeAlias = Literal["gather", "network", "path"]


class Model:
    """A network that has learnt light. Threads may use one at the same time."""

    def __init__(self, made: _lte.Model) -> None:
        self._made = made

    def __repr__(self) -> str:
        return f"<lte.Model {self.name!r}: {self.parameters} parameters>"

    @staticmethod
    def load(path: Path | None = None, *, precision: Literal["fp32", "bf16"] = "fp32") -> Model:
        """Reads a .safetensors, or a shipped model by its name, such as "lte-radiance"; by default
        lte, which comes with the package.

        Raises lte.Error, which names the file, if it is missing, damaged, or no model.
        """
        return Model(_lte.load_model("" if path is None else _file(path),
                                     choice("precision", precision, "fp32", "bf16")))

    @property
    def name(self) -> str:
        return pathlib.Path(self._made.path).stem

    @property
    def parameters(self) -> int:
        return self._made.parameters

    def encode(self, scene: Scene, *, scene_points: int | None = None,
               seed: int = 0) -> Embedding:
        """The scene as the network sees it, by default from as many points as it needs."""
        points = 0 if scene_points is None else whole("scene_points", scene_points, 1, 1 << 28)
        return Embedding(self, scene, points, seed_number(seed))


class Embedding:
    """A scene, in the light of that moment, which Model.encode() has encoded. Threads may ask at
    the same time.
    """

    def __init__(self, model: Model, scene: Scene, points: int, seed: int) -> None:
        self.scene = scene
        self._lit = made_of(scene)
        self._seed = seed
        self._made = model._made.encode(self._lit, points, seed)

    @property
    def scene_points(self) -> int:
        return self._made.scene_points

    @overload
    def irradiance(self, points: ArrayLike, normals: ArrayLike, *, albedo: ArrayLike | None = None,
                   direct: bool = False, error: Literal[False] = False) -> Floats: ...
    @overload
    def irradiance(self, points: ArrayLike, normals: ArrayLike, *, albedo: ArrayLike | None = None,
                   direct: bool = False, error: Literal[True]) -> tuple[Floats, Floats]: ...
    def irradiance(self, points: ArrayLike, normals: ArrayLike, *, albedo: ArrayLike | None = None,
                   direct: bool = False, error: bool = False) -> Floats | tuple[Floats, Floats]:
        """Indirect irradiance [N, 3], W/m², as the network says it, in microseconds a point.

        `albedo` [N, 3] is by default that of the surfaces. `direct` adds light straight from lamps,
        by 256 rays a point. `error` also gives [N], the root mean square error to expect, W/m²:
        what the embedding and gathered light differ by at the nearest of some hundred places; all
        of the answer where no light comes. lte.irradiance() has light that rays gather, nearer to
        the truth.
        """
        from lte._arrays import colors, surface
        at, side = surface(points, normals)
        color = None if albedo is None else colors("albedo", albedo, len(at))
        if not direct and not error:
            return self._made.decode(self._lit, at, side, color)
        light, off = self._made.answer(self._lit, at, side, color, bool(direct),
                                       bool(error), self._seed)
        return (light, off) if error else light


def integrator_word(word: str) -> str:
    return choice("integrator", word, "gather", "network", "path")


def network_of(integrator: str, model: Model | None) -> _lte.Model | None:
    """What the module takes for the model: None unless the integrator is network."""
    if model is not None and not isinstance(model, Model):
        raise TypeError(f"model: expected lte.Model, got {type(model).__name__}")
    if integrator != "network":
        if model is not None:
            raise ValueError('model goes with integrator="network"')
        return None
    return (model or _default_model())._made


@functools.cache
def _default_model() -> Model:
    return Model.load()


def _file(path: Path) -> str:
    text = path_text(path)
    if not text:
        raise ValueError("path: expected a file or the name of a model, got nothing")
    return text
