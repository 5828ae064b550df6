"""The unit in which speed is quoted."""

import time

from reference.timing import RUNS, seconds_per_sample


def test_one_sample_per_pixel_takes_its_share_of_the_time_that_all_runs_take(make_case):
    case = make_case(width=320, height=240)
    start = time.perf_counter()
    unit = seconds_per_sample(case)
    spent = time.perf_counter() - start
    assert 0 < unit < spent / (RUNS / 2)  # at least half the runs take no less than the median


def test_more_pixels_take_longer(make_case):
    small = make_case(width=64, height=48)
    large = make_case(width=1280, height=960)  # 400 times as many pixels
    assert seconds_per_sample(large) > 4 * seconds_per_sample(small)
