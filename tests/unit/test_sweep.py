"""Many scenes in one Dataset: the order, the threads and the way back."""

from __future__ import annotations

import numpy as np
import pytest

import slippulse as sp
from slippulse.data.points import point
from slippulse.data.store import save_dataset
from slippulse.data.variables import FIELDS, FRONTS
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
        assert again.attrs.keys() == alone.attrs.keys()
        for name, value in alone.attrs.items():
            assert again.attrs[name] == value or (
                value != value and again.attrs[name] != again.attrs[name]
            ), name
            assert type(again.attrs[name]) is type(value), name


@pytest.mark.parametrize(
    ("record", "names"),
    [
        (("fronts",), {"x", "prestress", *FRONTS}),
        (("fields",), {"x", "prestress", *FIELDS}),
        (("samples",), {"sample_time", "sample_position", "sample_slip", "sample_velocity"}),
    ],
)
def test_only_what_is_asked_for_is_kept(record, names):
    run = point(sweep(record=record), 1)
    assert set(run.variables) == names
    whole = sp.simulate(SCENES[1], SAMPLES[1])
    for name in names:
        assert np.array_equal(run[name].values, whole[name].values, equal_nan=True)


def test_progress_counts_every_scene():
    seen = []
    run_sweep(SCENES, None, ("fronts",), 2, lambda done, total: seen.append((done, total)))
    assert seen == [(done, len(SCENES)) for done in range(1, len(SCENES) + 1)]


def test_a_scene_that_fails_ends_the_sweep_with_its_reason():
    broken = sp.Scene(
        "stress", sp.Prestress(0.2, 0.3), 200.0, 0.1, beta=0.1, scheme="fixed_step", max_step=0.01
    )
    object.__setattr__(broken, "max_step", 3.0)
    with pytest.raises(sp.UnstableRun, match="unstable"):
        run_sweep([*SCENES, broken], None, ("fronts",), 2)
