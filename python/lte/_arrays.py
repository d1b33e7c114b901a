"""Checks of arrays. Apart, as NumPy takes longer to import than all else of the package."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lte._lte import check_surface

Floats: TypeAlias = NDArray[np.float32]


def surface(points: Any, normals: Any) -> tuple[Floats, Floats]:
    """Points and normals as [N, 3] float32 rows."""
    at, side = _triples("points", points), _triples("normals", normals)
    if len(at) != len(side):
        raise ValueError(f"normals: expected as many as points, {len(at)}, got {len(side)}")
    check_surface(at, side)
    return at, side


def colors(name: str, values: Any, count: int) -> Floats:
    """[count, 3] float32 rows of colors."""
    rows = _triples(name, values)
    if len(rows) != count:
        raise ValueError(f"{name}: expected as many as points, {count}, got {len(rows)}")
    if count and not (rows.min() >= 0 and rows.max() <= 16):
        raise ValueError(f"{name}: expected 0 to 16, got {rows.min():g} to {rows.max():g}")
    return rows


def _triples(name: str, values: Any) -> Floats:
    """[N, 3] float32 rows; those of three adjacent numbers are taken as they are."""
    array = _array(name, values)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: expected [N, 3], got {list(array.shape)}")
    if _readable(array):
        return array
    with np.errstate(over="ignore"):  # what float32 cannot hold is not finite there
        return np.ascontiguousarray(array, np.float32)


def _readable(rows: NDArray[Any]) -> bool:
    """Whether the module reads them in place."""
    apart, along = rows.strides
    return (rows.dtype == np.float32 and rows.dtype.isnative and rows.flags.aligned
            and apart % 4 == 0 and along == 4)


def _array(name: str, values: Any) -> NDArray[Any]:
    if isinstance(values, (list, tuple)):
        return _array_of_rows(name, values)
    if hasattr(values, "__dlpack__") and not isinstance(values, np.ndarray):
        try:
            array = np.from_dlpack(values)
        except (BufferError, RuntimeError, TypeError) as problem:
            raise TypeError(f"{name}: expected an array on the CPU ({_line(problem)})") from None
    else:
        array = np.asarray(values)
    if array.dtype.type not in (np.float32, np.float64):
        raise TypeError(f"{name}: expected float32 or float64, got {array.dtype}")
    return array


def _array_of_rows(name: str, values: Any) -> NDArray[Any]:
    """Python's own numbers, whole ones too."""
    try:
        array = np.array(values) if len(values) else np.zeros((0, 3))
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: expected [N, 3] numbers, got rows of different kinds") from None
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name}: expected [N, 3] numbers, got {array.dtype}")
    return array


def _line(problem: BaseException) -> str:
    return " ".join(str(problem).split())
