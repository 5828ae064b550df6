"""The optical constants: what the file says, what the spectra say, and what is published."""

import numpy as np
import pytest

from scenes.optics import HERE, derive, load_constants, spectrum_to_rgb, substances

# Akenine-Möller, Haines, Hoffman 2018, Real-Time Rendering, 4th ed., table 9.2, linear sRGB.
PUBLISHED_F0 = {
    "Au": (1.00, 0.78, 0.34),
    "Ag": (0.97, 0.96, 0.92),
    "Cu": (0.95, 0.64, 0.54),
    "Al": (0.91, 0.92, 0.92),
}
# Measured samples differ, and F0 of RGB eta, k is not RGB F0: at most .057 (blue of silver).
PUBLISHED_TOLERANCE = 0.06


def test_every_spectrum_has_constants_and_no_others_exist():
    assert sorted(load_constants()) == substances()


@pytest.mark.parametrize("name", substances())
def test_constants_are_what_the_spectrum_gives(name):
    stored, derived = load_constants()[name], derive(name)
    for key in ("eta", "k", "f0"):
        assert stored[key] == pytest.approx(derived[key], rel=1e-5, abs=0)
    assert (stored["metal"], stored["source"]) == (derived["metal"], derived["source"])


@pytest.mark.parametrize("name", substances())
def test_f0_is_fresnel_of_the_stored_eta_and_k(name):
    entry = load_constants()[name]
    index = np.array(entry["eta"]) + 1j * np.array(entry["k"])
    f0 = np.abs((index - 1) / (index + 1)) ** 2
    assert entry["f0"] == pytest.approx(f0.tolist(), rel=1e-5)
    assert min(entry["eta"]) > 0 and min(entry["k"]) >= 0 and max(entry["f0"]) < 1


@pytest.mark.parametrize("constant", [0.0, 1.0, 1.519])
def test_a_constant_spectrum_maps_to_that_constant(constant):
    rgb = spectrum_to_rgb([360, 830], [constant, constant])
    assert rgb == pytest.approx([constant] * 3, rel=1e-12)


def test_a_band_of_long_middle_or_short_waves_is_mostly_red_green_or_blue():
    nm = np.arange(360, 831, 5)
    bands = [(600, 700), (510, 560), (420, 480)]
    for channel, (low, high) in enumerate(bands):
        assert np.argmax(spectrum_to_rgb(nm, (nm >= low) & (nm <= high))) == channel


def test_observer_has_the_published_sum_and_sees_equal_energy_as_neutral():
    observer = np.loadtxt(HERE / "cie1931.csv", delimiter=",", comments=["#", "wavelength_nm"])
    assert observer[:, 0].tolist() == list(range(360, 831, 5))
    total = observer[:, 1:].sum(axis=0)
    # 106.857 lm nm: Wyszecki and Stiles 1982, Color Science, at 5 nm; x, y, z = 1/3 within
    # 1e-4 (tabulated digits).
    assert 5 * total[1] == pytest.approx(106.857, abs=5e-4)
    assert total / total.sum() == pytest.approx([1 / 3] * 3, abs=1e-4)


@pytest.mark.parametrize("name", PUBLISHED_F0)
def test_f0_of_well_known_metals_is_near_the_published_value(name):
    assert load_constants()[name]["f0"] == pytest.approx(
        PUBLISHED_F0[name], abs=PUBLISHED_TOLERANCE
    )


def test_a_spectrum_out_of_order_is_refused():
    with pytest.raises(ValueError, match="increasing wavelengths"):
        spectrum_to_rgb([500, 400], [1, 1])
