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

Arrays = tuple[np.ndarray, np.ndarray, np.ndarray | None]


def read_mesh(path: Path) -> Arrays:
    """Vertices (n, 3), faces (m, 3) and, if every part stores them, normals (n, 3) of a file.

    The parts of a GLB are placed as its scene graph says. Nothing but the file itself is read: what
    it names besides (materials, pictures, buffers of their own) might be any file, or no file.

    Raises:
        Exception: the file is damaged; each of trimesh's readers raises what it likes.
    """
    data, kind = path.read_bytes(), path.suffix.lower()[1:]
    if kind == "ply":
        _check_ply(data)
    elif kind == "glb":
        _check_glb(data)
    vertices, faces, normals = [np.empty((0, 3))], [np.empty((0, 3), int)], [np.empty((0, 3))]
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
            count += len(part.vertices)
    complete = count == sum(len(n) for n in normals)
    return np.vstack(vertices), np.vstack(faces), np.vstack(normals) if complete else None


def _check_ply(data: bytes) -> None:
    """Every element of a PLY takes a byte at least."""
    head = data[: data.index(b"end_header")]
    counts = [int(n) for n in re.findall(rb"^\s*element\s+\S+\s+(\S+)", head, re.MULTILINE)]
    if min(counts) < 0 or sum(counts) > len(data):
        raise ValueError("its header claims more than the file holds")


def _check_glb(data: bytes) -> None:
    """Every item of an accessor takes a byte at least; one without a view would be made of zeros.

    A node with many parents stands in many places, and the parts would be copied to each.
    """
    (size,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + size])
    counts = [accessor["count"] for accessor in tree["accessors"]]
    if min(counts) < 0 or max(counts) > len(data):
        raise ValueError("an accessor claims more than the file holds")
    children = [child for node in tree.get("nodes", ()) for child in node.get("children", ())]
    if len(children) != len(set(children)):
        raise ValueError("a node has two parents")
