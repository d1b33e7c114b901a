"""Scenes, their lamps and cameras."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

from lte import _lte
from lte._arguments import Path, choice, number, path_text, seed_number, whole

if TYPE_CHECKING:
    from lte._arrays import Floats


class Camera(NamedTuple):
    """A perspective camera; `vfov` is its vertical angle of view in degrees."""

    origin: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float] | None = None  #: by default +Y, or what suits a view along it
    vfov: float = 45


class Lamp:
    """A light of a scene: a shining surface, a point, spot or sun, or the sky."""

    def __init__(self, scene: Scene, number: int) -> None:
        self._scene, self._number = scene, number

    def __repr__(self) -> str:
        return f"<lte.Lamp {self.name!r}, gain {self.gain:g}>"

    @property
    def name(self) -> str:
        return self._scene._names[self._number]

    @property
    def gain(self) -> float:
        """A factor on its emission in all that follows, 1 at first: exact, as light is linear.

        Work that has begun, and what a network has encoded, keep the gain before.
        """
        return self._scene._gains[self._number]

    @gain.setter
    def gain(self, gain: float) -> None:
        self._scene._set_gain(self._number, number("gain", gain, 0, 1e6))


class Lamps(Sequence[Lamp]):
    """The lamps of a scene by number, in the order of irradiance by lamp, or by name."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def __len__(self) -> int:
        return len(self._scene._names)

    @overload
    def __getitem__(self, lamp: int | str) -> Lamp: ...
    @overload
    def __getitem__(self, lamp: slice) -> list[Lamp]: ...
    def __getitem__(self, lamp: int | str | slice) -> Lamp | list[Lamp]:
        names = self._scene._names
        if isinstance(lamp, slice):
            return [Lamp(self._scene, i) for i in range(len(names))[lamp]]
        if isinstance(lamp, str):
            if (count := names.count(lamp)) > 1:
                raise KeyError(f"{count} lights are named {lamp!r}: take one by its number")
            if not count:
                raise KeyError(f"there is no light {lamp!r}, but {', '.join(names[:9]) or 'none'}")
            return Lamp(self._scene, names.index(lamp))
        return Lamp(self._scene, range(len(names))[lamp])

    def __iter__(self) -> Iterator[Lamp]:
        return (Lamp(self._scene, i) for i in range(len(self)))

    def __contains__(self, lamp: object) -> bool:
        if isinstance(lamp, Lamp):
            return lamp._scene is self._scene
        return lamp in self._scene._names

    def __repr__(self) -> str:
        return repr(list(self))

    def add_panel(self, *, auto: Literal[True] = True) -> list[Lamp]:
        """Adds what `--add-light auto` does: a panel under the ceiling of each room, or a sky where
        there is no room. Returns the lamps that were added.
        """
        if auto is not True:
            raise ValueError("auto: expected True: load(add_light=\"x,y,z,W\") has lamps at places")
        before = len(self)
        self._scene._add_light("auto")
        return self[before:]


class Scene:
    """A scene with what all questions about it share. Threads may ask at the same time."""

    def __init__(self, made: _lte.Scene) -> None:
        self._lock = threading.Lock()  # of those who change light
        self._bright, self._names = made, list(made.lights)
        self._gains = (1.0,) * len(self._names)
        self._dimmed: tuple[tuple[float, ...], _lte.Scene] | None = None

    @property
    def _made(self) -> _lte.Scene:
        """The module's, with the gains of now."""
        with self._lock:
            if all(gain == 1 for gain in self._gains):
                return self._bright
            if self._dimmed is None or self._dimmed[0] != self._gains:
                self._dimmed = self._gains, self._bright.dimmed(self._gains)
            return self._dimmed[1]

    def _set_gain(self, lamp: int, gain: float) -> None:
        with self._lock:
            self._gains = *self._gains[:lamp], gain, *self._gains[lamp + 1:]

    def _add_light(self, light: str) -> None:
        with self._lock:
            self._bright, self._dimmed = self._bright.with_light(light), None
            names = list(self._bright.lights)
            self._gains += (1.0,) * (len(names) - len(self._names))
            self._names = names

    def __repr__(self) -> str:
        return f"<lte.Scene {self.name!r}: {self.triangles} triangles, {len(self.lights)} lights>"

    @property
    def name(self) -> str:
        return self._bright.name

    @property
    def triangles(self) -> int:
        return self._bright.triangles

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """The least and the largest corner."""
        import numpy as np
        low, high = self._bright.bounds
        return np.array(low, np.float32), np.array(high, np.float32)

    @property
    def lights(self) -> Lamps:
        return Lamps(self)

    @property
    def cameras(self) -> list[str]:
        return list(self._bright.cameras)

    @property
    def ignored(self) -> list[str]:
        """What of the file was not understood."""
        return list(self._bright.ignored)

    def sample(self, count: int, *, seed: int = 0) -> tuple[Floats, Floats]:
        """Points spread over all surfaces by area, and the unit normals there, each [count, 3]."""
        points, normals = self._bright.sample(whole("count", count, 1, 1 << 30), seed_number(seed))
        return points, normals

    def save(self, path: Path) -> None:
        """Writes the scene as a .glb."""
        file = path_text(path)
        if not file.endswith(".glb"):
            raise ValueError(f"path: expected a .glb, got {file}")
        self._made.save(file)


def load(path: Path | Any, *, up: Literal["y", "z"] = "y", environment: Path = "",
         environment_turn: float = 0, add_light: str | Iterable[str] = (),
         allow_outside: bool = False) -> Scene:
    """Reads a .gltf, .glb, .obj, .pbrt or .ply, or a trimesh.Scene. The options are lte_render's
    flags.

    Raises lte.Error, which names the file, if it is missing, damaged, or of another format.
    """
    if type(path).__module__.split(".")[0] == "trimesh" and hasattr(path, "export"):
        from lte.bridges import trimesh_scene
        return trimesh_scene.load(path, up=up, environment=environment,  # type: ignore
                                  environment_turn=environment_turn, add_light=add_light)
    lights = [add_light] if isinstance(add_light, str) else [str(light) for light in add_light]
    return Scene(_lte.load(path_text(path), choice("up", up, "y", "z"), path_text(environment),
                           number("environment_turn", environment_turn, -1e6, 1e6), lights,
                           bool(allow_outside)))


def checked(scene: Scene) -> Scene:
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected lte.Scene, got {type(scene).__name__}")
    return scene


def made_of(scene: Scene) -> _lte.Scene:
    """The module's scene of an argument."""
    return checked(scene)._made
