"""Scenes of Mitsuba 3, read from what Mitsuba has loaded, in an RGB variant."""

import pathlib
import re
import tempfile
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lte.bridges import shapes
from lte.bridges.glb import Glb

SHAPES = {"Rectangle": shapes.rectangle, "Disk": shapes.disk, "Sphere": shapes.sphere,
          "Cylinder": shapes.cylinder}
SKY = 1024  #: columns of the picture that an envmap becomes


def load(source: Any, **options: Any) -> Any:
    """A file, a dict, or a scene."""
    import mitsuba as mi
    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    if not mi.variant().endswith("_rgb"):
        raise ValueError(f"variant: expected one of RGB, got {mi.variant()}")
    scene = source
    if isinstance(source, dict):
        scene = mi.load_dict(source)
    elif not hasattr(source, "shapes"):
        scene = mi.load_file(str(source))
    glb = Glb()
    for shape in scene.shapes():
        _add_shape(mi, glb, shape)
    for sensor in scene.sensors():
        _add_camera(mi, glb, sensor)
    with tempfile.TemporaryDirectory() as folder:
        for emitter in scene.emitters():
            sky = _add_emitter(mi, glb, emitter, pathlib.Path(folder))
            if sky:
                options.setdefault("environment", sky)
        return glb.load("mitsuba", **options)


def _kind(thing: Any) -> str:
    """The name of its class in C++."""
    return str(thing.class_name() if hasattr(thing, "class_name") else thing.class_().name())


def _values(mi: Any, thing: Any) -> dict[str, Any]:
    found = mi.traverse(thing)
    return {key: found[key] for key in found.keys()}


def _matrix(transform: Any) -> NDArray[np.float64]:
    return np.array(transform.matrix, np.float64).reshape(4, 4)


def _triple(value: Any) -> NDArray[np.float64]:
    return np.broadcast_to(np.array(value, np.float64).reshape(-1), 3).copy()


def _add_shape(mi: Any, glb: Glb, shape: Any) -> None:
    values, kind = _values(mi, shape), _kind(shape)
    mesh: tuple[Any, Any, Any]
    if shape.is_mesh():
        at = np.array(values["vertex_positions"]).reshape(-1, 3)
        corners = np.array(values["faces"]).reshape(-1, 3)
        found = np.array(values["vertex_texcoords"]).reshape(-1, 2)
        mesh = at, corners, found if len(found) == len(at) else None
    elif kind in SHAPES:
        mesh = shapes.placed(SHAPES[kind](), _matrix(values["to_world"]))
        if re.search(r"flip_normals = (1|true)", str(shape)):
            mesh = mesh[0], mesh[1][:, ::-1], mesh[2]
    else:
        raise ValueError(f"shape {shape.id()}: lte has no {kind}")
    surface = _surface(mi, glb, shape.bsdf())
    if shape.is_emitter():
        radiance = _Color(mi, glb, _values(mi, shape.emitter()), "radiance")
        surface |= {"emission": radiance.factor, "glow": radiance.picture}
        if surface.get("picture") is None:
            surface["turn"] = radiance.turn
    turn = surface.pop("turn", np.eye(3))
    at, corners, uv = mesh
    if uv is not None:
        uv = uv @ turn[:2, :2].T + turn[:2, 2]
    glb.mesh(at, corners, glb.material(**surface), uv=uv, name=shape.id())


class _Color:
    """A constant, or a picture with a factor."""

    def __init__(self, mi: Any, glb: Glb, values: dict[str, Any], name: str,
                 default: float = 1) -> None:
        self.factor, self.picture, self.turn = np.full(3, float(default)), None, np.eye(3)
        texels = values.get(f"{name}.data")
        if texels is not None:
            linear = np.array(texels, np.float32)
            linear = np.repeat(linear, 3, 2) if linear.shape[2] == 1 else linear[:, :, :3]
            self.factor = np.full(3, max(1.0, float(linear.max())))
            self.picture = glb.picture(_png(mi, linear / self.factor[0]))
            self.turn = np.array(values[f"{name}.to_uv"].matrix, float)[:3, :3]
        elif f"{name}.value" in values:
            self.factor = _triple(values[f"{name}.value"])
        elif name in values:
            self.factor = _triple(values[name])
        elif any(key.startswith(f"{name}.") for key in values):
            warnings.warn(f"a texture that is no picture counts as grey: {name}", stacklevel=2)
            self.factor = np.full(3, 0.5)

    def mean(self) -> float:
        return float(self.factor.mean())


def _png(mi: Any, linear: NDArray[np.float32]) -> bytes:
    coded = mi.Bitmap(linear.astype(np.float32)).convert(
        mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, srgb_gamma=True)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "picture.png"
        coded.write(str(path))
        return path.read_bytes()


def _surface(mi: Any, glb: Glb, bsdf: Any) -> dict[str, Any]:
    """Arguments of Glb.material()."""
    kind = _kind(bsdf)
    # Inside others, such as twosided, keys begin with the name of what is inside.
    values = {re.sub(r"^(brdf_0|bsdf|nested_bsdf|bsdf_0)\.", "", key): value
              for key, value in _values(mi, bsdf).items()}
    out: dict[str, Any] = {}
    if "base_color.value" in values or "base_color.data" in values:
        color = _Color(mi, glb, values, "base_color")
        out = {"metallic": _Color(mi, glb, values, "metallic", 0).mean(),
               "roughness": _Color(mi, glb, values, "roughness", 0.5).mean()}
    elif "eta.value" in values and "k.value" in values:
        color = _Color(mi, glb, values, "specular_reflectance")
        if color.picture is None:
            color.factor *= _reflectance(_triple(values["eta.value"]), _triple(values["k.value"]))
        alpha = _Color(mi, glb, values, "alpha", 0).mean()
        if "alpha_u.value" in values:
            alpha = float(np.sqrt(_Color(mi, glb, values, "alpha_u").mean()
                                  * _Color(mi, glb, values, "alpha_v").mean()))
        out = {"metallic": 1, "roughness": min(1.0, alpha ** 0.5)}
    elif "specular_reflectance.value" in values and "diffuse_reflectance.value" not in values:
        color, out = _Color(mi, glb, values, "specular_reflectance"), {"metallic": 1,
                                                                      "roughness": 0}
    else:
        plain = any(key.startswith("reflectance") for key in values)
        color = _Color(mi, glb, values, "reflectance" if plain else "diffuse_reflectance", 0.5)
        if not plain:
            warnings.warn(f"{kind}: its diffuse part counts alone", stacklevel=2)
    return {**out, "color": np.clip(color.factor, 0, 1), "picture": color.picture,
            "turn": color.turn}


