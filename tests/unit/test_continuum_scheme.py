"""The exact solution as a scheme: the same Dataset as a lattice run, which tends to it at first order in dx."""

import numpy as np
import pytest

import slippulse as sp

LATTICE = {"order": 8, "max_step": 1.0}
HELD = {"boundary": "displacement", "gamma": 0.65}
SCENES = {
    "displacement": HELD | {"prestress": sp.Prestress(0.5, 0.5), "duration": 9.0},
    "asymmetric": HELD | {"prestress": sp.Prestress(-0.5, 0.5), "duration": 8.0},
    "stress": {"boundary": "stress", "prestress": sp.Prestress(-0.75, 0.0, 2.0), "duration": 9.0},
}


def run(name: str, dx: float, ratio: float = 0.1, **more):
    return sp.simulate(sp.Scene(dx=dx, beta=ratio * dx, **SCENES[name], **more))


@pytest.mark.parametrize("name", SCENES)
def test_the_lattice_tends_to_it_at_first_order(name):
    """Release times at positions that every spacing has, away from the nucleation and from where a front stops."""
    errors = []
    for dx in (0.08, 0.04):
        x = np.arange(1.6, 6.0, 0.8)
        runs = run(name, dx, **LATTICE), run(name, dx, scheme="continuum")
        lattice, exact = (np.interp(x, found.x, found.release_time) for found in runs)
        errors.append(np.max(np.abs(lattice - exact)))
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.35) and errors[1] < 0.1


def test_it_is_the_same_dataset():
    samples = sp.Samples(times=np.linspace(0.0, 8.0, 5), positions=np.linspace(-4.0, 4.0, 9))
    scene = {"dx": 0.1, "beta": 0.01, **SCENES["displacement"]}
    lattice = sp.simulate(sp.Scene(**scene), samples)
    exact = sp.simulate(sp.Scene(scheme="continuum", **scene), samples)
    assert set(exact.variables) == set(lattice.variables)
    for name in exact.variables:
        assert exact[name].dims == lattice[name].dims and exact[name].attrs == lattice[name].attrs
    missing = set(lattice.attrs) - set(exact.attrs)
    assert missing <= {name for name in lattice.attrs if name.endswith(("energy", "loss", "of_prestress"))}
    assert exact.attrs["scheme"] == "continuum" and exact.attrs["run_flags"] == ""
    assert np.abs(exact.sample_slip - lattice.sample_slip).max() < 0.1 * lattice.sample_slip.max()


def test_where_the_construction_ends_is_flagged_and_nothing_is_told_beyond():
    """A second nucleation whose waves hold a position that is about to stick."""
    scene = HELD | {"prestress": sp.Prestress(0.25, 0.25, bumps=((7.0, 0.75, 0.5),)), "duration": 16.0}
    found = sp.simulate(sp.Scene(dx=0.1, beta=0.01, scheme="continuum", **scene))
    assert found.attrs["run_flags"] == "construction_ended" and found.attrs["limit_reason"]
    assert found.attrs["limit_time"] <= found.attrs["duration"]
    assert np.isnan(found.slip.values).any()


def test_a_sweep_may_be_exact():
    scenes = [sp.Scene(dx=0.1, beta=0.0, scheme="continuum", **SCENES["displacement"])] * 2
    sweep = sp.run_sweep(scenes, record=("fronts", "fields"))
    assert sweep.sizes["point"] == 2 and np.isfinite(sweep["first_stick_time"]).all()


def test_a_scene_that_releases_nothing_is_an_empty_run():
    scene = {"dx": 0.1, "beta": 0.01, **SCENES["displacement"], "prestress": sp.Prestress(0.5, 0.5, peak=0.9)}
    samples = sp.Samples([0.0, 1.0], [0.0, 1.0])
    lattice, exact = (sp.simulate(sp.Scene(scheme=s, **scene), samples) for s in ("localised", "continuum"))
    assert exact.equals(lattice) and lattice.attrs["run_flags"] == "nothing_released"
    for name in ("releases", "sticks", "stopped_because", "run_flags", "pulse_blocks"):
        assert exact.attrs[name] == lattice.attrs[name]
    assert np.isnan(exact.attrs["first_stick_time"]) and exact.attrs["end_time"] == scene["duration"]
