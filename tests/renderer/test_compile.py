"""A shader that does not compile is told in one line, at its own file and line."""

import shutil
from functools import partial

import moderngl
import pytest

from renderer import glsl, program
from renderer.probe import probe


@pytest.fixture
def shaders(tmp_path, monkeypatch):
    """A copy of the shaders that a test may spoil."""
    copy = shutil.copytree(glsl.SHADERS, tmp_path / "shaders")
    for module in (glsl, program):
        monkeypatch.setattr(module, "SHADERS", copy)
    (copy / "part.glsl").write_text("float half_of(float x) {\n    return x / 2.0;\n}\n")
    for cached in (glsl._read, glsl._files, program.program):
        cached.cache_clear()
    yield copy
    for cached in (glsl._read, glsl._files, program.program):
        cached.cache_clear()


MAIN = """#version 330
in vec2 uv;
#include "part.glsl"
out vec4 colour;
void main() {
    colour = vec4(half_of(uv.x));
}
"""


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("main.frag", MAIN.replace("in vec2 uv;", "in vec2 uv; float one = nothing;"), 2),
        ("main.frag", MAIN.replace("half_of(uv.x)", "nothing"), 6),
        ("part.glsl", "float half_of(float x) {\n\n    return nothing;\n}\n", 3),
        ("part.glsl", '#include "common.glsl"\nfloat half_of(float x) { return nothing; }\n', 2),
    ],
)
def test_a_mistake_is_told_at_its_own_file_and_line(shaders, refused, name, text, line):
    (shaders / "main.frag").write_text(MAIN)
    made = partial(program.program, "fullscreen.vert", "main.frag", frozenset({"SOMETHING"}))
    made()
    program.program.cache_clear()
    glsl._read.cache_clear()
    (shaders / name).write_text(text)
    error = refused(made, "nothing", "does not compile")
    assert error.where == f"{shaders / name}:{line}"


def test_a_probe_tells_the_file_of_a_function_or_else_its_expression(shaders, refused):
    (shaders / "part.glsl").write_text("float half_of(float x) { return nothing; }\n")
    error = refused(lambda: probe("vec4(half_of(x.x))", {"x": [1.0]}, ("part.glsl",)), "nothing")
    assert error.where == f"{shaders / 'part.glsl'}:1"
    error = refused(lambda: probe("vec4(third_of(x.x))", {"x": [1.0]}, ()), "third_of")
    assert error.where.startswith("vec4(third_of(x.x))")


def test_shaders_that_do_not_fit_are_told(shaders, refused):
    (shaders / "main.frag").write_text(MAIN.replace("vec2 uv", "vec3 uv").replace("uv.x", "uv.z"))
    error = refused(lambda: program.program("fullscreen.vert", "main.frag"), "uv")
    # NVIDIA's compiler tells where the other of the two declares it.
    assert error.where in (str(shaders / "main.frag"), f"{shaders / 'fullscreen.vert'}:3")


@pytest.mark.parametrize(
    "said",
    [
        "0:1(1): warning: old\n0:{}(20): error: `x' undeclared",
        "0({}) : error C1008: `x' undeclared",
        "ERROR: 0:{}: `x' undeclared",
    ],
)
def test_every_drivers_way_to_tell_a_place_is_read(said, refused, monkeypatch):
    def refuses(**_):
        raise moderngl.Error("GLSL Compiler failed\n\n" + said.format(line))

    line = glsl._files().index("brdf.glsl") * glsl.SPAN + 14
    monkeypatch.setattr(program, "context", lambda: type("GL", (), {"program": refuses}))
    error = refused(lambda: program.compiled("", "", "a.frag"))
    assert error.where == f"{glsl.SHADERS / 'brdf.glsl'}:14"
    assert error.problem == "does not compile: `x' undeclared"
