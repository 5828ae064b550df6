"""Radiance maps: decoded alike from both formats, whole, finite and not negative."""

import numpy as np
import OpenImageIO as oiio
import pytest

from scenes.environment import LARGEST, load_environment

MAP = np.random.default_rng(7).uniform(0, 4, (16, 32, 3)).astype(np.float32)


def test_exr_is_read_exactly(write_image):
    loaded = load_environment(write_image("map.exr", MAP))
    np.testing.assert_array_equal(loaded.radiance, MAP)
    assert loaded.radiance.dtype == np.float32 and loaded.negatives == 0


def test_hdr_and_exr_load_alike(write_image):
    exr = load_environment(write_image("map.exr", MAP)).radiance
    hdr = load_environment(write_image("map.hdr", MAP)).radiance
    # RGBE: 8 bits of mantissa for the largest channel, and the writer cuts off.
    assert (np.abs(hdr - exr) <= MAP.max(axis=2, keepdims=True) / 128).all()


def test_hdr_stored_from_the_bottom_up_is_turned(write_image, tmp_path):
    path = write_image("map.hdr", MAP)
    turned = path.read_bytes().replace(b"-Y 16 +X 32", b"+Y 16 +X 32")
    (tmp_path / "turned.hdr").write_bytes(turned)
    down, up = load_environment(path), load_environment(tmp_path / "turned.hdr")
    np.testing.assert_array_equal(up.radiance, down.radiance[::-1])


@pytest.mark.parametrize(
    ("channels", "order"),
    [
        (("R", "G", "B"), [0, 1, 2]),
        (("B", "G", "R"), [2, 1, 0]),
        (("r", "g", "b"), [0, 1, 2]),
        (("Sky.R", "Sky.G", "Sky.B"), [0, 1, 2]),
    ],
)
def test_channels_are_found_by_name(write_image, channels, order):
    loaded = load_environment(write_image("map.exr", MAP, channels))
    np.testing.assert_array_equal(loaded.radiance, MAP[..., order])


def test_plain_channels_win_over_a_layer(write_image):
    both = np.concatenate([MAP, 2 * MAP], axis=2)
    names = ("Albedo.R", "Albedo.G", "Albedo.B", "R", "G", "B")
    loaded = load_environment(write_image("map.exr", both, names))
    np.testing.assert_array_equal(loaded.radiance, 2 * MAP)


def test_grey_is_spread_and_alpha_left_out(write_image):
    grey = load_environment(write_image("grey.exr", MAP[..., :1], ("Y",)))
    np.testing.assert_array_equal(grey.radiance, np.repeat(MAP[..., :1], 3, axis=2))
    rgba = np.concatenate([MAP, np.full((16, 32, 1), 0.5)], axis=2)
    loaded = load_environment(write_image("rgba.exr", rgba, ("R", "G", "B", "A")))
    np.testing.assert_array_equal(loaded.radiance, MAP)


@pytest.mark.parametrize("names", [("Z",), ("R",), ("Sky.A",)], ids=str)
def test_one_channel_that_is_no_luminance_is_refused(write_image, refused, names):
    path = write_image("map.exr", MAP[..., :1], names)
    refused(lambda: load_environment(path), "map.exr", names[0], "export it as RGB")


def test_several_layers_are_refused_by_name(write_image, refused):
    names = ("Key.R", "Key.G", "Key.B", "Fill.R", "Fill.G", "Fill.B")
    path = write_image("map.exr", np.concatenate([MAP, MAP], axis=2), names)
    refused(lambda: load_environment(path), "map.exr", "Key", "Fill", "one of them")
    mixed = write_image("mixed.exr", MAP, ("R", "Key.G", "Key.B"))
    refused(lambda: load_environment(mixed), "mixed.exr", "export it as RGB")


@pytest.mark.parametrize("ending", ["exr", "hdr"])
def test_a_renamed_picture_is_refused_for_what_it_is(write_image, refused, ending):
    path = write_image("map.png", MAP / 4)
    path = path.rename(path.with_name(f"m.{ending}"))
    refused(lambda: load_environment(path), f"m.{ending}", "is a png, 8 bit", "convert it to .exr")


def test_an_exr_named_hdr_is_refused(write_image, refused):
    path = write_image("map.exr", MAP)
    path = path.rename(path.with_suffix(".hdr"))
    refused(lambda: load_environment(path), "map.hdr", "is an openexr", "name it .exr")


def test_several_parts_are_refused(tmp_path, refused):
    specs = [oiio.ImageSpec(32, 16, 3, oiio.FLOAT) for _ in range(2)]
    path = str(tmp_path / "parts.exr")
    image = oiio.ImageOutput.create(path)
    assert image.open(path, tuple(specs)) and image.write_image(MAP)
    assert image.open(path, specs[1], "AppendSubimage") and image.write_image(3 * MAP)
    image.close()
    refused(lambda: load_environment(tmp_path / "parts.exr"), "parts.exr", "more than one part")


