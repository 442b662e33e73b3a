"""What a scene refuses, and what it derives."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import slippulse as sp
from slippulse.data.points import point
from slippulse.data.store import load_dataset, load_table, save_dataset, save_table
from slippulse.predict.measured import measured_table

STRESS = {"boundary": "stress", "prestress": sp.Prestress(-0.5, 0.0), "duration": 5.0, "dx": 0.01}
DISPLACEMENT = STRESS | {
    "boundary": "displacement",
    "gamma": 0.65,
    "beta": 1e-3,
    "prestress": sp.Prestress(0.5, 0.5),
}


def test_derived_numbers():
    scene = sp.Scene(**DISPLACEMENT, friction_ratio=2.0)
    assert scene.damping_ratio == pytest.approx(0.1)
    assert scene.reverse_threshold == -5.0
    assert scene.symmetric
    assert not dataclasses.replace(scene, half_lattice=False).symmetric
    assert not sp.Scene(**STRESS).symmetric


UNEVEN = sp.Prestress(0.25, 0.6, 2.0, 1.05, steps=((4.0, 0.4),), bumps=((-3.0, -0.3, 0.5),))
OTHERS = {
    "displacement": sp.Scene(
        **DISPLACEMENT | {"prestress": UNEVEN, "duration": 0.1}, release="elastic", half_lattice=False, order=5,
        max_step=0.25, friction_ratio=2.0, resolved_blocks=3,
    ),
    "stress": sp.Scene(**STRESS | {"duration": 0.1}, scheme="fixed_step", max_step=0.3),
}  # fmt: skip


@pytest.mark.parametrize("boundary", OTHERS)
def test_a_scene_comes_back_from_its_attributes_its_data_and_its_measured_row(boundary, config, tmp_path):
    scene = OTHERS[boundary]
    assert sp.Scene.from_attributes(scene.attributes()) == scene
    save_dataset(sp.run_sweep([scene], record=("fronts",)), tmp_path / "data.nc")
    data = load_dataset(tmp_path / "data.nc")
    assert sp.Scene.from_attributes(point(data, 0).attrs) == scene
    save_table(measured_table(data, config["measure"]), tmp_path / "measured.csv")
    (row,) = load_table(tmp_path / "measured.csv").to_dict("records")
    assert sp.Scene.from_attributes(row) == scene


def test_attributes_without_a_parameter_are_refused_by_its_name():
    attributes = sp.Scene(**STRESS).attributes()
    del attributes["steps_and_bumps"]
    with pytest.raises(ValueError, match="steps_and_bumps: missing; allowed: every attribute of a run"):
        sp.Scene.from_attributes(attributes)


@pytest.mark.parametrize("kind", [np.float32, int])
def test_parameters_are_computed_with_in_double_precision(kind):
    """Whatever their type: a float32 spacing squared in float32 would change the answer in the seventh digit."""
    values = {"duration": kind(7), "dx": kind(1), "gamma": kind(1), "beta": kind(0)}
    scene = sp.Scene("displacement", **values, prestress=sp.Prestress(kind(0), kind(0), kind(2), kind(1)))
    for name in ("duration", "dx", "gamma", "beta", "max_step", "friction_ratio"):
        assert type(getattr(scene, name)) is float
    for name in ("left", "right", "width", "peak"):
        assert type(getattr(scene.prestress, name)) is float
