"""Stages of USD: meshes and simple shapes, UsdPreviewSurface, UsdLux lamps, cameras, instances."""

import pathlib
import tempfile
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lte.bridges import shapes
from lte.bridges.glb import Glb

Matrix = NDArray[np.float64]


def load(source: Any, **options: Any) -> Any:
    """A file, or a Usd.Stage."""
    from pxr import Tf, Usd, UsdGeom

    from lte import Error
    try:
        stage = source if isinstance(source, Usd.Stage) else Usd.Stage.Open(str(source))
    except Tf.ErrorException as problem:
        raise Error(f"{source}: USD cannot open it: {' '.join(str(problem).split())}") from None
    metres = float(UsdGeom.GetStageMetersPerUnit(stage)) if stage.HasAuthoredMetadata(
        "metersPerUnit") else 1.0
    turn = np.diag([metres, metres, metres, 1.0])
    if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
        turn = turn @ np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    with tempfile.TemporaryDirectory() as folder:
        reader = _Reader(turn, metres, pathlib.Path(folder))
        for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()):
            reader.add(prim)
        if reader.sky:
            options.setdefault("environment", reader.sky)
            options.setdefault("environment_turn", reader.sky_turn)
        return reader.glb.load("usd", **options)


class _Reader:
    def __init__(self, turn: Matrix, metres: float, folder: pathlib.Path) -> None:
        from pxr import Usd, UsdGeom
        self.glb, self.turn, self.metres, self.folder = Glb(), turn, metres, folder
        self.sky, self.sky_turn = "", 0.0
        self.cache = UsdGeom.XformCache(Usd.TimeCode.EarliestTime())
        self.time = Usd.TimeCode.EarliestTime()
        self.materials: dict[str, int] = {}
        self.pictures: dict[str, int] = {}

    def add(self, prim: Any) -> None:
        from pxr import UsdGeom, UsdLux
        if prim.IsA(UsdGeom.Imageable) and (
                UsdGeom.Imageable(prim).ComputeVisibility(self.time) == UsdGeom.Tokens.invisible
                or UsdGeom.Imageable(prim).ComputePurpose() in ("guide", "proxy")):
            return
        if _inside_instancer(prim):
            return
        world = self.world(prim)
        if prim.IsA(UsdGeom.PointInstancer):
            self._instances(UsdGeom.PointInstancer(prim), world)
        elif prim.IsA(UsdGeom.Camera):
            self._camera(UsdGeom.Camera(prim), world)
        elif prim.HasAPI(UsdLux.LightAPI) or prim.IsA(UsdLux.BoundableLightBase):
            self._light(prim, world)
        else:
            self._shape(prim, world)

    def world(self, prim: Any) -> Matrix:
        own: Matrix = np.array(self.cache.GetLocalToWorldTransform(prim)).T
        return self.turn @ own

    def _shape(self, prim: Any, world: Matrix) -> None:
        from pxr import UsdGeom
        if prim.IsA(UsdGeom.Mesh):
            self._mesh(UsdGeom.Mesh(prim), world)
        elif prim.IsA(UsdGeom.Cube):
            half = UsdGeom.Cube(prim).GetSizeAttr().Get(self.time) / 2
            self._put(prim, shapes.cube(), world @ np.diag([half, half, half, 1]))
        elif prim.IsA(UsdGeom.Sphere):
            radius = UsdGeom.Sphere(prim).GetRadiusAttr().Get(self.time)
            self._put(prim, shapes.sphere(), world @ np.diag([radius, radius, radius, 1]))
        elif prim.IsA(UsdGeom.Plane):
            plane = UsdGeom.Plane(prim)
            edges = plane.GetWidthAttr(), plane.GetLengthAttr()
            size = [edge.Get(self.time) / 2 for edge in edges]
            axis = "XYZ".index(plane.GetAxisAttr().Get(self.time))
            face = np.roll(np.diag([*size, 1.0]), axis + 1, 0)
            self._put(prim, shapes.rectangle(), world @ _affine(face))
        elif prim.IsA(UsdGeom.Gprim):
            warnings.warn(f"{prim.GetPath()}: {prim.GetTypeName()} is left out", stacklevel=2)

    def _put(self, prim: Any, mesh: shapes.Mesh, world: Matrix) -> None:
        at, corners, uv = shapes.placed(mesh, world)
        self.glb.mesh(at, corners, self._material(prim), uv=uv, name=str(prim.GetPath()))

    def _mesh(self, mesh: Any, world: Matrix) -> None:
        from pxr import UsdGeom
        at = np.array(mesh.GetPointsAttr().Get(self.time) or np.zeros((0, 3)), float)
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get(self.time) or [], int)
        indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(self.time) or [], int)
        if counts.sum() != len(indices) or (len(indices) and indices.max() >= len(at)):
            raise ValueError(f"{mesh.GetPath()}: faces that have no points")
        corners = _fans(counts)
        if mesh.GetOrientationAttr().Get(self.time) == UsdGeom.Tokens.leftHanded:
            corners = corners[:, ::-1]
        uv = self._uv(mesh, indices, len(at))
        # A vertex of its own for each corner: texture coordinates may differ between faces.
        whole = at[indices], corners, np.zeros((len(indices), 2)) if uv is None else uv
        subsets = UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, "materialBind")
        left = np.ones(len(counts), bool)
        face = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
        for subset in subsets:
            chosen = np.zeros(len(counts), bool)
            chosen[np.array(subset.GetIndicesAttr().Get(self.time) or [], int)] = True
            left &= ~chosen
            self._put(subset.GetPrim(), (whole[0], corners[chosen[face]], whole[2]), world)
        self._put(mesh.GetPrim(), (whole[0], corners[left[face]], whole[2]), world)

    def _uv(self, mesh: Any, indices: NDArray[Any], count: int) -> NDArray[Any] | None:
        from pxr import UsdGeom
        found = UsdGeom.PrimvarsAPI(mesh).FindPrimvarWithInheritance("st")
        values = found.ComputeFlattened(self.time) if found.HasValue() else None
        if values is None:
            return None
        uv = np.array(values, float)
        uv = uv[indices] if len(uv) == count and found.GetInterpolation() != "faceVarying" else uv
        return uv * [1, -1] + [0, 1] if len(uv) == len(indices) else None

    def _instances(self, instancer: Any, world: Matrix) -> None:
        from pxr import Usd
        prototypes = instancer.GetPrototypesRel().GetTargets()
        which = instancer.GetProtoIndicesAttr().Get(self.time) or []
        places = instancer.ComputeInstanceTransformsAtTime(
            self.time, self.time, instancer.ExcludeProtoXform)
        stage = instancer.GetPrim().GetStage()
        for index, place in zip(which, places, strict=False):
            root = stage.GetPrimAtPath(prototypes[index])
            above = np.linalg.inv(np.array(
                self.cache.GetParentToWorldTransform(root)).T)
            for prim in Usd.PrimRange(root, Usd.TraverseInstanceProxies()):
                own = np.array(self.cache.GetLocalToWorldTransform(prim)).T
                self._shape(prim, world @ np.array(place).T @ above @ own)

    def _material(self, prim: Any) -> int:
        from pxr import UsdGeom, UsdShade
        bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        sided = UsdGeom.Gprim(prim).GetDoubleSidedAttr()
        twice = bool(sided.Get(self.time)) if sided and prim.IsA(UsdGeom.Gprim) else False
        color = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
        shown = (color.Get(self.time) or []) if color.HasValue() else []
        grey = tuple(np.array(shown[0], float)) if len(shown) else (0.5, 0.5, 0.5)
        shader = bound.ComputeSurfaceSource()[0] if bound else None
        key = f"{bound.GetPath() if shader else grey} {twice}"
        if key not in self.materials:
            if shader and shader.GetIdAttr().Get() == "UsdPreviewSurface":
                made = self._preview(shader)
            else:
                made = {"color": np.clip(grey, 0, 1)}
            self.materials[key] = self.glb.material(**made, double_sided=twice)
        return self.materials[key]

    def _preview(self, shader: Any) -> dict[str, Any]:
        def number(name: str, default: float) -> float:
            value, _ = self._input(shader, name, default)
            return float(np.mean(value))

        color, picture = self._input(shader, "diffuseColor", (0.18, 0.18, 0.18))
        emission, glow = self._input(shader, "emissiveColor", (0, 0, 0))
        return {"color": np.clip(color, 0, 1), "picture": picture, "emission": emission,
                "glow": glow, "metallic": number("metallic", 0),
                "roughness": number("roughness", 0.5)}

    def _input(self, shader: Any, name: str, default: Any) -> tuple[Any, int | None]:
        """The value, and the number of the picture that it multiplies."""
        found = shader.GetInput(name)
        if not found:
            return default, None
        source = found.GetConnectedSources()[0]
        if not source:
            value = found.Get(self.time)
            return (default if value is None else np.array(value, float)), None
        from pxr import UsdShade
        texture = UsdShade.Shader(source[0].source.GetPrim())
        asset = texture.GetInput("file") if texture else None
        path = asset.Get(self.time).resolvedPath if asset and asset.Get(self.time) else ""
        if not path or pathlib.Path(path).suffix.lower() not in (".png", ".jpg", ".jpeg"):
            warnings.warn(f"{shader.GetPath()}: {name}: no picture that lte reads", stacklevel=2)
            return default, None
        if path not in self.pictures:
            from pxr import Ar
            data = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path)).GetBuffer()
            self.pictures[path] = self.glb.picture(bytes(data))
        scale = texture.GetInput("scale")
        factor = scale.Get(self.time) if scale else None
        return (np.ones(3) if factor is None else np.array(factor, float)[:3]), self.pictures[path]

    def _camera(self, camera: Any, world: Matrix) -> None:
        if camera.GetProjectionAttr().Get(self.time) != "perspective":
            return
        frustum = camera.GetCamera(self.time)
        half = frustum.verticalAperture / 2 / frustum.focalLength
        self.glb.camera(_rigid(world), 2 * np.degrees(np.arctan(half)),
                        name=camera.GetPrim().GetName())

    def _light(self, prim: Any, world: Matrix) -> None:
        from pxr import UsdLux
        light = UsdLux.LightAPI(prim)
        strength = (light.GetIntensityAttr().Get(self.time)
                    * 2.0 ** light.GetExposureAttr().Get(self.time)
                    * np.array(light.GetColorAttr().Get(self.time), float))
        name, normal = str(prim.GetPath()), light.GetNormalizeAttr().Get(self.time)
        if prim.IsA(UsdLux.DistantLight):
            angle = np.radians(UsdLux.DistantLight(prim).GetAngleAttr().Get(self.time))
            sun = 1.0 if normal or angle == 0 else np.pi * np.sin(angle / 2) ** 2
            self.glb.light("directional", strength * sun, to=-world[:3, 2], name=name)
        elif prim.IsA(UsdLux.DomeLight):
            self._dome(UsdLux.DomeLight(prim), strength, world)
        else:
            self._lamp(prim, strength, bool(normal), world, name)

    def _lamp(self, prim: Any, radiance: Any, normal: bool, world: Matrix, name: str) -> None:
        from pxr import UsdLux
        flip = np.diag([1.0, -1, -1, 1])  # lamps shine along -Z
        if prim.IsA(UsdLux.SphereLight):
            lamp = UsdLux.SphereLight(prim)
            radius = lamp.GetRadiusAttr().Get(self.time)
            if lamp.GetTreatAsPointAttr().Get(self.time) or radius == 0:
                size = radius * abs(np.linalg.det(world[:3, :3])) ** (1 / 3)
                share = 0.25 * self.metres ** 2 if normal else np.pi * size ** 2
                self.glb.light("point", radiance * share, at=world[:3, 3], name=name)
                return
            mesh, place = shapes.sphere(), np.diag([radius, radius, radius, 1.0])
        elif prim.IsA(UsdLux.RectLight):
            rect = UsdLux.RectLight(prim)
            mesh = shapes.rectangle()
            place = flip @ np.diag([rect.GetWidthAttr().Get(self.time) / 2,
                                    rect.GetHeightAttr().Get(self.time) / 2, 1, 1])
        elif prim.IsA(UsdLux.DiskLight):
            radius = UsdLux.DiskLight(prim).GetRadiusAttr().Get(self.time)
            mesh, place = shapes.disk(), flip @ np.diag([radius, radius, 1, 1])
        elif prim.IsA(UsdLux.CylinderLight):
            lamp = UsdLux.CylinderLight(prim)
            radius, length = (lamp.GetRadiusAttr().Get(self.time),
                              lamp.GetLengthAttr().Get(self.time))
            stand = _affine(np.array([[0.0, 0, length], [radius, 0, 0], [0, radius, 0]]))
            stand[:3, 3] = [-length / 2, 0, 0]  # along X, about its middle
            mesh, place = shapes.cylinder(), stand
        else:
            warnings.warn(f"{name}: {prim.GetTypeName()} is left out", stacklevel=2)
            return
        at, corners, uv = shapes.placed(mesh, world @ place)
        if normal:
            a, b, c = (at[corners[:, i]] for i in range(3))
            area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
            radiance = radiance * self.metres ** 2 / area
        self.glb.mesh(at, corners, self.glb.material(color=0, emission=radiance), uv=uv, name=name)

    def _dome(self, dome: Any, strength: Any, world: Matrix) -> None:
        file = dome.GetTextureFileAttr().Get(self.time)
        if not file or not file.resolvedPath:
            self.sky = ",".join(f"{value:.9g}" for value in strength)
            return
        if not np.allclose(strength, 1) or abs(world[1, 1]) < 0.99 * np.linalg.norm(world[:3, 1]):
            warnings.warn(f"{dome.GetPath()}: its picture is taken as it is", stacklevel=2)
        # USD has -Z in the middle of the picture, lte +X.
        self.sky = file.resolvedPath
        self.sky_turn = 90 + float(np.degrees(np.arctan2(world[0, 2], world[2, 2])))


def _fans(counts: NDArray[Any]) -> NDArray[Any]:
    """Polygons of so many corners each, as triangles of corners' numbers."""
    first = np.concatenate([[0], np.cumsum(counts)[:-1]]) if len(counts) else counts
    number = np.maximum(counts - 2, 0)
    base = np.repeat(first, number)
    step = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    return np.stack([base, base + step + 1, base + step + 2], 1)


def _affine(linear: Matrix) -> Matrix:
    out = np.eye(4)
    out[:3, :3] = linear
    return out


def _rigid(world: Matrix) -> Matrix:
    """Without scale, which cameras do not have."""
    out = world.copy()
    out[:3, :3] /= np.linalg.norm(out[:3, :3], axis=0)
    return out


def _inside_instancer(prim: Any) -> bool:
    """Whether it is a prototype, which is seen where instances are."""
    from pxr import UsdGeom
    above = prim.GetParent()
    while above and not above.IsPseudoRoot():
        if above.IsA(UsdGeom.PointInstancer):
            return True
        above = above.GetParent()
    return False