def _reflectance(eta: NDArray[np.float64], k: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a conductor, straight on."""
    result: NDArray[np.float64] = ((eta - 1) ** 2 + k ** 2) / ((eta + 1) ** 2 + k ** 2)
    return result


def _add_emitter(mi: Any, glb: Glb, emitter: Any, folder: pathlib.Path) -> str:
    """Adds a lamp, or returns lte's environment."""
    values, kind = _values(mi, emitter), _kind(emitter)
    if kind == "PointLight":
        glb.light("point", _triple(values["intensity.value"]), at=_triple(values["position"]),
                  name=emitter.id())
    elif kind == "SpotLight":
        intensity, place = _spot(emitter, values)
        glb.light("spot", intensity, **place, name=emitter.id())
    elif kind == "DirectionalEmitter":
        glb.light("directional", _triple(values["irradiance.value"]),
                  to=_matrix(values["to_world"])[:3, 2], name=emitter.id())
    elif kind == "ConstantBackgroundEmitter":
        return ",".join(f"{value:.9g}" for value in _triple(values["radiance.value"]))
    elif kind == "EnvironmentMapEmitter":
        path = folder / "sky.exr"
        mi.Bitmap(_sky(values)).write(str(path))
        return str(path)
    elif kind != "AreaLight":
        raise ValueError(f"emitter {emitter.id()}: lte has no {kind}")
    return ""


def _spot(emitter: Any, values: dict[str, Any]) -> tuple[NDArray[np.float64], dict[str, Any]]:
    """Intensity, and where, for Glb.light()."""
    full, none = (float(re.search(rf"{key} = \[?([-\d.e]+)", str(emitter)).group(1))  # type: ignore
                  for key in ("beam_width", "cutoff_angle"))
    place = _matrix(values["to_world"])
    return _triple(values["intensity.value"]) * spot_share(full, none), {
        "at": place[:3, 3], "to": place[:3, 2], "cones": (min(full, none - 1e-4), none)}


def spot_share(full: float, none: float) -> float:
    """What a spot of Mitsuba sends out over what one of glTF does with the same two cones.

    Mitsuba's light falls linearly by the angle, glTF's by the square of the cosine: between the
    cones light differs, the sum can be the same.
    """
    angle = (np.arange(4096) + 0.5) / 4096 * none
    theirs = np.clip((none - angle) / max(none - full, 1e-6), 0, 1)
    full = min(full, none - 1e-4)
    ours = np.clip((np.cos(angle) - np.cos(none)) / (np.cos(full) - np.cos(none)), 0, 1) ** 2
    return float((theirs * np.sin(angle)).sum() / (ours * np.sin(angle)).sum())


def _sky(values: dict[str, Any]) -> NDArray[np.float32]:
    """Mitsuba's picture, turned into lte's frame: +X in its middle, +Z a quarter to the right."""
    texels = np.array(values["data"], np.float32)[:, :-1, :3]  # the last column repeats the first
    rows, columns = texels.shape[:2]
    height = SKY // 2
    theta = (np.arange(height) + 0.5) / height * np.pi
    phi = ((np.arange(SKY) + 0.5) / SKY - 0.5) * 2 * np.pi
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    world = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1)
    local = world @ np.linalg.inv(_matrix(values["to_world"])[:3, :3]).T
    local /= np.linalg.norm(local, axis=-1, keepdims=True)
    u = np.arctan2(local[..., 0], -local[..., 2]) / (2 * np.pi) * columns - 0.5
    v = np.arccos(np.clip(local[..., 1], -1, 1)) / np.pi * (rows - 1)
    return float(np.array(values["scale"]).reshape(-1)[0]) * _between(texels, u, v)


def _between(texels: NDArray[np.float32], u: NDArray[np.float64],
             v: NDArray[np.float64]) -> NDArray[np.float32]:
    rows, columns = texels.shape[:2]
    left, top = np.floor(u).astype(int), np.clip(np.floor(v).astype(int), 0, rows - 2)
    x, y = (u - left)[..., None], (v - top)[..., None]
    row = [texels[top + k, left % columns] * (1 - x) + texels[top + k, (left + 1) % columns] * x
           for k in (0, 1)]
    out: NDArray[np.float32] = (row[0] * (1 - y) + row[1] * y).astype(np.float32)
    return out


def _add_camera(mi: Any, glb: Glb, sensor: Any) -> None:
    values = _values(mi, sensor)
    if "x_fov" not in values:
        return
    width, height = np.array(values["film.size"], float)
    vfov = 2 * np.degrees(np.arctan(np.tan(np.radians(float(np.array(values["x_fov"]).item())) / 2)
                                    * height / width))
    glb.camera(_matrix(values["to_world"]) @ np.diag([-1.0, 1, -1, 1]), vfov,
               name=sensor.id() or "camera")
