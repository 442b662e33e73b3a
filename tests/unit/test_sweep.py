"""What a run records on its way, and many scenes in one Dataset: the order, the threads and the way back."""

import dataclasses

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.data.points import point
from slippulse.data.store import save_dataset
from slippulse.data.sweeps import FIELDS, FRONTS
from slippulse.simulation.simulate import run_sweep

RECORDS = ("fronts", "fields", "samples")
SCENES = [
    sp.Scene("displacement", sp.Prestress(tau, 0.5), duration, dx, gamma=0.65, beta=0.1 * dx)
    for tau, duration, dx in ((0.3, 2.0, 0.05), (0.5, 6.0, 0.02), (0.7, 1.0, 0.1), (-0.2, 4.0, 0.05))
] + [
    sp.Scene("stress", sp.Prestress(-0.5, 0.0), 4.0, 0.05),
    sp.Scene("stress", sp.Prestress(0.5, 0.5, peak=0.9), 4.0, 0.05),
]
SAMPLES = [sp.Samples(np.linspace(0.0, scene.duration, 7), np.linspace(-1.0, 1.0, 5)) for scene in SCENES]


def sweep(threads: int = 1, record=RECORDS):
    return run_sweep(SCENES, SAMPLES, record, threads)


def test_the_number_of_threads_does_not_change_a_bit(tmp_path):
    for threads in (1, 2, 5):
        save_dataset(sweep(threads), tmp_path / f"{threads}.nc")
    alone = (tmp_path / "1.nc").read_bytes()
    assert alone == (tmp_path / "2.nc").read_bytes() == (tmp_path / "5.nc").read_bytes()


def test_a_point_is_what_the_scene_alone_gives():
    together = sweep(2)
    for index, (scene, samples) in enumerate(zip(SCENES, SAMPLES, strict=True)):
        alone, again = sp.simulate(scene, samples), point(together, index)
        assert again.equals(alone)
        np.testing.assert_equal(again.attrs, alone.attrs)
        for name, value in alone.attrs.items():
            assert type(again.attrs[name]) is type(value), name


@pytest.mark.parametrize(
    ("record", "names"),
    [
        ("fronts", {"x", "prestress", *FRONTS}),
        ("fields", {"x", "prestress", *FIELDS}),
        ("samples", {"sample_time", "sample_position", "sample_slip", "sample_velocity"}),
    ],
)
def test_only_what_is_asked_for_is_kept(record, names):
    run = point(sweep(record=(record,)), 1)
    assert set(run.variables) == names
    whole = sp.simulate(SCENES[1], SAMPLES[1])
    for name in names:
        assert np.array_equal(run[name].values, whole[name].values, equal_nan=True)


def test_progress_counts_every_scene():
    seen = []
    run_sweep(SCENES, None, ("fronts",), 2, lambda done, total: seen.append((done, total)))
    assert seen == [(done, len(SCENES)) for done in range(1, len(SCENES) + 1)]


def test_a_scene_that_fails_ends_the_sweep_with_its_reason():
    profile = sp.Prestress(0.2, 0.3)
    broken = sp.Scene("stress", profile, 200.0, 0.1, beta=0.1, scheme="fixed_step", max_step=0.01)
    object.__setattr__(broken, "max_step", 3.0)
    with pytest.raises(sp.UnstableRun, match="unstable"):
        run_sweep([*SCENES, broken], None, ("fronts",), 2)


ONE = sp.Scene("displacement", sp.Prestress(0.4, 0.6), 6.0, 0.05, gamma=0.65, beta=0.005, max_step=0.4)


def test_samples_that_are_none_are_refused():
    for times, positions, said in (
        ([0.0, 2.0, 1.0], [0.0], r"samples\.times"), ([-0.1, 1.0], [0.0], r"samples\.times"),
        ([0.0, np.nan], [0.0], r"samples\.times"), ([[0.0, 1.0]], [0.0], "samples: times and positions"),
        ([0.0, 1.0], 0.0, "samples: times and positions"), ([0.0, 1.0], [np.inf], r"samples\.positions"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=said):
            sp.Samples(times, positions)


@pytest.mark.parametrize("scheme", ["localised", "continuum"])
def test_samples_after_the_end_are_refused(scheme):
    scene = dataclasses.replace(ONE, duration=1.0, scheme=scheme)
    samples = sp.Samples([0.5, 1.0, 3.5], [0.0])
    refusal = r"^samples\.times: 3\.5; allowed: up to the duration of the scene, 1$"
    with pytest.raises(ValueError, match=refusal):
        sp.simulate(scene, samples)
    with pytest.raises(ValueError, match=refusal):
        sp.run_sweep([scene], [samples])


def test_a_sample_is_the_state_of_a_run_that_ends_there():
    """At rest where no block is near."""
    times = np.array([0.0, 0.777, 2.5, 5.9])
    positions = np.array([-900.0, -3.0, -0.52, 0.0, 0.07, 2.0, 900.0])
    run = sp.simulate(ONE, sp.Samples(times, positions))
    for s, time in enumerate(times[1:], start=1):
        end = sp.simulate(dataclasses.replace(ONE, duration=float(time)))
        blocks = end.sel(x=positions, method="nearest")
        near = np.abs(blocks["x"].values - positions) < ONE.dx
        for sampled, name in (("sample_slip", "slip"), ("sample_velocity", "slip_velocity")):
            expected = np.where(near, blocks[name].values, 0.0)
            assert run[sampled].values[s] == pytest.approx(expected, abs=tol.SAMPLE), (time, name)
    assert not run["sample_slip"].values[0].any()
    assert not run["sample_slip"].values[:, [0, -1]].any()


@pytest.mark.parametrize("scheme", ["localised", "fixed_step"])
def test_samples_do_not_change_the_run(scheme):
    scene = dataclasses.replace(ONE, scheme=scheme)
    plain = sp.simulate(scene)
    sampled = sp.simulate(scene, sp.Samples(np.linspace(0.0, 6.0, 301), np.linspace(-5.0, 5.0, 51)))
    assert sampled[list(plain.data_vars)].equals(plain)


def test_mirrored_positions_have_mirrored_samples():
    scene = dataclasses.replace(ONE, prestress=sp.Prestress(0.5, 0.5))
    positions = np.array([-1.0251, -0.075, -0.025, 0.025, 0.075, 1.0251])
    slip = sp.simulate(scene, sp.Samples(np.linspace(0.0, 6.0, 13), positions))["sample_slip"].values
    assert np.array_equal(slip, slip[:, ::-1])


def test_the_time_after_everything_stuck_is_the_final_state():
    scene = sp.Scene("stress", sp.Prestress(-2.0, -2.0), 20.0, 0.1, beta=0.01)
    run = sp.simulate(scene, sp.Samples([19.0, 20.0], [0.0]))
    assert run.attrs["stopped_because"] == "everything is stuck"
    assert (run["sample_slip"].values == float(run["slip"].sel(x=0.0))).all()
