"""How the tests end, and how a user's mistake must read."""

import os
import sys

import pytest

from scenes.errors import InputError

STATUS = pytest.StashKey[int]()


def pytest_sessionfinish(session, exitstatus):
    session.config.stash[STATUS] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """Leave without the interpreter's clean-up.

    OpenImageIO's bindings call what modules still hold at exit a leak, in twenty lines that would
    bury the verdict.
    """
    if STATUS in config.stash:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash[STATUS])


@pytest.fixture
def refused():
    """Call something that must raise InputError whose one line holds all the given words."""

    def check(call, *words: str) -> InputError:
        with pytest.raises(InputError) as caught:
            call()
        error = caught.value
        assert len(str(error).splitlines()) == 1
        assert error.problem and error.remedy and error.remedy in str(error)
        for word in words:
            assert word in str(error)
        return error

    return check
