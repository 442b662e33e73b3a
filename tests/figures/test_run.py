"""A run as a picture, in one call."""

import matplotlib
import numpy as np
import pytest

import slippulse as sp

PLAIN = sp.Scene(
    boundary="displacement", prestress=sp.Prestress(0.5, 0.4), gamma=0.65, duration=8.0, dx=0.05, scheme="continuum"
)  # fmt: skip
SAMPLES = sp.Samples(np.linspace(0.0, 8.0, 41), np.linspace(-12.0, 12.0, 81))


@pytest.mark.parametrize("samples", [None, SAMPLES], ids=["edges", "map"])
def test_fronts_trailing_edge_and_slip_are_drawn(samples):
    run = sp.simulate(PLAIN, samples)
    before = matplotlib.rcParams["font.size"]
    figure = sp.plot(run)
    assert matplotlib.rcParams["font.size"] == before
    _, times, slip = figure.axes[:3]
    lines = {line.get_label(): line for line in times.lines}
    released = np.isfinite(run["release_time"].values)
    assert lines["front"].get_xdata() == pytest.approx(run["release_time"].values[released], abs=0.1)
    stick = run.attrs["first_stick_time"]
    assert np.nanmin(lines["trailing edge"].get_xdata()) == pytest.approx(stick, abs=0.01)
    assert np.max(slip.lines[0].get_xdata()) == pytest.approx(float(run["slip"].max()))
    assert bool(times.images) is (samples is not None)
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_what_is_no_run_is_refused():
    with pytest.raises(TypeError, match=r"^run: dict; allowed: a Dataset that simulate returned$"):
        sp.plot({})
    with pytest.raises(TypeError, match=r"^run: Dataset; allowed: a Dataset that simulate returned$"):
        sp.plot(sp.run_sweep([PLAIN]))


@pytest.mark.parametrize("boundary", ["displacement", "stress"])
@pytest.mark.parametrize("scheme", ["localised", "continuum"])
@pytest.mark.parametrize(("peak", "times", "positions"), [(1.0, 0, 0), (0.9, 1, 9), (1.0, 5, 1)])
def test_every_run_is_drawn(boundary, scheme, peak, times, positions):
    gamma = 0.65 * (boundary == "displacement")
    scene = sp.Scene(boundary, sp.Prestress(-0.5, 0.0, peak=peak), 4.0, 0.1, gamma=gamma, scheme=scheme)
    samples = sp.Samples(np.linspace(0.0, 4.0, times), np.linspace(-3.0, 3.0, positions))
    assert sp.plot(sp.simulate(scene, samples))._repr_png_().startswith(b"\x89PNG")


def test_a_scene_shows_its_parameters():
    html = PLAIN._repr_html_()
    for name, value in PLAIN.attributes().items():
        assert f"<th>{name}</th>" in html and (isinstance(value, str) or f"<td>{value}</td>" in html)
