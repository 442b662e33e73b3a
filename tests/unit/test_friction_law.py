"""The friction law, state by state: stuck, released, sliding, stuck again, released again."""

import math

import numpy as np
import pytest
import tolerances as tol
from reference.burridge_knopoff import Chain
from reference.lattice_state import elastic_stress, sliding, threshold_stress, total_stress
from scipy.optimize import brentq

import slippulse as sp
from slippulse.solver.fixed_step import LATTICES

GAMMA = 0.65
FINE = {"max_step": 0.05, "order": 8, "resolved_blocks": 1}
RELEASES = ("total", "elastic")


def under_stress(
    left: float, right: float, duration: float, dx: float, peak: float = 1.0, **values
) -> sp.Scene:
    return sp.Scene("stress", sp.Prestress(left, right, peak=peak), duration, dx, **values)


def with_leaf_springs(left: float, right: float, duration: float, dx: float, **values) -> sp.Scene:
    return sp.Scene("displacement", sp.Prestress(left, right), duration, dx, gamma=GAMMA, **values)


def lone_block(level: float = -3.0, duration: float = 5.0, **values) -> sp.Scene:
    """One block between neighbours that nothing can release: an oscillator that stops after half a period."""
    return with_leaf_springs(level, level, duration, 1.0, **FINE, **values)


SCENES = {
    "crack to pulses": with_leaf_springs(0.5, 0.5, 9.0, 0.05, beta=0.005, max_step=0.5),
    "undamped": with_leaf_springs(0.3, 0.7, 9.0, 0.05, max_step=0.5),
    "elastic release": with_leaf_springs(0.5, 0.4, 9.0, 0.05, beta=0.01, release="elastic"),
    "one-way": under_stress(-0.5, 0.0, 9.0, 0.05, beta=0.005, max_step=0.5),
    "one-way, undamped": under_stress(-0.5, 0.0, 9.0, 0.05),
    "one-way, elastic": under_stress(-0.5, 0.0, 9.0, 0.05, beta=0.01, release="elastic"),
    "blocks": under_stress(-0.5, 0.0, 16.0, 1.0, max_step=0.1, resolved_blocks=1),
    "fixed step": with_leaf_springs(0.5, 0.5, 9.0, 0.05, beta=0.005, scheme="fixed_step"),
    "fixed step, one-way": under_stress(-0.5, 0.0, 9.0, 0.05, beta=0.005, scheme="fixed_step", max_step=0.05),
}


@pytest.mark.parametrize("scheme", LATTICES)
def test_nothing_moves_just_below_the_threshold(scheme):
    peak = math.nextafter(1.0, 0.0)
    scene = under_stress(0.9, 0.9, 5.0, 0.1, peak, scheme=scheme, resolved_blocks=1)
    run = sp.simulate(scene, sp.Samples([0.0, 1.0, 5.0], [0.0, 0.5]))
    assert run.attrs["releases"] == 0
    assert run.attrs["stopped_because"] == "everything is stuck"
    assert not np.isfinite(run["release_time"].values).any()
    for name in ("slip", "slip_velocity", "slip_acceleration", "sample_slip", "sample_velocity"):
        assert not run[name].values.any(), name


@pytest.mark.parametrize("scheme", LATTICES)
def test_every_block_at_or_above_the_threshold_is_released_at_once_and_no_other(scheme):
    for peak, blocks in ((1.0, 1), (1.3, 17)):
        run = sp.simulate(under_stress(0.2, 0.5, 0.001, 0.1, peak, scheme=scheme))
        above = run["prestress"].values >= 1.0
        assert above.sum() == blocks
        assert np.array_equal(run["release_time"].values == 0.0, above)
        assert np.array_equal(run["slip_velocity"].values > 0.0, above)


@pytest.mark.parametrize("half", [True, False])
def test_a_second_nucleation_point_beyond_the_first_lattice_is_released_at_once(half):
    far = 80.0
    profile = sp.Prestress(0.1, 0.1, bumps=((far, 0.95, 1.0), (-far, 0.95, 1.0)))
    run = sp.simulate(sp.Scene("stress", profile, 0.01, 0.1, half_lattice=half))
    released = np.abs(run["x"].values[run["release_time"].values == 0.0])
    expected = 2 * np.count_nonzero(profile(np.arange(0.0, 2.0 * far, 0.1)[1:]) >= 1.0)
    assert np.count_nonzero(np.abs(released - far) < 1.0) == expected


