"""Inference of known parameters from the published figure; the scheme of its authors."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import least_squares

from slippulse.measurement.inference import chi_square_rise, infer_parameters, interpolate_fits
from slippulse.model.prestress import Prestress
from slippulse_paper.studies import published_figure as study_module
from slippulse_paper.studies.published_figure import BETA, FIRST_GUESS, LeftPanel

# How many readings are fitted: all, or all but the two arrows.
READINGS = {"profile": 10, "arrows": 12}


@pytest.fixture(scope="module")
def table(study):
    return study("published_figure")


@pytest.fixture
def panel(config):
    return LeftPanel(study_module.readings_of(config["published"], "space_time_displacement"))


@pytest.mark.slow
def test_it_finds_the_parameters_of_a_lattice_run(config, panel, monkeypatch):
    truth, ratio = np.array([0.3, 0.6]), 0.12
    values = panel.lattice_values(truth, ratio, "total", BETA / ratio)
    for name, value in zip(panel.readings["reading"], values, strict=True):
        config["published"][name]["value"] = float(value)
    ratios = {"total": (0.09, 0.104, 0.12, 0.139), "elastic": (0.1, 0.15, 0.22, 0.3)}
    monkeypatch.setattr(study_module, "DAMPING_RATIOS", ratios)
    monkeypatch.setattr(study_module, "RIGHT_DAMPING_RATIOS", (0.1,))
    best = infer_parameters(study_module.table({}, {}, config))["best"]
    assert best["release"] == "total" and best["chi2"] < 0.05
    assert best["damping_ratio"] == pytest.approx(ratio, rel=0.02)
    assert [best["tau0"], best["gamma"]] == pytest.approx(truth, abs=2e-3)
    low, high = best["regions"][0.68]
    assert low < ratio < high


@pytest.mark.parametrize("part", READINGS)
@pytest.mark.parametrize("release", ["total", "elastic"])
def test_best_fits_are_those_of_lattices_in_their_regions(table, panel, release, part):
    fits = infer_parameters(table, part=part)
    best = fits[release]
    fitted = ~panel.readings["arrow"] | (part == "arrows")
    assert fitted.sum() == READINGS[part]
    ratio, dx = best["damping_ratio"], best["dx"]
    assert dx == pytest.approx(BETA / ratio, rel=1e-3)

    def pulls(trial: np.ndarray) -> np.ndarray:
        return panel.independent_pulls(panel.lattice_values(trial, ratio, release, dx))[fitted]

    result = least_squares(pulls, FIRST_GUESS, x_scale=FIRST_GUESS, diff_step=0.01, xtol=1e-4)
    assert 2.0 * result.cost == pytest.approx(best["chi2"], abs=0.05)
    assert result.x == pytest.approx([best["tau0"], best["gamma"]], abs=1e-3)
    assert fits["best"]["chi2"] == min(fits["total"]["chi2"], fits["elastic"]["chi2"])
    profile = table[(table["part"] == part) & (table["release"] == release)]
    line, fitted = (
        interpolate_fits(profile),
        profile.loc[profile["weight"] > 0.0, "reading"].unique(),
    )
    for level, (low, high) in best["regions"].items():
        assert low < ratio < high
        chi_square = np.interp([low, high], line["damping_ratio"], line["chi2"])
        assert chi_square == pytest.approx(best["chi2"] + chi_square_rise(level), abs=0.15)
    # The pulls of single readings share errors.
    errors = panel.readings.set_index("reading")["reading_error"]
    deviations = np.array(
        [best["pulls"][name] * errors[name] for name in panel.readings["reading"]]
    )
    independent = panel.independent_pulls(panel.drawn + deviations)
    is_fitted = panel.readings["reading"].isin(fitted).to_numpy()
    assert best["chi2"] == pytest.approx((independent[is_fitted] ** 2).sum())
    # Less three parameters.
    assert best["dof"] == READINGS[part] - 3
    assert [chi_square_rise(0.95), chi_square_rise(0.95, 2)] == pytest.approx(
        [3.841, 5.991], abs=1e-3
    )


@pytest.mark.parametrize("part", READINGS)
def test_trials_are_smallest_in_chi_square_at_their_damping_ratio(table, panel, part):
    profile = table[(table["part"] == part) & (table["release"] == "total")]
    rows = profile[profile["damping_ratio"] == profile["damping_ratio"].unique()[2]]
    trial, ratio = rows[["tau0", "gamma"]].to_numpy()[0], rows["damping_ratio"].iloc[0]
    smallest = (rows["weight"] * rows["independent_pull"] ** 2).sum()
    for change in ((0.004, 0.0), (-0.004, 0.0), (0.0, 0.008), (0.0, -0.008)):
        exact = panel.exact_values(trial + change, ratio, "total")
        pulls = panel.independent_pulls(exact + rows["correction"].to_numpy())
        assert (rows["weight"] * pulls**2).sum() > smallest + 0.5


def test_the_errors_that_readings_of_the_edge_do_not_share_are_those_of_their_scatter(panel, table):
    """Third differences contain no offset, scale or curvature, whatever axes and run are."""
    is_edge = panel.readings["shared_error"].to_numpy() > 0.0
    assert panel.readings["reading"][is_edge].str.startswith("trailing_edge_").all()
    rows = table[table["part"] == "profile"]
    for _, run in rows.groupby(["release", "damping_ratio"]):
        deviations = (run["exact"] + run["correction"] - run["drawn"]).to_numpy()[is_edge]
        scatter = math.sqrt((np.diff(deviations, 3) ** 2).mean() / (1 + 9 + 9 + 1))
        own = panel.errors**2 - panel.readings["shared_error"].to_numpy() ** 2
        assert np.sqrt(own[is_edge]) == pytest.approx(scatter, rel=0.1)


def test_a_shared_error_of_all_readings_of_an_edge_costs_as_much_as_that_of_one(panel):
    """Chi-square is that of the best common displacement, which has its own error."""
    shift, is_edge = 0.03, panel.readings["shared_error"].to_numpy() > 0.0
    one, shared = panel.errors[is_edge][0], panel.readings["shared_error"].max()
    together = (panel.independent_pulls(panel.drawn + shift * is_edge) ** 2).sum()
    own = one**2 - shared**2
    assert together == pytest.approx(shift**2 / (shared**2 + own / is_edge.sum()))
    others = np.flatnonzero(~is_edge)
    moved = panel.drawn + np.where(is_edge, 0.0, panel.errors)
    assert panel.independent_pulls(moved)[others] == pytest.approx(1.0)


def test_an_end_beyond_the_fits_is_not_known(table):
    ratio = table["damping_ratio"]
    profile = (table["part"] == "profile") & (table["release"] == "elastic")
    kept = profile & (ratio < 0.29) & (ratio > 0.12)
    low, high = infer_parameters(table[kept])["elastic"]["regions"][0.95]
    assert np.isnan(low) and np.isfinite(high)


def test_the_right_panel_fixes_the_width_and_nothing_else(table):
    rows = table[table["part"] == "stress"]
    # Half the integral of tau right of its zero, by the trapezoidal rule.
    level, width = rows["left"].iloc[0], rows["width"].iloc[0]
    x = np.linspace(-3.0 * width, 8.0 * width, 200_001)
    tau = Prestress(level, 0.0, width)(x)
    zero = np.flatnonzero(tau < 0.0)[-1] + 1
    half = 0.5 * np.trapezoid(tau[zero:], x[zero:])
    assert rows["exact"].to_numpy() == pytest.approx(half, rel=1e-5)
    # In reading errors; and the W that would meet the reading exactly, at that level.
    assert np.ptp(rows["pull"]) < 1.0
    fit = (width * rows["drawn"] / (rows["exact"] + rows["correction"])).mean()
    assert abs(fit - width) < 3.0 * (width * rows["reading_error"] / rows["exact"]).min()


def test_an_unknown_quantity_is_named():
    numbers = {"quantity": ["colour"], "drawn": 1.0, "reading_error": 0.1, "shared_error": 0.0}
    panel = LeftPanel(pd.DataFrame(numbers))
    with pytest.raises(ValueError, match="quantity: 'colour'; allowed: front_speed_right"):
        panel.exact_values(np.array([0.5, 0.65]), 0.1, "total")


@pytest.mark.slow
def test_short_steps_of_the_published_scheme_cost_less_than_its_spacing(study):
    table = study("published_scheme").set_index("quantity")
    errors = (table[["published", "localised"]].div(table["exact"], axis=0) - 1.0).abs()
    # Here the damped front speed is 1.4725, far from the undamped 1.25.
    assert table.loc["front_speed", "exact"] == pytest.approx(1.4725, abs=1e-4)
    assert errors.loc["front_speed"].max() < 1e-3 and errors.loc["pulse_slip"].max() < 1e-3
    late = errors.loc["first_stick_time"]
    assert late["published"] < 2.0 * late["localised"] < 0.01
