"""A header may claim anything: no memory is taken, and no file opened, on its word alone."""

import io
import json
import os
import signal
import struct
import zipfile
from pathlib import Path

import pytest

from reference.pack import unpack
from reference.store import Store
from scenes.environment import read_pixels
from scenes.errors import InputError
from scenes.mesh import load_mesh
from tests.fuzz.corpus import corpus
from tests.fuzz.worker import memory

MOST = 150 << 20  # bytes; a picture of 16384x16384 takes 3 GiB
LARGEST = (0, 0, 16383, 16383)


@pytest.fixture(scope="module")
def files():
    return corpus()


@pytest.fixture
def refused_cheaply(tmp_path, refused):
    """Reading these bytes is refused with these words, and takes hardly any memory."""

    def check(name, data, call, *words):
        path = tmp_path / name
        path.write_bytes(data)
        Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
        before = memory(os.getpid(), "VmRSS")
        refused(lambda: call(path), name, *words)
        assert memory(os.getpid(), "VmHWM") - before < MOST

    return check


def picture(path):
    return read_pixels(path, "environment")


def mesh(path):
    return load_mesh(str(path))


def with_window(data, *names):
    """An EXR whose windows of these names are the largest that is allowed."""
    made = bytearray(data)
    for name in names:
        place = data.index(name.encode() + b"\0box2i\0") + len(name) + 7
        struct.pack_into("<4i", made, place + 4, *LARGEST)
    return bytes(made)


@pytest.mark.parametrize("variant", ["none", "zip", "piz", "dwaa", "rle", "tiled"])
def test_an_exr_that_claims_more_than_it_holds_takes_no_memory(files, refused_cheaply, variant):
    data = with_window(files["exr"][variant], "dataWindow", "displayWindow")
    refused_cheaply("a.exr", data, picture, "export it again")


def test_an_exr_that_shows_more_than_it_stores_takes_no_memory(files, refused_cheaply):
    data = with_window(files["exr"]["zip"], "displayWindow")
    told = "stores 32x16 of its 16384x16384 pixels; export all of them"
    refused_cheaply("a.exr", data, picture, told)


def test_an_hdr_that_claims_more_than_it_holds_takes_no_memory(files, refused_cheaply):
    data = files["hdr"]["rle"].replace(b"-Y 16 +X 32", b"-Y 16384 +X 16384")
    refused_cheaply("a.hdr", data, picture, "export it again")


def test_a_picture_of_another_size_is_told_by_its_header(files, tmp_path):
    (tmp_path / "a.exr").write_bytes(with_window(files["exr"]["zip"], "displayWindow"))
    with pytest.raises(InputError, match="is 16384x16384 pixels, not 24x18; draw it at the size"):
        read_pixels(tmp_path / "a.exr", "picture", (24, 18))


@pytest.mark.parametrize(
    ("kind", "variant", "old", "new"),
    [
        ("ply", "binary", b"element vertex 42", b"element vertex 1000000000"),
        ("ply", "ascii", b"element face 20", b"element face 1000000000"),
        ("glb", "normals", b'"count":42', b'"count":4200000000'),
    ],
)
def test_a_mesh_that_claims_more_than_it_holds_takes_no_memory(
    files, refused_cheaply, kind, variant, old, new
):
    data = files[kind][variant]
    assert old in data
    change = resized if kind == "glb" else lambda whole, edit: edit(whole)
    data = change(data, lambda text: text.replace(old, new))
    refused_cheaply(f"a.{kind}", data, mesh, "claims more than it holds; export it again")


def resized(data, change):
    """A GLB with its JSON changed, and the lengths to match."""
    (size,) = struct.unpack_from("<I", data, 12)
    text, rest = change(data[20 : 20 + size].rstrip()), data[20 + size :]
    text += b" " * (-len(text) % 4)
    head = (0x46546C67, 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    return struct.pack("<5I", *head) + text + rest


def test_a_glb_of_zeros_or_with_its_triangles_elsewhere_is_refused(files, refused_cheaply):
    def without_view(text):
        tree = json.loads(text)
        del tree["accessors"][0]["bufferView"]
        tree["accessors"][0]["count"] = 10**9
        return json.dumps(tree).encode()

    def elsewhere(text):
        tree = json.loads(text)
        tree["buffers"][0]["uri"] = "/dev/zero"
        return json.dumps(tree).encode()

    data = files["glb"]["normals"]
    refused_cheaply("a.glb", resized(data, without_view), mesh, "claims more than it holds")
    refused_cheaply("b.glb", resized(data, elsewhere), mesh, "in another file", "as one file")


@pytest.fixture
def in_time():
    """Fail, and do not wait for ever, where a pipe is opened after all."""

    waited = []

    def late(*_):
        waited.append("a pipe or a device is read")
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(10)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
    assert not waited  # a library may have swallowed the error


@pytest.mark.usefixtures("in_time")
@pytest.mark.parametrize("other", ["/dev/zero", "endless.mtl"])
def test_the_files_that_a_mesh_names_are_not_opened(files, tmp_path, other):
    os.mkfifo(tmp_path / "endless.mtl")  # whoever opens it waits for ever
    (tmp_path / "a.obj").write_bytes(f"mtllib {other}\nusemtl a\n".encode() + files["obj"]["bare"])
    assert len(load_mesh(str(tmp_path / "a.obj")).faces) == 20


def test_a_damaged_obj_is_told_its_line(tmp_path, refused):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n")
    refused(lambda: load_mesh(str(tmp_path / "a.obj")), "a.obj", "(line 3)", "export it again")


def test_a_pack_that_unfolds_is_refused_before_it_does(refused_cheaply, tmp_path):
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("manifest.json", b" " * (1 << 28))
    assert len(made.getvalue()) < 1 << 20
    into = Store(tmp_path / "store")
    refused_cheaply("a.refs", made.getvalue(), lambda path: unpack(path, into), "is compressed")


@pytest.mark.usefixtures("in_time")
@pytest.mark.parametrize("aim", ["/dev/zero", "/dev/full", "pipe", "folder", "loop"])
def test_what_is_no_file_is_not_read(tmp_path, refused, aim):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (link := tmp_path / "loop").symlink_to(aim)
    into = Store(tmp_path / "store")
    refused(lambda: unpack(link, into), "loop", "file" if aim != "folder" else "is a folder")
    assert not (tmp_path / "store").exists()