def test_a_data_window_stands_where_it_should(write_image):
    window = {"x": 4, "y": 2, "full_width": 32, "full_height": 16}
    inner = load_environment(write_image("inner.exr", MAP[:8, :16], **window)).radiance
    expected = np.zeros_like(MAP)
    expected[2:10, 4:20] = MAP[:8, :16]
    np.testing.assert_array_equal(inner, expected)
    window = {"x": -2, "y": -1, "full_width": 28, "full_height": 14}
    outer = load_environment(write_image("outer.exr", MAP, **window)).radiance
    np.testing.assert_array_equal(outer, MAP[1:15, 2:30])


def test_negative_texels_become_zero_and_are_counted(write_image):
    low = MAP.copy()
    low[3, 4] = -1e-3, -5, 2
    loaded = load_environment(write_image("low.exr", low))
    assert loaded.negatives == 2 and loaded.radiance.min() >= 0
    np.testing.assert_array_equal(loaded.radiance, np.maximum(low, 0))


def test_a_sun_beyond_half_floats_survives(write_image):
    bright = MAP.copy()
    bright[5, 6] = 1e6
    assert load_environment(write_image("sun.exr", bright)).radiance.max() == 1e6


@pytest.mark.parametrize("size", [(3, 2), (3, 5)], ids=str)
def test_small_and_odd_maps_are_read(write_image, size):
    small = MAP[: size[0], : size[1]]
    np.testing.assert_array_equal(load_environment(write_image("s.exr", small)).radiance, small)


@pytest.mark.parametrize("height", [1, 2])
def test_fewer_than_three_rows_become_three_that_mean_the_same(write_image, height):
    few = MAP[:height, :5]
    loaded = load_environment(write_image("few.exr", few)).radiance
    np.testing.assert_array_equal(loaded, [few[0], few.mean(axis=0), few[-1]])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 2e15, 3.4e38])
def test_what_cannot_be_summed_is_refused_with_its_place(write_image, refused, value):
    bad = MAP.copy()
    bad[3, 4, 1] = value
    path = write_image("bad.exr", bad)
    refused(lambda: load_environment(path), "bad.exr", "environment", "row 3, column 4", "repair")


@pytest.mark.parametrize("ending", ["exr", "hdr"])
@pytest.mark.parametrize("kept", [0.0, 0.01, 0.5, 0.98])
def test_a_map_cut_short_is_refused(write_image, refused, tmp_path, ending, kept):
    whole = write_image(f"map.{ending}", MAP).read_bytes()
    path = tmp_path / f"cut.{ending}"
    path.write_bytes(whole[: int(len(whole) * kept)])
    refused(lambda: load_environment(path), f"cut.{ending}", "environment", "export it again")


@pytest.mark.parametrize("ending", ["exr", "hdr"])
def test_a_missing_or_broken_map_is_refused(refused, tmp_path, ending):
    path = tmp_path / f"map.{ending}"
    refused(lambda: load_environment(path), path.name, "environment", "name an existing")
    path.write_bytes(b"junk" * 100)
    refused(lambda: load_environment(path), path.name, "environment", "export it again")


@pytest.mark.parametrize(
    ("ending", "change", "told"),
    [
        ("exr", lambda whole: b"junk" * 100, "it is no .exr file"),
        ("hdr", lambda whole: b"junk" * 100, "it is no .hdr file"),
        ("exr", lambda whole: b"", "it is empty"),
        ("exr", lambda whole: whole[:4] + b"\2\2\0\0" + whole[8:], "its header is damaged"),
        ("exr", lambda whole: whole[:40], "its header is damaged"),
    ],
)
def test_what_cannot_be_opened_is_told_in_our_own_words(
    write_image, refused, tmp_path, ending, change, told
):
    path = tmp_path / f"bad.{ending}"
    path.write_bytes(change(write_image(f"map.{ending}", MAP).read_bytes()))
    refused(lambda: load_environment(path), f"cannot be read ({told}")


def test_other_formats_and_shapes_are_refused(write_image, refused, tmp_path):
    (tmp_path / "map.jpg").write_bytes(b"")
    refused(lambda: load_environment(tmp_path / "map.jpg"), "environment", "use .exr or .hdr")
    narrow = write_image("narrow.exr", MAP[:, :1])
    refused(lambda: load_environment(narrow), "narrow.exr", "environment", "at least 2x1")
    wide = write_image("wide.exr", np.zeros((1, LARGEST + 1, 3)))
    refused(lambda: load_environment(wide), "wide.exr", "environment", f"at most {LARGEST}")
    depth = write_image("depth.exr", MAP[..., :2], ("Z", "A"))
    refused(lambda: load_environment(depth), "depth.exr", "environment", "export it as RGB")
