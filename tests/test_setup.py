"""What a machine is given before anything can be rendered: pins, system libraries, make."""

import ast
import importlib.metadata
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
ROOMS = ("scenes", "renderer", "reference", "reports")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
DECLARED = [Requirement(line) for line in PROJECT["project"]["dependencies"]]
PINS = (ROOT / "requirements" / "requirements.txt").read_text()


def test_every_pin_has_a_hash():
    # A pin reads `name==version ; marker \`, and its hashes stand indented below it.
    pins = re.split(r"\n(?=[a-z0-9])", PINS)[1:]
    assert len(pins) > len(DECLARED)
    for pin in pins:
        assert re.match(r"[a-z0-9-]+==\S+ (; [^\n]+ )?\\\n    --hash=sha256:[0-9a-f]{64}\b", pin), (
            pin
        )


def test_pins_name_no_download_address():
    for path in (ROOT / "requirements").iterdir():
        assert not re.search(r"://|--(extra-)?index-url|--find-links", path.read_text()), path


def test_pins_satisfy_pyproject():
    pinned = dict(re.findall(r"^([a-z0-9-]+)==(\S+)", PINS, re.MULTILINE))
    extras = PROJECT["project"]["optional-dependencies"]
    asked = [*extras["renderer"], *extras["reference"], *PROJECT["dependency-groups"]["dev"]]
    for requirement in [*DECLARED, *map(Requirement, asked)]:
        version = pinned.get(canonicalize_name(requirement.name))
        assert version, f"requirements.txt lacks {requirement.name}"
        assert requirement.specifier.contains(version), f"{requirement}, but {version} is pinned"


def third_party_imports(source):
    """The top-level modules that a file imports, less the standard library and the rooms."""
    modules = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            modules |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            modules.add(node.module.partition(".")[0])
    return modules - sys.stdlib_module_names - set(ROOMS)


def test_imports_are_declared():
    extras = PROJECT["project"]["optional-dependencies"].values()
    asked = [*DECLARED, *(Requirement(line) for extra in extras for line in extra)]
    declared = {canonicalize_name(requirement.name) for requirement in asked}
    providers = importlib.metadata.packages_distributions()
    files = [path for room in ROOMS for path in (ROOT / room).rglob("*.py")]
    imported = {path: third_party_imports(path.read_text()) for path in files}
    assert "numpy" in set().union(*imported.values())
    for path, modules in imported.items():
        for module in modules:
            names = {canonicalize_name(name) for name in providers.get(module, [module])}
            assert names & declared, f"{path.relative_to(ROOT)} imports {module}: declare it"


def run(command, **environment):
    """Run a command in the checkout, away from the variables of a make around these tests."""
    outer = ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "NO_APT", "PYTHON", "SUITE", "DRJIT_LIBLLVM_PATH")
    inherited = {name: value for name, value in os.environ.items() if name not in outer}
    return subprocess.run(
        command,
        cwd=ROOT,
        env=inherited | environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
    )


def test_make_alone_prints_every_target():
    phony = re.search(r"^\.PHONY: (.+)$", (ROOT / "Makefile").read_text(), re.MULTILINE)[1].split()
    printed = dict(re.findall(r"^make (\S+) +(\S.+)$", run("make").stdout, re.MULTILINE))
    assert set(printed) == set(phony) - {"FORCE"}
    assert {"compare", "gate", "report", "test"} <= set(printed)


def system_sh(tmp_path, **environment):
    """Run system.sh where apt-get and sudo only leave a mark that they were called."""
    for name in ("apt-get", "sudo"):
        stub = tmp_path / name
        stub.write_text(f"#!/bin/sh\ntouch '{tmp_path}/called'\n")
        stub.chmod(0o755)
    path = f"{tmp_path}:{os.environ['PATH']}"
    done = run("requirements/system.sh", **{"PATH": path, "PYTHON": sys.executable, **environment})
    assert not (tmp_path / "called").exists()
    return done


def commands_of(*words):
    """What make would run, from a .venv as it stands."""
    return run(("make", "-n", "-o", ".venv/.stamp", *words)).stdout


def test_make_bench_takes_the_suite_that_is_asked_for():
    assert "bench --suite 'mine.toml'" in " ".join(commands_of("bench", "SUITE=mine.toml").split())
    assert "--suite" not in (own := commands_of("bench")) and "shadeproof bench" in own


def test_system_sh_is_silent_when_nothing_is_missing(tmp_path):
    done = system_sh(tmp_path, NO_APT="1")
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("libraries", "package"),
    [
        (["libGL.so.1"], "libgl1"),
        (["libEGL.so.1"], "libegl1"),
        (["libatomic.so.1"], "libatomic1"),
        ([f"libLLVM{n}" for v in range(19, 40) for n in (f".so.{v}.1", f"-{v}.so")], "libllvm"),
    ],
)
def test_system_sh_names_the_package_of_a_missing_library(tmp_path, libraries, package):
    for library in libraries:
        (tmp_path / library).touch()  # an empty file hides the real one from the loader
    done = system_sh(tmp_path, NO_APT="1", LD_LIBRARY_PATH=str(tmp_path))
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert re.search(rf"apt-get install -y --no-install-recommends .*\b{package}", done.stderr)


def test_system_sh_refuses_an_unsuitable_python(tmp_path):
    old = tmp_path / "python3.9"
    old.write_text("#!/bin/sh\necho 3.9\n")
    old.chmod(0o755)
    done = system_sh(tmp_path, PYTHON=str(old))
    assert done.returncode == 2
    assert done.stderr.endswith(
        "is Python 3.9; it takes 3.11, 3.12 or 3.13: make PYTHON=python3.12\n"
    )
