"""Mutations that know a binary or a text format: its header, its counts, its numbers."""

import io
import json
import random
import re
import struct
import zipfile
from collections.abc import Callable

from tests.fuzz import trees

COUNTS = (
    0, 1, -1, -2, 2, 3, 16, 255, 1000, 8191, 16383, 16384, 16385, 65536, 10**6, 10**9, 2**31 - 1,
    -(2**31),
)  # fmt: skip
TOKENS = (
    "nan", "inf", "-inf", "1e400", "-1", "0", "1e15", "1e16", "1e30", "3.4e38", "1e-320", "9" * 30,
    "9" * 5000, "x", "", "1/2/3/4", "//", "-999999", "2147483648", "\0", "½", "0x10", "1,5",
)  # fmt: skip
PLY_LINES = (
    "", "property list uchar int more", "property float nx", "format binary_big_endian 1.0",
    "format binary_little_endian 1.0", "format ascii 9.9", "element face 1", "element",
    "comment TextureFile ../../../../dev/zero", "element edge 1000000000", "property",
    "property list", "property list float float vertex_indices", "obj_info x", "end_header",
)  # fmt: skip
OBJ_LINES = (
    b"mtllib zero.mtl", b"mtllib fifo.mtl", b"mtllib ../../../../../../dev/zero",
    b"mtllib folder.exr", b"usemtl " + b"x" * 10_000, b"f", b"f 1", b"f 1 2", b"f 1 2 3 4 5 6 7",
    b"f 0 0 0", b"f 1 1 1", b"f 1 2 99999999999", b"f -1 -2 -99", b"f a b c", b"f 1/ 2/ 3/",
    b"f 1.5 2 3", b"f 1//9 2//9 3//9", b"f 1/9 2/9 3/9", b"f " + b"1 2 3 " * 5000,
    b"f 1 2 \\\n3", b"v", b"v 1 2", b"v nan nan nan", b"v 1 2 3 4 5 6 7", b"v 1e400 0 0",
    b"vn 0 0 0", b"vn nan 0 0", b"vt", b"l 1 2 3", b"g", b"o", b"\\", b"curv 0 1 1 2", b"s off",
    b"\xff\xfe", b"call x", b"#" * 100_000,
)  # fmt: skip


def exr(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """Attributes of an EXR's header changed, dropped or doubled; or the table of its offsets."""
    made, found, at = bytearray(data), {}, 8
    while data[at]:
        name, kind, _ = data[at:].split(b"\0", 2)[:3]
        start = at + len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, start)
        found[name.decode()] = (at, start + 4, size)
        at = start + 4 + size
    name = rng.choice((*found, "dataWindow", "displayWindow", "compression", "version", "offsets"))
    if name == "version":
        struct.pack_into(
            "<I", made, 4, rng.choice((2, 1, 3, 0x202, 0x1002, 0x802, 0x402, 0xFFFF02))
        )
    elif name == "offsets":
        value = rng.choice((0, 1, 8, len(data), 2**31, 2**63 - 1, 2**64 - 1))
        struct.pack_into("<Q", made, at + 1 + 8 * rng.randrange(2), value)
    else:
        start, value, size = found[name]
        how = rng.randrange(6)
        if how == 0:
            del made[start : value + size]
            return bytes(made), f"{name} dropped"
        if how == 1:
            made[start:start] = made[start : value + size]
            return bytes(made), f"{name} twice"
        if how == 2:
            struct.pack_into("<i", made, value - 4, rng.choice(COUNTS))
            return bytes(made), f"{name} of another size"
        if name in ("dataWindow", "displayWindow"):
            for place in rng.sample(range(4), rng.choice((1, 1, 2, 4))):
                struct.pack_into("<i", made, value + 4 * place, rng.choice(COUNTS))
        elif name == "channels" and how < 5:
            place = value + rng.randrange(size)
            made[place] = rng.choice((0, 1, 2, 3, 4, 65, 66, 71, 82, 255))
        elif size in (1, 4, 8):
            fill = (b"\0", b"\1", b"\2", b"\3", b"\x09", b"\x0a", b"\x7f", b"\xff")
            made[value : value + size] = (rng.choice(fill) * 8)[:size]
        elif size:
            made[value + rng.randrange(size)] = rng.randrange(256)
    return bytes(made), name


