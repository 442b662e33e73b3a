"""The layer in the plane beside one dimension: what holds, what does not, and what converges."""

import numpy as np
import pytest

QUANTITIES = ["speed", "pulse_width", "pulse_slip", "first_stick"]
KEYS = ["gamma", "tau0"]


@pytest.fixture
def runs(study):
    """Rows at the last station, without the drawn field."""
    table = study("layer").query("part != 'field'")
    return table[table["station"] == table["station"].max()]


def finest(runs, part="pulse"):
    """Rows of one part on its finest grid."""
    rows = runs[runs["part"] == part]
    return rows[rows["cells"] == rows["cells"].max()].set_index(KEYS).sort_index()


def test_a_held_displacement_makes_pulses_that_stick_and_settle(study, runs):
    pulses = study("layer").query("part == 'pulse'").query("cells == cells.max()")
    assert len(pulses) == 12 and (finest(runs)["energy_residual"] < 1e-10).all()
    assert pulses["pulse_width"].between(0.0, np.inf, inclusive="neither").all()
    for _, rows in pulses.sort_values("station").groupby(KEYS):
        assert rows[["speed", "pulse_slip"]].pct_change().iloc[-1].abs().max() < 0.02


def test_a_held_stress_makes_cracks_and_a_barrier_stops_one_side(study, runs):
    assert not np.isfinite(finest(runs, "crack")["first_stick"]).any()
    stops = runs.query("part == 'barrier' and side < 0")
    assert len(stops) == 6 and (stops["end"] > -stops["balance_distance"]).all()
    assert (stops["end"] < -0.75 * stops["balance_distance"]).all()
    # Less fracture energy, a longer way.
    assert stops.groupby("weakening")["end"].mean().is_monotonic_increasing


def test_the_first_stick_is_that_of_a_shear_wave_and_not_of_a_linear_profile(runs):
    pulses = finest(runs)
    assert (pulses["first_stick"] / pulses["strip_first_stick"]).between(0.98, 1.0).all()
    paper = (pulses["paper_first_stick"] / pulses["strip_first_stick"]).to_numpy()
    assert paper == pytest.approx(np.pi / np.sqrt(8.0))
    # Formulas of one dimension come no closer as pulses become wide.
    thick, thin = (pulses.loc[end] for end in (pulses.index[-1][0], pulses.index[0][0]))
    assert (thin["pulse_width"] > 1.5 * thick["pulse_width"]).all()
    assert thin["pulse_width"].max() > 7.0
    for rows in (thick, thin):
        for quantity, least in {"speed": 1.2, "pulse_width": 1.4, "pulse_slip": 1.15}.items():
            assert (rows[f"paper_{quantity}"] / rows[quantity] > least).all()
        assert (rows["damped_pulse_width"] / rows["pulse_width"] < 0.6).all()
    # The waves that stay behind have energy, and nothing outruns the compressional wave.
    assert (pulses["pulse_slip"] < pulses["balance_pulse_slip"]).all()
    assert (pulses["speed"] < 1.0).all()


def test_pulses_converge_with_the_grid(runs):
    pulses = runs[runs["part"] == "pulse"].pivot(index=KEYS, columns="cells", values=QUANTITIES)
    for quantity, most in zip(QUANTITIES, (0.04, 0.06, 0.05, 0.02), strict=True):
        coarse, middle, fine = (pulses[quantity][cells] for cells in (10, 20, 40))
        assert (fine / middle - 1.0).abs().max() < most
        if quantity != "first_stick":
            assert (fine - middle).abs().median() < (middle - coarse).abs().median()
    closest = runs[runs["part"] == "fine"].sort_values("cells")[["speed", "pulse_slip"]]
    assert closest.pct_change().iloc[-1].abs().max() < 5e-3
    assert closest.iloc[-1].to_list() == pytest.approx([0.9865, 1.8835], rel=5e-3)


def test_a_strength_that_follows_the_normal_stress_makes_the_sides_differ(study):
    coupled = study("layer").query("part == 'coupled'").query("cells == cells.max()")
    slips = coupled.pivot(index=["coupling", "side"], columns="station", values="pulse_slip")
    change = (slips.iloc[:, -1] / slips.iloc[:, -2] - 1.0).abs()
    assert change[0.3, 1.0] < 0.01 and change[0.3, -1.0] > 0.05
    assert change[0.6, 1.0] > 0.05 and change[0.6, -1.0] > 0.05
