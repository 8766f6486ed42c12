"""The solids and faces of a CAD file as Gmsh lists them, and names for them."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError

FLAT = 1e-5  # of the size of a body: planes at its ends are that thin
AXES = ("x", "y", "z")
MARK = "abut"  # what lines for us begin with


@dataclass(frozen=True)
class Face:
    """A face of a solid: its number in the file and its box ((3,), (3,))."""

    tag: int
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@dataclass(frozen=True)
class Part:
    """A solid: its number in the file, its box, its faces."""

    tag: int
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    faces: tuple[Face, ...]

    @property
    def size(self) -> float:
        """The diagonal of the box [length]."""
        return float(np.linalg.norm(self.high - self.low))


def read_listing(printed: str) -> tuple[Part, ...]:
    """The solids of what a script of ``scripts.listing`` has printed. Raises InputError where there are none."""
    boxes: dict[int, NDArray[np.float64]] = {}
    faces: dict[int, list[Face]] = {}
    for line in printed.splitlines():
        words = line.split()
        if words[:2] == [MARK, "volume"]:
            boxes[int(words[2])] = np.array(words[3:9], dtype=float)
        elif words[:2] == [MARK, "face"]:
            box = np.array(words[4:10], dtype=float)
            faces.setdefault(int(words[2]), []).append(Face(int(words[3]), box[:3], box[3:]))
    if not boxes:
        raise InputError(
            "abut mesh: the file holds no solids (surfaces or curves alone are not enough); export the parts as solid bodies"
        )
    return tuple(Part(tag, box[:3], box[3:], tuple(faces.get(tag, ()))) for tag, box in boxes.items())


def shared_faces(parts: Sequence[Part]) -> set[int]:
    """Faces that belong to two solids, which are glued there."""
    tags = [face.tag for part in parts for face in part.faces]
    return {tag for tag in tags if tags.count(tag) > 1}


def body_names(parts: Sequence[Part], given: Sequence[str], found: Sequence[tuple[str, int]]) -> tuple[str, ...]:
    """A name of each solid: as ``given``, else of the file, else part_1, part_2, ...

    found: name and number of faces of each solid of the file, in its order; where these do not agree with the solids, or a
    name occurs twice, none is believed. Raises InputError for names given that are too few or many, odd or equal."""
    if given:
        if len(given) != len(parts):
            raise InputError(f"--names: {len(given)} names for {len(parts)} solids; give one for each, in their order")
        for name in given:
            if cleaned(name) != name:
                raise InputError(f"--names: {name!r}: letters, digits, _ and - only")
        if len(set(given)) < len(given):
            raise InputError("--names: a name occurs twice; give each solid one of its own")
        return tuple(given)
    names = [cleaned(name) for name, _ in found]
    agree = [count for _, count in found] == [len(part.faces) for part in parts]
    if agree and all(names) and len(set(names)) == len(names):
        return tuple(names)
    return tuple(f"part_{i}" for i in range(1, len(parts) + 1))


def cleaned(name: str) -> str:
    """A name of letters of any alphabet, digits, _ and -, others than these in one _."""
    return re.sub(r"[^\w-]+", "_", unicodedata.normalize("NFC", name)).strip("_")


def face_names(part: Part, body: str) -> dict[int, str]:
    """Names of the faces of a solid: plane ends along the axes are body.xmin to body.zmax, others body.face1, ...

    Of several faces in one such plane all have its name."""
    names: dict[int, str] = {}
    thin = FLAT * part.size
    for number, face in enumerate(part.faces, start=1):
        names[face.tag] = f"{body}.face{number}"
        for axis, letter in enumerate(AXES):
            if face.high[axis] - face.low[axis] > thin:
                continue
            for end, word in ((part.low, "min"), (part.high, "max")):
                if abs(face.low[axis] - end[axis]) <= thin:
                    names[face.tag] = f"{body}.{letter}{word}"
    return names


def groups_of(names: Mapping[int, str]) -> dict[str, list[int]]:
    """Faces by their names."""
    result: dict[str, list[int]] = {}
    for tag, name in names.items():
        result.setdefault(name, []).append(tag)
    return result
