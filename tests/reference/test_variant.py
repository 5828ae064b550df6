"""Finding an LLVM that works, without dying from one that does not."""

import glob
import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from reference import batches, variant
from reference.variant import VARIABLE, candidates, mitsuba
from scenes.errors import InputError

OLD = sorted(glob.glob("/usr/lib/*/libLLVM-1[56].so*"))


def python(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | environment,
        capture_output=True,
        text=True,
    )


def test_a_jit_variant_is_set():
    assert mitsuba().variant() in ("llvm_ad_rgb", "cuda_ad_rgb")


def test_looking_into_a_store_starts_no_mitsuba():
    code = "import sys, reference.store, reference.batches, reference.timing;"
    assert python(code + "print('mitsuba' in sys.modules)").stdout == "False\n"


def test_newest_libraries_come_first_and_old_ones_not_at_all():
    assert not any("-14" in p.name or "-15" in p.name for p in candidates())


@pytest.mark.parametrize(
    "library",
    ["/nowhere/libLLVM.so", *(pytest.param(p) for p in OLD[:1])],
)
def test_a_library_that_cannot_compile_is_an_error_not_an_abort(library, tmp_path):
    code = "from reference.variant import find_llvm; find_llvm()"
    answer = python(code, **{VARIABLE: library, "XDG_CACHE_HOME": str(tmp_path)})
    assert answer.returncode == 1  # an exception; an abort would be -6
    assert InputError.__name__ in answer.stderr
    assert "apt-get install libllvm19" in answer.stderr


def test_a_probe_is_made_once(tmp_path):
    code = (
        "from reference import variant; p = variant.find_llvm();"
        "variant.subprocess.run = None; print(variant.works(p))"
    )
    answer = python(code, XDG_CACHE_HOME=str(tmp_path))
    assert answer.stdout == "True\n"
    assert len(list((tmp_path / "shadeproof").iterdir())) == 1


class Driver:
    """NVIDIA's, with one GPU."""

    def cuInit(self, _flags):
        return 0

    def cuDeviceGetCount(self, count):
        count._obj.value = 1
        return 0

    def cuDeviceGet(self, _device, _ordinal):
        return 0

    def cuDeviceGetName(self, name, _size, _device):
        name.value = b"a GPU"
        return 0


@pytest.mark.parametrize(("lacks", "name"), [("", "a GPU"), ("optix", ""), ("cuda", "")])
def test_a_gpu_traces_rays_where_its_driver_brings_cuda_and_optix(monkeypatch, lacks, name):
    def load(library):
        if lacks and lacks in library:
            raise OSError(library)
        return Driver()

    monkeypatch.setattr(variant.ctypes, "CDLL", load)
    assert variant.gpu.__wrapped__() == name


def test_a_reference_names_the_gpu_that_traced_it(monkeypatch):
    monkeypatch.setattr(batches, "gpu", lambda: "a GPU")
    monkeypatch.setattr(batches, "mitsuba", lambda: SimpleNamespace(variant=lambda: "cuda_ad_rgb"))
    facts = batches._machine.__wrapped__()
    assert (facts["variant"], facts["device"]) == ("cuda_ad_rgb", "a GPU")
