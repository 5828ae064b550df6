"""Mesh files as arrays; what they claim to hold is held against their size before it is read."""

import io
import json
import logging
import re
import struct
from pathlib import Path

import numpy as np
import trimesh

# Without a handler Python would print its warnings; what is wrong is told by us.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


class DamagedError(Exception):
    """What is wrong with a mesh file, in words for its user."""


Arrays = tuple[np.ndarray, np.ndarray, np.ndarray | None, dict[str, np.ndarray]]
# What a vertex may carry, and how many numbers each takes.
CARRIED = {"uv": 2, "albedo": 3, "roughness": 1, "metallic": 1, "weight": 1}


def read_mesh(path: Path) -> Arrays:
    """Vertices (n, 3), faces (m, 3) and, if every part stores them, normals (n, 3) of a file.

    Last comes what else the vertices of every part carry: see CARRIED. Colours are linear, as glTF
    has them; they are the `albedo`. The numbers are properties of
    that name in a PLY, attributes such as _ROUGHNESS in a GLB; whole ones are shares of their type.

    The parts of a GLB are placed as its scene graph says. Nothing but the file itself is read: what
    it names besides (materials, pictures, buffers of their own) might be any file, or no file.

    Raises:
        DamagedError: the file is not what its ending says, or not whole.
        OSError: it cannot be read.
    """
    data, kind = path.read_bytes(), path.suffix.lower()[1:]
    if not data:
        raise DamagedError("is empty")
    try:
        return _arrays(data, kind)
    except DamagedError:
        raise
    except Exception as error:  # each of trimesh's readers raises what it likes
        line = _bad_line(data) if kind == "obj" else 0
        at = f" (line {line})" if line else ""
        raise DamagedError(f"is damaged, or not a .{kind} file{at}") from error


def _arrays(data: bytes, kind: str) -> Arrays:
    if kind == "ply":
        _check_ply(data)
    elif kind == "glb":
        _check_glb(data)
    vertices, faces, normals = [np.empty((0, 3))], [np.empty((0, 3), int)], [np.empty((0, 3))]
    carried: list[dict[str, np.ndarray]] = []
    count = 0
    with np.errstate(all="ignore"):  # NaN and Inf are for the caller to refuse
        # A stream without a name, so that trimesh has no folder to look for other files in.
        scene = trimesh.load_scene(io.BytesIO(data), kind, process=False)
        for node in scene.graph.nodes_geometry:
            matrix, name = scene.graph[node]
            if not isinstance(part := scene.geometry[name], trimesh.Trimesh):
                continue
            # Asked for as a property, normals that are not stored would be computed.
            stored = part._cache.cache.get("vertex_normals")
            if stored is not None:
                normals.append(stored @ np.linalg.inv(matrix[:3, :3]))
            vertices.append(trimesh.transform_points(part.vertices, matrix))
            mirrored = np.linalg.det(matrix[:3, :3]) < 0
            faces.append(np.asarray(part.faces)[:, :: -1 if mirrored else 1] + count)
            carried.append(_carried(part))
            count += len(part.vertices)
    complete = count == sum(len(n) for n in normals)
    shared = [name for name in CARRIED if carried and all(name in c for c in carried)]
    together = {name: np.vstack([c[name] for c in carried]) for name in shared}
    stacked = np.vstack(vertices), np.vstack(faces)
    return *stacked, np.vstack(normals) if complete else None, together


def _carried(part: trimesh.Trimesh) -> dict[str, np.ndarray]:
    """What the vertices of a part carry, (n, k) each."""
    found: dict[str, np.ndarray] = {}
    uv = getattr(part.visual, "uv", None)
    if uv is not None:
        found["uv"] = np.asarray(uv, float)[:, :2]
    raw = part.metadata.get("_ply_raw", {}).get("vertex", {}).get("data", {})
    names = raw.dtype.names if isinstance(raw, np.ndarray) else raw  # in binary files, and in text
    named = {name.lower(): raw[name] for name in names or ()}
    named |= {k.lower().lstrip("_"): v for k, v in part.vertex_attributes.items()}
    named |= getattr(part.visual, "vertex_attributes", {})
    if {"red", "green", "blue"} <= set(named):
        named["color"] = np.stack([np.ravel(named[c]) for c in ("red", "green", "blue")], axis=1)
    elif "color" not in named and part.visual.kind == "vertex":
        named["color"] = part.visual.vertex_colors
    if "color" in named:
        found["albedo"] = _shares(named["color"])[:, :3]
    for name in ("roughness", "metallic", "weight"):
        if name in named:
            found[name] = _shares(named[name]).reshape(len(part.vertices), -1)[:, :1]
    return {n: v for n, v in found.items() if v.shape == (len(part.vertices), CARRIED[n])}


def _shares(values: np.ndarray) -> np.ndarray:
    """Numbers as they are; whole ones as shares of the largest of their type."""
    values = np.asarray(values)
    return values / (np.iinfo(values.dtype).max if values.dtype.kind in "iu" else 1.0)


def _bad_line(data: bytes) -> int:
    """The first line of an OBJ with a vertex or a face that is none; 0 if all are."""
    for number, line in enumerate(data.splitlines(), 1):
        what, *words = line.split() or [b""]
        try:
            if what == b"v" and len([float(word) for word in words]) < 3:
                return number
            if what == b"f" and len([int(word.split(b"/")[0]) for word in words]) < 3:
                return number
        except ValueError:
            return number
    return 0


def _check_ply(data: bytes) -> None:
    """Every element of a PLY takes a byte at least."""
    head = data[: data.index(b"end_header")]
    counts = [int(n) for n in re.findall(rb"^\s*element\s+\S+\s+(\S+)", head, re.MULTILINE)]
    if min(counts) < 0 or sum(counts) > len(data):
        raise DamagedError("is cut short: its header claims more than it holds")


def _check_glb(data: bytes) -> None:
    """Every item of an accessor takes a byte at least; one without a view would be made of zeros.

    A node with many parents stands in many places, and the parts would be copied to each.
    """
    (size,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + size])
    if any("uri" in buffer for buffer in tree["buffers"]):
        raise DamagedError("keeps its triangles in another file")
    counts = [accessor["count"] for accessor in tree["accessors"]]
    if min(counts) < 0 or max(counts) > len(data):
        raise DamagedError("is cut short: an accessor claims more than it holds")
    children = [child for node in tree.get("nodes", ()) for child in node.get("children", ())]
    if len(children) != len(set(children)):
        raise DamagedError("holds a node with two parents")