def hdr(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """The header of a Radiance file, or the lengths in its runs, changed."""
    head, _, body = data.partition(b"\n\n")
    size, _, body = body.partition(b"\n")
    lines = head.split(b"\n")
    how = rng.choice(("size", "size", "line", "format", "runs"))
    if how == "size":
        sides = [str(rng.choice(COUNTS)), str(rng.choice((*COUNTS, 32, 32)))]
        axes = rng.choice(
            ("-Y {} +X {}", "+Y {} +X {}", "+X {} -Y {}", "-Y {}", "{} {}", "-Y {} -X {}")
        )
        size = axes.format(*sides).encode()
    elif how == "line":
        lines[rng.randrange(len(lines))] = rng.choice(
            (
                b"",
                b"EXPOSURE=nan",
                b"EXPOSURE=0",
                b"GAMMA=1e400",
                b"#?",
                b"A=" + b"x" * 100_000,
                b"\0",
            )
        )
    elif how == "format":
        lines.append(
            rng.choice((b"FORMAT=32-bit_rle_xyze", b"FORMAT=", b"FORMAT=64", b"EXPOSURE=1e38"))
        )
    else:
        changed = bytearray(body)
        for _ in range(8):
            changed[rng.randrange(len(changed))] = rng.choice((0, 1, 2, 127, 128, 129, 255))
        body = bytes(changed)
    return b"\n".join(lines) + b"\n\n" + size + b"\n" + body, how


def ply(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """A PLY's header, or the numbers of an ASCII one, changed."""
    head, end, body = data.partition(b"end_header\n")
    lines = head.decode().splitlines()
    how = rng.choice(("count", "count", "type", "line", "body"))
    if how == "count":
        places = [i for i, line in enumerate(lines) if line.startswith("element")]
        place = rng.choice(places)
        value = rng.choice((*COUNTS, 10**18, "nan", "1.5", ""))
        lines[place] = lines[place].rsplit(" ", 1)[0] + f" {value}"
    elif how == "type":
        place = rng.choice([i for i, line in enumerate(lines) if line.startswith("property")])
        kinds = (
            "char",
            "uchar",
            "short",
            "int",
            "uint",
            "float",
            "double",
            "list",
            "int64",
            "string",
        )
        lines[place] = re.sub(r"\b(float|int|uchar|uint|double)\b", rng.choice(kinds), lines[place])
    elif how == "line":
        place = rng.randrange(1, len(lines))
        if rng.random() < 0.5:
            lines[place] = rng.choice(PLY_LINES)
        else:
            lines.insert(place, rng.choice((*PLY_LINES, lines[place])))
    else:
        body = _tokens(body, rng)
    return "\n".join(lines).encode() + b"\n" + end + body, how


def obj(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """Lines of an OBJ changed or added."""
    if rng.random() < 0.5:
        return _tokens(data, rng), "tokens"
    lines = data.split(b"\n")
    lines.insert(rng.randrange(len(lines)), rng.choice(OBJ_LINES))
    return b"\n".join(lines), "line"


def stl(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """The count of a binary STL, one of its numbers, or the words of an ASCII one."""
    if data.startswith(b"solid"):
        return _tokens(data, rng), "tokens"
    made = bytearray(data)
    if rng.random() < 0.4:
        struct.pack_into("<i", made, 80, rng.choice(COUNTS))
        return bytes(made), "count"
    numbers = (float("nan"), float("inf"), 3e38, 1e16, -1e30, 1e-40, 0.0)
    for _ in range(rng.choice((1, 3, 20))):
        triangle, place = rng.randrange(20), rng.randrange(12)
        struct.pack_into("<f", made, 84 + 50 * triangle + 4 * place, rng.choice(numbers))
    return bytes(made), "numbers"


def glb(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """The tree of a GLB, the lengths of its chunks, or its numbers."""
    (size,) = struct.unpack_from("<I", data, 12)
    text, rest = data[20 : 20 + size].decode(), bytearray(data[20 + size :])
    how = rng.choice(("tree", "tree", "planted", "planted", "lengths", "numbers"))
    if how == "tree":
        written, done = trees.mutated(text, "json", rng)
        how = f"tree: {done}"
    else:
        tree = json.loads(text)
        if how == "planted":
            how = f"planted: {_plant(tree, rng)}"
        written = json.dumps(tree).encode()
    if how == "numbers":
        for _ in range(rng.choice((1, 4))):
            place = 8 + 4 * rng.randrange((len(rest) - 8) // 4)
            struct.pack_into(
                "<I", rest, place, rng.choice((0x7FC00000, 0x7F800000, 0xFFFFFFFF, 1, 0))
            )
    written += b" " * (-len(written) % 4)
    whole = 20 + len(written) + len(rest)
    head = [0x46546C67, 2, whole, len(written), 0x4E4F534A]
    if how == "lengths":
        head[rng.randrange(5)] = rng.choice((0, 1, 0xFFFFFFFF, 0x7FFFFFFF, len(written) + 4))
    return struct.pack("<5I", *head) + written + rest, how


def _plant(tree: dict, rng: random.Random) -> str:
    """What is legal JSON and a trap: a loop of nodes, a file elsewhere, a claim of much memory."""
    accessor, node = rng.choice(tree["accessors"]), rng.choice(tree["nodes"])
    buffer, first = tree["buffers"][0], tree["meshes"][0]["primitives"][0]
    view, elsewhere = rng.choice(tree["bufferViews"]), ("zero.ply", "/dev/zero", "fifo.ply")
    traps: dict[str, Callable] = {
        "its own child": lambda: node.update(children=list(range(len(tree["nodes"])))),
        "many children": lambda: node.update(children=[0] * 100_000),
        "a buffer elsewhere": lambda: buffer.update(uri=rng.choice(elsewhere)),
        "data in the text": lambda: buffer.update(uri="data:application/octet-stream;base64,AAAA"),
        "a huge count": lambda: accessor.update(count=rng.choice((10**7, 10**9, 10**12, 2**62))),
        "no bytes at all": lambda: accessor.pop("bufferView", None),
        "zeros": lambda: (accessor.pop("bufferView", None), accessor.update(count=10**9)),
        "sparse": lambda: accessor.update(sparse={"count": 10**9, "indices": {}, "values": {}}),
        "a matrix of zeros": lambda: node.update(matrix=[0.0] * 16),
        "a matrix of NaN": lambda: node.update(matrix=[float("nan")] * 16),
        "a scale of zero": lambda: node.update(scale=[0, 1, 1]),
        "points": lambda: first.update(mode=rng.randrange(8)),
        "draco": lambda: tree.update(extensionsRequired=["KHR_draco_mesh_compression"]),
        "no meshes": lambda: tree.update(meshes=[]),
        "another scene": lambda: tree.update(scene=7),
        "a long view": lambda: view.update(byteLength=2**40, byteOffset=-4),
        "a picture elsewhere": lambda: tree.update(
            images=[{"uri": "/dev/zero"}],
            textures=[{"source": 0}],
            materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        ),
    }  # fmt: skip
    name = rng.choice(list(traps))
    traps[name]()
    return name


def refs(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """A pack with its manifest, a member or the way that it is zipped changed."""
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        members = {name: file.read(name) for name in file.namelist()}
    how = rng.choice(("manifest", "manifest", "head", "member", "name", "zip", "bomb"))
    named = [n for n in members if n != "manifest.json"]
    chosen, method = rng.choice(named), zipfile.ZIP_STORED
    if how == "manifest":
        members["manifest.json"], _ = trees.mutated(members["manifest.json"].decode(), "json", rng)
    elif how == "head":
        chosen = rng.choice([n for n in named if n.endswith(".json")])
        members[chosen], _ = trees.mutated(members[chosen].decode(), "json", rng)
        _declare(members, chosen)
    elif how == "member":
        change = exr if chosen.endswith(".exr") else obj
        members[chosen], _ = change(members[chosen], rng)
        _declare(members, chosen)
    elif how == "name":
        name = rng.choice(
            ("../x", "/tmp/x", "a\\b", "x" * 60_000, "\u202ex", "con", f"{chosen}/x", ".")
        )
        members[name] = members.pop(chosen)
        _declare(members, name)
    elif how == "zip":
        method = rng.choice((zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
    else:
        members["manifest.json"] = b" " * (1 << 28)
        method = zipfile.ZIP_DEFLATED
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", method, compresslevel=1) as file:
        for name, content in members.items():
            file.writestr(name, content)
    return made.getvalue(), how


def _declare(members: dict[str, bytes], name: str) -> None:
    """Tell the manifest what a member holds now, so that the mutation comes through."""
    import hashlib

    manifest = json.loads(members["manifest.json"])
    manifest["files"] = {n: d for n, d in manifest["files"].items() if n in members}
    manifest["files"][name] = hashlib.sha256(members[name]).hexdigest()
    members["manifest.json"] = json.dumps(manifest).encode()


def _tokens(data: bytes, rng: random.Random) -> bytes:
    """Some words of a text replaced."""
    parts = re.split(rb"(\s+)", data)
    for _ in range(rng.choice((1, 1, 3, 20))):
        parts[2 * rng.randrange((len(parts) + 1) // 2)] = rng.choice(TOKENS).encode()
    return b"".join(parts)


KNOWING = {"exr": exr, "hdr": hdr, "ply": ply, "obj": obj, "stl": stl, "glb": glb, "refs": refs}
