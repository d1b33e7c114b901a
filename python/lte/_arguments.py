"""Checks of arguments: each problem is one sentence that names the argument."""

import operator
import os
from typing import Any, TypeAlias

Path: TypeAlias = str | os.PathLike[str]


def whole(name: str, value: Any, low: int, high: int) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: expected a whole number, got {_kind(value)}") from None
    if not low <= number <= high:
        raise ValueError(f"{name}: expected {low} to {high}, got {number}")
    return number


def seed_number(seed: int) -> int:
    return whole("seed", seed, 0, (1 << 64) - 1)


def depth_number(depth: int) -> int:
    return whole("depth", depth, 1, 1000)


def number(name: str, value: Any, low: float, high: float) -> float:
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        found = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number, got {_kind(value)}") from None
    if not low <= found <= high:
        raise ValueError(f"{name}: expected {low:g} to {high:g}, got {found:g}")
    return found


def choice(name: str, word: Any, *words: str) -> str:
    if word not in words:
        raise ValueError(f"{name}: expected {' | '.join(words)}, got {word!r}")
    return str(word)


def path_text(path: Any) -> str:
    try:
        text = os.fsdecode(path)
    except TypeError:
        raise TypeError(f"path: expected a name of a file, got {_kind(path)}") from None
    if "\0" in text:
        raise ValueError("path: has a null character")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise ValueError(f"path: expected UTF-8, got {text!r}") from None
    return text


def _kind(value: Any) -> str:
    return f"{type(value).__name__} {value!r}"[:60] if value is not None else "None"