@pytest.mark.parametrize("name", SCENES)
def test_states_along_a_run_and_at_its_end(name):
    """Never released: at rest; stuck: below the threshold; sliding: as the equation of motion says, forwards."""
    scene = SCENES[name]
    run = sp.simulate(scene, sp.Samples(np.linspace(0.0, 9.0, 181), np.linspace(-6.0, 6.0, 121)))
    assert run["sample_velocity"].values.min() >= (0.0 if scene.scheme == "fixed_step" else -tol.ROOT)
    never, moving = ~np.isfinite(run["release_time"].values), sliding(run)
    assert never.any() and moving.any() and not moving.all()
    for field in ("slip", "slip_velocity", "slip_acceleration"):
        assert not run[field].values[never].any()
    assert threshold_stress(run)[~moving].max() < 1.0 + tol.STRESS_AT_END
    if scene.scheme == "localised":
        difference = run["slip_acceleration"].values - np.where(moving, total_stress(run), 0.0)
        assert np.abs(difference).max() < tol.STRESS_AT_END
        assert (run["slip_velocity"].values[moving] >= 0.0).all()
        assert not run["slip_velocity"].values[~moving].any()


@pytest.mark.parametrize(
    "scene", [lone_block(0.0, 40.0, friction_ratio=0.0), lone_block(-0.6, 40.0)], ids=["three", "one"]
)
def test_the_lowest_stress_of_a_stuck_block_is_not_above_what_is_left_at_the_end(scene):
    run = sp.simulate(scene)
    lowest = elastic_stress(run)[~sliding(run)].min()
    assert run.attrs["min_stuck_stress"] <= lowest + tol.STRESS_AT_END
    if lowest <= scene.reverse_threshold:
        assert "reverse_sliding" in run.attrs["run_flags"]


@pytest.mark.parametrize("release", RELEASES)
@pytest.mark.parametrize("beta", [0.0, 0.4])
def test_a_neighbour_is_released_when_its_own_stress_reaches_one(release, beta):
    """While one block slides alone it is an oscillator in closed form, and so is the stress of its neighbour."""
    scene = lone_block(0.3, 1.2, beta=beta, release=release)
    root = np.roots([1.0, 2.0 * beta, 2.0 + GAMMA])[0]
    decay, frequency = root.real, abs(root.imag)

    def margin(time: float) -> float:
        wave = math.exp(decay * time)
        cosine, sine = math.cos(frequency * time), math.sin(frequency * time) / frequency
        slip = (1.0 - wave * (cosine - decay * sine)) / (2.0 + GAMMA)
        drag = beta * wave * sine if release == "total" else 0.0
        return slip + drag + float(scene.prestress(1.0)) - 1.0

    left, right = sp.simulate(scene)["release_time"].sel(x=[-1.0, 1.0]).values
    assert right == pytest.approx(brentq(margin, 1e-6, 1.2, xtol=1e-14), abs=tol.OSCILLATOR)
    assert left == right


def test_without_damping_the_release_rules_are_one():
    one, two = (sp.simulate(under_stress(-0.5, 0.0, 6.0, 0.1, release=release)) for release in RELEASES)
    assert one.equals(two)


def test_a_block_sticks_when_its_velocity_returns_to_zero_and_keeps_its_slip():
    frequency, times = math.sqrt(2.0 + GAMMA), np.linspace(0.0, 5.0, 101)
    run = sp.simulate(lone_block(), sp.Samples(times, [0.0]))
    block, stick = run.sel(x=0.0), math.pi / frequency
    assert float(block["stick_time"]) == pytest.approx(stick, abs=tol.OSCILLATOR)
    assert float(block["slip"]) == pytest.approx(2.0 / frequency**2, abs=tol.OSCILLATOR)
    assert float(block["slip_velocity"]) == 0.0
    assert run.attrs["stopped_because"] == "everything is stuck"
    slip, velocity = run["sample_slip"].values[:, 0], run["sample_velocity"].values[:, 0]
    moving = times < stick
    assert np.abs(slip - (1.0 - np.cos(frequency * times)) / frequency**2)[moving].max() < tol.OSCILLATOR
    assert np.abs(velocity - np.sin(frequency * times) / frequency)[moving].max() < tol.OSCILLATOR
    assert (slip[~moving] == float(block["slip"])).all()
    assert not velocity[~moving].any()


def test_a_block_released_again_is_counted_and_slides_on():
    scene = under_stress(-0.5, 0.0, 16.0, 1.0, **FINE)
    run = sp.simulate(scene)
    chain = Chain(scene.prestress(np.arange(-40.0, 41.0)), 0.0, 0.0, "total").run(scene.duration)
    distinct = int(np.isfinite(run["release_time"].values).sum())
    assert run.attrs["re_releases"] > 0
    assert run.attrs["re_releases"] == run.attrs["releases"] - distinct
    assert (run.attrs["releases"], run.attrs["sticks"]) == (chain.releases, chain.sticks)
    assert run.attrs["releases"] - run.attrs["sticks"] == int(sliding(run).sum())
