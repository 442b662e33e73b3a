"""The friction law: blocks that are released at once and that never move.

Every block is compared in test_burridge_knopoff.py.
"""

import math

import numpy as np
import pytest
import tolerances as tol
from reference.lattice_state import elastic_stress, sliding

import slippulse as sp
from slippulse.solver.fixed_step import LATTICES


@pytest.mark.parametrize("scheme", LATTICES)
def test_every_block_at_or_above_the_threshold_is_released_at_once_and_none_below(scheme):
    profile = sp.Prestress(0.9, 0.9, peak=math.nextafter(1.0, 0.0))
    scene = sp.Scene("stress", profile, 5.0, 0.1, scheme=scheme, resolved_blocks=1)
    run = sp.simulate(scene, sp.Samples([0.0, 1.0, 5.0], [0.0, 0.5]))
    assert (run.attrs["releases"], run.attrs["stopped_because"]) == (0, "everything is stuck")
    assert not np.isfinite(run["release_time"].values).any()
    for name in ("slip", "slip_velocity", "slip_acceleration", "sample_slip", "sample_velocity"):
        assert not run[name].values.any(), name
    for peak, blocks in ((1.0, 1), (1.3, 17)):
        profile = sp.Prestress(0.2, 0.5, peak=peak)
        run = sp.simulate(sp.Scene("stress", profile, 0.001, 0.1, scheme=scheme))
        above = run["prestress"].values >= 1.0
        assert above.sum() == blocks
        assert np.array_equal(run["release_time"].values == 0.0, above)
        assert np.array_equal(run["slip_velocity"].values > 0.0, above)


@pytest.mark.parametrize("half", [True, False])
def test_a_second_nucleation_point_beyond_the_first_lattice_is_released_at_once(half):
    centre, profile = 80.0, sp.Prestress(0.1, 0.1, bumps=((80.0, 0.95, 1.0), (-80.0, 0.95, 1.0)))
    run = sp.simulate(sp.Scene("stress", profile, 0.01, 0.1, half_lattice=half))
    released = np.abs(run["x"].values[run["release_time"].values == 0.0])
    expected = 2 * np.count_nonzero(profile(np.arange(0.0, 2.0 * centre, 0.1)[1:]) >= 1.0)
    assert np.count_nonzero(np.abs(released - centre) < 1.0) == expected


@pytest.mark.parametrize(("level", "ratio"), [(0.0, 0.0), (-0.6, 5.0)], ids=["three", "one"])
def test_the_lowest_stress_of_a_stuck_block_is_not_above_what_is_left_at_the_end(level, ratio):
    values = {"gamma": 0.65, "max_step": 0.05, "order": 8, "resolved_blocks": 1}
    profile = sp.Prestress(level, level)
    scene = sp.Scene("displacement", profile, 40.0, 1.0, friction_ratio=ratio, **values)
    run = sp.simulate(scene)
    lowest = elastic_stress(run)[~sliding(run)].min()
    assert run.attrs["min_stuck_stress"] <= lowest + tol.STRESS_AT_END
    if lowest <= scene.reverse_threshold:
        assert "reverse_sliding" in run.attrs["run_flags"]
