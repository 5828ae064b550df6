#!/usr/bin/env bash
# Makes sure of what pip cannot install: a Python that can make a venv, OpenGL through EGL
# with a driver (Mesa's software driver will do), and for Mitsuba libatomic and LLVM 19 or newer.
# Says nothing when all is there. What is missing is installed with apt-get, by root or with
# a sudo that asks no password; otherwise one line says what to type.
#
# With the argument `blender`: what the package bpy takes instead, which is Python 3.11 and
# libraries of the X window system (it opens no window).
#
# From the environment:
#   PYTHON              the interpreter to use (default python3)
#   NO_APT=1            install nothing, only say what to type
#   DRJIT_LIBLLVM_PATH  an LLVM library that is not where the system's loader finds it
# Exit status: 0 all is there, 2 something is missing.
set -euo pipefail

python=${PYTHON:-python3}
purpose=${1:-}

fail() {
    echo "shadeproof: $*" >&2
    exit 2
}

has_venv() {
    "$python" -c 'import ensurepip, venv' 2>/dev/null
}

# Opens a display on an EGL device, as moderngl does: the libraries alone, without a driver,
# would load and then fail.
has_opengl() {
    "$python" - 2>/dev/null <<'PY'
from ctypes import CDLL, CFUNCTYPE, byref, c_char_p, c_int, c_uint, c_void_p

CDLL("libGL.so.1")
egl = CDLL("libEGL.so.1")
egl.eglGetProcAddress.restype = c_void_p
egl.eglGetProcAddress.argtypes = [c_char_p]
egl.eglInitialize.argtypes = [c_void_p, c_void_p, c_void_p]
query_devices = CFUNCTYPE(c_uint, c_int, c_void_p, c_void_p)(
    egl.eglGetProcAddress(b"eglQueryDevicesEXT")
)
platform_display = CFUNCTYPE(c_void_p, c_uint, c_void_p, c_void_p)(
    egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
)
EGL_PLATFORM_DEVICE_EXT = 0x313F
devices, count = (c_void_p * 16)(), c_int()
query_devices(16, devices, byref(count))
displays = (platform_display(EGL_PLATFORM_DEVICE_EXT, d, None) for d in devices[: count.value])
raise SystemExit(0 if any(egl.eglInitialize(d, None, None) for d in displays) else 1)
PY
}

has_llvm() {
    "$python" - 2>/dev/null <<'PY'
import os
from ctypes import CDLL, byref, c_uint


def version(path):
    major = c_uint()
    try:
        CDLL(path).LLVMGetVersion(byref(major), byref(c_uint()), byref(c_uint()))
    except (OSError, AttributeError):  # not there, or older than LLVM 16
        return 0
    return major.value


own = os.environ.get("DRJIT_LIBLLVM_PATH")
names = [own] if own else [f"libLLVM{n}" for v in range(19, 40) for n in (f".so.{v}.1", f"-{v}.so")]
raise SystemExit(0 if any(version(name) >= 19 for name in names) else 1)
PY
}

has_atomic() {
    "$python" -c 'from ctypes import CDLL; CDLL("libatomic.so.1")' 2>/dev/null
}

# glcontext and flip-evaluator ship no ready-made builds for processors other than x86_64.
has_compiler() {
    [ "$(uname -m)" = x86_64 ] && return
    printf '#include <Python.h>\n#include <X11/Xlib.h>\nint main() {}\n' |
        c++ -x c++ - -o /dev/null -lGL -lEGL \
            -I"$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')" 2>/dev/null
}

has_x() {
    "$python" - 2>/dev/null <<'PY'
from ctypes import CDLL

for name in ("X11.so.6", "Xrender.so.1", "Xfixes.so.3", "Xi.so.6", "xkbcommon.so.0", "SM.so.6",
             "ICE.so.6", "GL.so.1"):
    CDLL(f"lib{name}")
PY
}

find_missing_for_blender() {
    missing=()
    if [ "$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>&1)" != 3.11 ]; then
        fail "Blender's package bpy takes Python 3.11, and $python is none: install it" \
            "(uv python install 3.11) and say make crosscheck PYTHON311=path/to/python3.11"
    fi
    has_venv || missing+=(python3.11-venv)
    has_x || missing+=(libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1)
}

find_missing() { # sets `missing` to the Debian packages that would mend what is missing
    if [ "$purpose" = blender ]; then
        find_missing_for_blender
        return
    fi
    missing=()
    if command -v "$python" >/dev/null; then
        version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
        case $version in
        3.11 | 3.12 | 3.13) ;;
        *) fail "$python is Python $version; it takes 3.11, 3.12 or 3.13: make PYTHON=python3.12" ;;
        esac
        has_venv || missing+=("python$version-venv")
    else
        [ "$python" = python3 ] || fail "there is no $python; give another: make PYTHON=python3"
        missing+=(python3 python3-venv)
    fi
    has_opengl || missing+=(libegl1 libgl1 libgl1-mesa-dri)
    has_atomic || missing+=(libatomic1)
    has_llvm || missing+=("$(llvm_package)")
    has_compiler || missing+=(g++ "python${version:-3}-dev" libx11-dev libgl-dev libegl-dev)
}

llvm_package() { # the oldest that will do, of those the distribution has
    local major
    for major in 19 20 21 22; do
        if apt-cache show "libllvm$major" >/dev/null 2>&1; then
            echo "libllvm$major"
            return
        fi
    done
    echo libllvm19
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi
}

apt() { # quiet, unless it fails
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq -o DPkg::Lock::Timeout=300 "$@" >"$log" 2>&1 || {
        cat "$log" >&2
        fail "apt-get $1 failed"
    }
}

find_missing
[ ${#missing[@]} = 0 ] && exit

if [ "$purpose" != blender ] && [ -n "${DRJIT_LIBLLVM_PATH:-}" ] && ! has_llvm; then
    fail "DRJIT_LIBLLVM_PATH=$DRJIT_LIBLLVM_PATH is no LLVM 19 or newer: correct or unset it"
fi
if ! command -v apt-get >/dev/null; then
    [ "$purpose" != blender ] || fail "Blender needs the libraries X11, Xrender, Xfixes, Xi," \
        "xkbcommon, SM, ICE and GL, and there is no apt-get to install them with"
    fail "something is missing, and there is no apt-get to install it with; it takes Python's" \
        "venv and ensurepip, libGL.so.1 and libEGL.so.1 with Mesa's driver, libatomic.so.1," \
        "and libLLVM 19 or newer"
fi
if [ "${NO_APT:-}" = 1 ] || ! as_root true 2>/dev/null; then
    sudo=$([ "$(id -u)" = 0 ] || echo "sudo ")
    fail "something is missing; type: ${sudo}apt-get update &&" \
        "${sudo}apt-get install -y --no-install-recommends ${missing[*]}"
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
echo "shadeproof: fetching the list of system packages (apt-get update)"
apt update
find_missing # the new list may name another LLVM
echo "shadeproof: installing system packages with apt-get: ${missing[*]}"
apt install -y --no-install-recommends "${missing[@]}"
find_missing
[ ${#missing[@]} = 0 ] || fail "apt-get has installed, but these still do not work: ${missing[*]}"
