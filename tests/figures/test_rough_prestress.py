"""Pulses on a rough pre-stress: statistics against known answers, theory, and the ensembles."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from selection import small_sweep

import slippulse as sp
from slippulse.data.points import Recorded
from slippulse.simulation.simulate import run_sweep
from slippulse.theory.barrier import barrier_depth
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.profiles import ExpandedProfiles
from slippulse_paper.studies import rough_checks, rough_prestress
from slippulse_paper.studies import rough_theory as theory
from slippulse_paper.studies.rough_prestress import CELL_MIDDLES, START, end_state
from slippulse_paper.studies.survival_statistics import (
    Fate,
    death_rate,
    fraction_interval,
    poisson_interval,
    survival,
    survival_exponent,
)

KEYS = {"level": 0.4, "deviation": 0.1, "correlation_length": 2.0, "hurst": 0.5, "spacing": 0.1}
KEYS |= {"gamma": 0.65, "damping_ratio": 0.1}


def test_kaplan_meier_of_a_case_by_hand():
    """Deaths at 1 and 3 of four pulses, one of them censored at 2: 3/4, then 3/4 times 1/2."""
    fates = [Fate(1.0, True), Fate(2.0, False), Fate(3.0, True), Fate(4.0, False)]
    curve = survival(fates).set_index("distance")
    assert curve["survival"].to_dict() == {0.0: 1.0, 1.0: 0.75, 2.0: 0.75, 3.0: 0.375, 4.0: 0.375}
    # The log-log band of Greenwood's variance, 1/12 after the first death.
    spread = 1.959964 * math.sqrt(1.0 / 12.0) / abs(math.log(0.75))
    ends = 0.75 ** math.exp(spread), 0.75 ** math.exp(-spread)
    assert tuple(curve.loc[1.0, ["low", "high"]]) == pytest.approx(ends, rel=1e-6)


def test_the_band_of_a_fraction_contains_the_fraction():
    """At the end no pulse is alive."""
    curve = survival([Fate(1.0, True), Fate(2.0, True), Fate(3.0, True)])
    assert curve["survival"].iloc[-1] == 0.0
    assert (curve["low"] <= curve["survival"]).all() and (curve["survival"] <= curve["high"]).all()


def test_rates_and_intervals_of_known_cases():
    rate = death_rate([Fate(3.0, True), Fate(15.0, True), Fate(25.0, False)], start=5.0)
    assert rate["rate"] == pytest.approx(1.0 / 30.0) and rate["deaths"] == 1
    rate = death_rate([Fate(3.0, True)], start=5.0)
    assert math.isnan(rate["rate"]) and math.isnan(rate["rate_high"]) and rate["deaths"] == 0
    # The rule of three, and tabulated exact intervals.
    assert poisson_interval(0) == pytest.approx((0.0, -math.log(0.025)))
    assert poisson_interval(10) == pytest.approx((4.7954, 18.3904), abs=1e-4)
    assert fraction_interval(5, 10) == pytest.approx((0.1871, 0.8129), abs=1e-4)
    assert fraction_interval(0, 0) == (0.0, 1.0)


def test_the_exponent_of_a_power_law_with_censored_runs_is_found():
    uniform = np.random.Generator(np.random.PCG64(1)).random(4000)
    distances = 2.0 * uniform**-2.0
    fates = [Fate(min(one, 100.0), one < 100.0) for one in distances]
    found = survival_exponent(fates, 4.0)
    assert found["exponent_low"] < 0.5 < found["exponent_high"]
    assert found["exponent"] == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize(("hurst", "factor"), [(0.5, 2.0), (1.0, math.pi)])
def test_the_diffusivity_is_that_of_fields(hurst, factor):
    """2 sigma^2 l for exponential correlation, pi sigma^2 l for a Hurst exponent of 1."""
    keys = KEYS | {"hurst": hurst}
    assert theory.diffusivity(keys) == pytest.approx(factor * 0.02)
    arguments = {name: keys[name] for name in ("level", "deviation", "correlation_length", "hurst")}
    sums = [
        np.mean(sp.rough(**arguments, start=0.0, stop=400.0, spacing=0.5, seed=seed).tau - 0.4)
        for seed in range(300)
    ]
    assert 400.0 * np.var(sums) == pytest.approx(theory.diffusivity(keys), rel=0.25)


def test_the_rate_of_barriers_is_that_counted_in_fields():
    """Downcrossings of the mean over the critical depth, in simulated fields."""
    keys = KEYS | {"deviation": 0.35}
    predicted = theory.barrier_rate(keys, "total")
    depth = barrier_depth(0.4, predicted["barrier"], 0.65, 0.1)
    assert predicted["depth"] == depth
    count, length = 0, 0.0
    width = round(depth / 0.1)
    for seed in range(60):
        noise = np.random.Generator(np.random.PCG64(seed)).standard_normal(40000)
        # An Ornstein-Uhlenbeck process has the exponential correlation of a Hurst exponent of 0.5.
        decay = math.exp(-0.1 / 2.0)
        field = lfilter([math.sqrt(1.0 - decay**2)], [1.0, -decay], noise)
        total = np.cumsum(0.4 + 0.35 * field)
        below = (total[width:] - total[:-width]) / width < predicted["barrier"]
        count += np.sum(below[1:] & ~below[:-1])
        length += 0.1 * below.size
    assert count > 100
    assert count / length == pytest.approx(predicted["barrier_rate"], rel=0.2)


def test_walks_with_exponential_correlation_are_absorbed_as_far_behind_0_as_the_theory_says():
    """Simulated walks: the mean step is that of an Ornstein-Uhlenbeck process of variance 1."""
    generator, step, count, start, distance = np.random.default_rng(1), 0.1, 40_000, 2.0, 100.0
    field, total = generator.standard_normal(count), np.full(count, start)
    decay = math.exp(-step)
    for _ in range(round(distance / step)):
        noise = math.sqrt(1.0 - decay**2) * generator.standard_normal(field.size)
        later = decay * field + noise
        total = total + 0.5 * step * (field + later)
        field, total = later[total > 0.0], total[total > 0.0]
    # The variance of the walk grows by 2 for each unit of distance.
    expected = math.erf((start + theory.MILNE) / math.sqrt(2.0 * 2.0 * distance))
    assert total.size / count == pytest.approx(expected, rel=0.03)


def test_first_passage_has_the_limits_of_a_random_walk():
    keys = KEYS | {"level": 0.0, "deviation": 0.3}
    rate = theory.diffusivity(keys)
    start = 1.0 + theory.MILNE * rate / 0.6
    alive = theory.first_passage(np.array([1e-6, 10.0, 1e6]), np.array(1.0), keys)
    assert alive[0] == 1.0
    assert alive[1] == pytest.approx(math.erf(start / math.sqrt(20.0 * rate)))
    assert alive[2] == pytest.approx(start * math.sqrt(2.0 / (math.pi * rate * 1e6)), rel=1e-5)
    drifting = theory.first_passage(np.array([1e6]), np.array(1.0), keys | {"level": 0.05})
    assert drifting[0] == pytest.approx(1.0 - math.exp(-0.1 * start / rate))


def test_pulses_under_held_stress_end_where_the_pre_stress_balances(study, ensembles):
    """At first order in the spacing, and their velocity is half of the integral."""
    checks = study("rough_checks").query("part == 'balance'").sort_values("dx")
    gap = checks["change"].to_numpy()
    assert np.all(checks["deaths"] >= 4) and np.all(np.diff(gap) > 0.0)
    assert np.all((gap[1:] / gap[:-1] > 1.4) & (gap[1:] / gap[:-1] < 2.6))
    pulses = ensembles.query("part == 'pulse' and died == False and velocity > 0.2")
    assert len(pulses) > 25
    assert np.median(np.abs(pulses["velocity"] / pulses["exact_velocity"] - 1.0)) < 0.05


def test_little_roughness_stops_no_pulse_under_held_displacement_and_much_does(study, ensembles):
    rows = ensembles.query("part == 'ensemble' and boundary == 'displacement'")
    little = rows["deviation"] <= 0.25 * rows["level"]
    assert little.sum() == 2 and (rows["deaths"][little] == 0).all()
    assert rows["deaths"][~little].sum() > 3
    assert (rows["rate_high"] > rows["barrier_rate"]).all()
    smooth = rows.loc[rows["correlation_length"].idxmax()]
    assert smooth["off_local"] < 0.04 < smooth["off_mean"]
    # A front takes as long as steady fronts at the local pre-stress.
    assert rows["slowness_off"].max() < 0.005
    checks = study("rough_checks")
    forgotten = checks.query("part == 'memory' and distance >= 1.0")
    assert forgotten["high"].max() < 2e-3
    exact = checks.query("part == 'exact'").pivot(index="hurst", columns="dx", values="change")
    assert (exact[0.025] < 0.65 * exact[0.05]).all() and exact[0.05].max() < 0.01


def test_pulses_die_as_often_in_the_second_half_of_longer_tracks(study):
    first, second = study("rough_checks").query("part == 'length'").to_dict("records")
    assert (first["stop"], second["stop"]) == (40.0, 80.0)
    # Pulses run through the whole first half before they come to the second one.
    assert first["distance"] > second["distance"] > 0.3 * first["distance"]
    assert first["deaths"] > 0
    assert first["rate_low"] < second["rate_high"] and second["rate_low"] < first["rate_high"]


def test_survival_under_held_stress_has_the_exponent_of_a_random_walk(ensembles):
    (long,) = ensembles.query("part == 'long'").itertuples()
    assert long.exponent_low < 0.5 < long.exponent_high and long.exponent_deaths > 20


@pytest.fixture(scope="module")
def ensembles(draw):
    return draw("study_rough_prestress").table


@pytest.mark.parametrize(("reach", "stick", "is_crack"), [(0.9, 50.0, False), (9.0, np.nan, True)])
def test_a_block_that_was_never_released_does_not_slide(reach, stick, is_crack):
    """It has no stick time, like a block that still slides."""
    x = np.linspace(-20.0, 20.0, 401)
    is_released = np.abs(x) < reach * START
    arrays = {
        "x": x,
        "release_time": np.where(is_released, np.abs(x), np.nan),
        "stick_time": np.where(is_released, stick, np.nan),
        "slip_velocity": np.zeros(x.size),
    }
    integral = np.cumsum(np.exp(-0.5 * CELL_MIDDLES**2) - 0.3)
    assert end_state(Recorded(arrays, {"end_time": 100.0}), integral)["is_crack"] == is_crack


def test_each_ensemble_has_its_own_end_of_track(shipped, monkeypatch):
    """A pulse that runs through a short track counts as alive, also if another track is longer."""
    monkeypatch.setattr(rough_checks, "GRID_SEEDS", 1)
    monkeypatch.setattr(rough_checks, "GRID_SPACINGS", (0.1,))
    monkeypatch.setattr(rough_checks, "LENGTH_SEEDS", 1)
    monkeypatch.setattr(rough_checks, "LENGTH_SPACING", 0.1)
    sweep = small_sweep(shipped, "rough_displacement") | {"duration": {"time": 12.0}}
    profile = sweep["profiles"][0]
    rough = profile["rough"] | {"deviation": 0.1, "seed": [1]}
    tracks = [rough | {"start": -end, "stop": end} for end in (20.0, 8.0)]

    def rows(check, *tracks):
        return check(sweep | {"profiles": [profile | {"rough": track} for track in tracks]})

    alone = [rows(rough_checks.grid_rows, track)["distance"].sum() for track in tracks]
    both = rows(rough_checks.grid_rows, *tracks)["distance"].sum()
    assert both == pytest.approx(sum(alone)) and alone[0] > alone[1] > 0.0
    halves = rows(rough_checks.length_rows, *tracks)
    assert halves["stop"].to_list() == [20.0, 40.0, 8.0, 16.0]


@pytest.mark.parametrize("release", ["total", "elastic"])
def test_pulses_are_compared_with_steady_ones_of_their_release_rule(shipped, release):
    """At a damping ratio of 0.1 the front speeds of both rules differ by 3 %."""
    sweep = small_sweep(shipped, "rough_settling") | {"release": release}
    smooth = sweep["profiles"][1]
    sweep["profiles"] = [smooth | {"rough": smooth["rough"] | {"seed": [1, 2]}}]
    scenes, samples = expand(sweep)
    data = run_sweep(scenes, samples, sweep["record"], threads=2)
    (ensemble,) = rough_prestress.ensembles_of(data, ExpandedProfiles(sweep["profiles"]))
    numbers = rough_prestress.steady_pulse_comparison(ensemble)
    assert numbers["slowness_off"] < 0.01
    row = rough_prestress.displacement_rows(ensemble).iloc[0]
    expected = barrier_depth(row["level"], row["barrier"], 0.65, 0.1, release)
    assert row["depth"] == pytest.approx(expected, rel=1e-12)


def test_no_ensemble_has_to_be_smooth_and_none_has_to_have_pulses(shipped):
    """The shipped ensembles under a stress boundary include one without roughness."""
    data, sweeps = {}, {}
    for name in rough_prestress.NEEDS["data"]:
        sweep = small_sweep(shipped, name)
        profile = sweep["profiles"][0]
        level = 0.0 if name == "rough_stress" else -0.2
        rough = profile["rough"] | {"seed": [1], "level": level, "deviation": 0.1}
        sweeps[name] = sweep | {"profiles": [profile | {"rough": rough}], "duration": {"time": 5.0}}
        scenes, samples = expand(sweeps[name])
        data[name] = run_sweep(scenes, samples, sweep["record"], threads=2)
    rows = rough_prestress.table(data, {}, {"sweeps": sweeps}).query("part == 'ensemble'")
    assert [*rows["boundary"]] == ["displacement", "displacement", "stress"]
    assert rows["barrier_rate"].isna().all()
    # The checks also solve scenes of another scheme, and accept durations in other units.
    other = {name: sweep | {"scheme": "fixed_step"} for name, sweep in sweeps.items()}
    other["rough_displacement"]["duration"] = {"half_periods": 1.5}
    checks = rough_checks.table({}, {}, {"sweeps": other})
    assert "memory" not in checks["part"].to_numpy()


def test_a_barrier_whose_depth_theory_does_not_resolve_is_replaced_by_a_nearby_one():
    barrier, parameters = -0.16824583120614445, (0.65, 0.08, "elastic")
    with pytest.raises(ValueError, match="unresolved"):
        barrier_depth(0.4, barrier, *parameters)
    expected = barrier_depth(0.4, 1.01 * barrier, *parameters)
    assert theory.critical_depth(0.4, barrier, *parameters) == pytest.approx(expected, rel=0.01)
