"""Fit parameters to the readings of the published space-time figure, by damping and release rule.

The figure was drawn from a lattice. A trial is the exact solution of the continuum limit; the
correction of each reading for a finite spacing is taken from a lattice run of the same trial. The
largest velocity needs that most: it is the largest value over all blocks, still grows when the
figure ends, and falls with the spacing.
"""

from collections.abc import Mapping
from functools import partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.measurement.inference import independent_combinations
from slippulse.measurement.table import measure_run
from slippulse.model.prestress import Prestress
from slippulse.model.release import RELEASES
from slippulse.model.samples import Samples
from slippulse.model.scene import Scene
from slippulse.prediction.measured_run import MEASURE_SETTINGS
from slippulse.simulation.sweep import simulate_on_lattice
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.rupture import Rupture

NEEDS = {"settings": ["published"]}

# The paper states this beta for the figure. The left panel ends at this time, which was read off.
BETA, PANEL_END = 1.0e-3, 10.8
# The fit begins at this tau_0 and gamma.
FIRST_GUESS = np.array([0.25, 0.55])
# Even steps of the logarithm around the best fit of each rule, beyond the range of accepted fits.
DAMPING_RATIOS = {
    "total": (0.05, 0.06, 0.072, 0.087, 0.104, 0.125),
    "elastic": (0.095, 0.12, 0.15, 0.19, 0.24, 0.3),
}
# Damping ratio, release rule and spacing of the authors' public notebook for the paper.
NOTEBOOK_SETTINGS = 0.2, "total", 0.05005
# Right panel: the pre-stress that was read off, and a duration that covers the panel.
RIGHT_PANEL, RIGHT_DURATION = Prestress(-0.75, 0.0, 5.0), 30.0
# Damping ratios for the right panel, around the best fit of the left panel.
RIGHT_RATIOS = (0.05, 0.1, 0.2)
# Number of times at which the largest velocity is sampled, and reach of the samples divided by the
# duration.
TIME_COUNT, SAMPLE_REACH = 109, 1.5
lattice_of = partial(Scene, max_step=1.0, order=8)
# The front is straight over this last fraction of its path, which is beyond the Gaussian.
FRONT_WINDOW = 0.3
# Number of positions of the exact trailing edge.
EDGE_POSITION_COUNT = 241
TRAILING_EDGE_PREFIX = "trailing_edge_"
# Relative change of tau_0 and gamma for a numerical slope; number of steps from the first guess.
SLOPE_DIFFERENCE, FIRST_GUESS_STEPS = 0.01, 2
# Number of steps to the fit with the arrows, after one with the slopes of the fit without them.
ARROW_STEPS = 1


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the parts profile (without arrows), arrows (all readings), notebook and stress."""
    panel = LeftPanel(readings_of(settings["published"], "space_time_displacement"))
    parts = []
    for release in RELEASES:
        trials: list[tuple[float, np.ndarray]] = []
        for ratio in DAMPING_RATIOS[release]:
            guess, steps = trials[-1][1] if trials else FIRST_GUESS, FIRST_GUESS_STEPS
            if len(trials) >= 2:
                # Extrapolate the last two fits linearly in the logarithm of the damping ratio.
                (one, first), (other, second) = trials[-2:]
                guess = second + (second - first) * np.log(ratio / other) / np.log(other / one)
                steps = 1
            trial, rows = panel.fitted(ratio, release, BETA / ratio, guess, steps)
            trials.append((ratio, trial))
            parts.append(rows)
    _, rows = panel.fitted(*NOTEBOOK_SETTINGS, FIRST_GUESS, FIRST_GUESS_STEPS)
    parts.append(rows[rows["part"] == "profile"].assign(part="notebook"))
    readings = readings_of(settings["published"], "space_time_stress")
    readings = readings.drop(columns=["arrow", "shared_error"])
    readings = readings[readings["quantity"] == "largest_velocity"]
    for release, ratio in product(RELEASES, RIGHT_RATIOS):
        # The exact value of the largest velocity does not depend on the damping.
        crack, dx = ArrestingCrack(RIGHT_PANEL, ratio, release), BETA / ratio
        scene = lattice_of("stress", RIGHT_PANEL, RIGHT_DURATION, dx, 0.0, BETA, release)
        velocity = float(sampled(scene, crack.balance_position)["sample_velocity"].max())
        rows = readings.assign(part="stress", release=release, damping_ratio=ratio, dx=dx)
        rows = rows.assign(left=RIGHT_PANEL.left, width=RIGHT_PANEL.width)
        rows = rows.assign(exact=crack.peak_velocity, correction=velocity - crack.peak_velocity)
        rows["pull"] = (velocity - rows["drawn"]) / rows["reading_error"]
        rows["independent_pull"] = rows["pull"]
        parts.append(rows.assign(weight=1.0))
    return pd.concat(parts, ignore_index=True)


def readings_of(published: dict, simulation: str) -> pd.DataFrame:
    """Return the numbers that were read off one panel of the published figure, one row for each.

    published : readings of all panels by name, from the configuration
    simulation : name of the simulation that reproduces the panel

    ``drawn`` is the number, and ``arrow`` is True if it is the length of an arrow in the panel.
    """
    rows = pd.DataFrame.from_dict(published, orient="index").rename_axis("reading").reset_index()
    rows = rows[rows["simulation"] == simulation].rename(columns={"value": "drawn"})
    # Readings without these keys have NaN in the table.
    rows["arrow"] = rows["arrow"].eq(True)
    rows["shared_error"] = rows["shared_error"].fillna(0.0)
    return rows[["reading", "drawn", "quantity", "reading_error", "shared_error", "arrow"]]


def sampled(scene: Scene, left: float) -> xr.Dataset:
    """Simulate a scene on a lattice, with samples at all blocks from x = left on."""
    first, last = left / scene.dx, SAMPLE_REACH * scene.duration / scene.dx
    positions = scene.dx * np.arange(round(first), round(last))
    return simulate_on_lattice(
        scene, Samples(np.linspace(0.0, scene.duration, TIME_COUNT), positions)
    )


class Fit(NamedTuple):
    """Fitted tau_0 and gamma, and for each reading the exact value and its lattice correction."""

    trial: np.ndarray
    exact: np.ndarray
    correction: np.ndarray
    slopes: np.ndarray  # of the independent pulls with respect to tau_0 and gamma


class LeftPanel:
    """The left panel: its readings, and the values for them at a trial tau_0 and gamma."""

    def __init__(self, readings: pd.DataFrame) -> None:
        self.readings = readings
        self.drawn, self.error = readings["drawn"].to_numpy(), readings["reading_error"].to_numpy()
        shared = readings["shared_error"].to_numpy()
        # The sum of squares of these combinations of deviations is the chi-square.
        self.combinations = independent_combinations(self.error, shared)
        self.quantities = readings["quantity"].tolist()
        self.edges = [name for name in self.quantities if name.startswith(TRAILING_EDGE_PREFIX)]
        self.times = [float(name.removeprefix(TRAILING_EDGE_PREFIX)) for name in self.edges]

    def independent_pulls(self, values: np.ndarray) -> np.ndarray:
        """Return deviations from the readings, combined and scaled to independent errors of 1."""
        return self.combinations @ (values - self.drawn)

    def exact(self, trial: np.ndarray, ratio: float, release: str) -> np.ndarray:
        """Return the values of the exact rupture, which ends at the end of the panel."""
        tau0, gamma = map(float, trial)
        rupture = Rupture(Prestress(tau0, tau0), gamma, ratio, release, PANEL_END)
        end = rupture.front_ends[-1][1]
        before = (1.0 - FRONT_WINDOW) * end.x
        speed = (end.x - before) / (end.time - float(rupture.release_time(before)))
        x = np.linspace(0.0, end.x, EDGE_POSITION_COUNT)
        stick = rupture.stick_time(x)
        stuck = np.isfinite(stick)
        numbers = {
            "front_speed_right": speed,
            "front_intercept_right": end.x - speed * end.time,
            "first_stick_time": rupture.transition.time,
            "transition_length": rupture.transition.length,
            "largest_velocity": rupture.largest_velocity,
        }
        allowed = f"{', '.join(numbers)}, {TRAILING_EDGE_PREFIX}TIME"
        numbers |= zip(self.edges, np.interp(self.times, stick[stuck], x[stuck]), strict=True)
        for name in self.quantities:
            if name not in numbers:
                raise ValueError(f"quantity: {name!r}; allowed: {allowed}")
        return np.array([numbers[name] for name in self.quantities])

    def lattice(self, trial: np.ndarray, ratio: float, release: str, dx: float) -> np.ndarray:
        """Return the values of a lattice run."""
        tau0, gamma = map(float, trial)
        profile = Prestress(tau0, tau0)
        scene = lattice_of("displacement", profile, PANEL_END, dx, gamma, ratio * dx, release)
        run, settings = (
            sampled(scene, 0.0),
            {"front_window": FRONT_WINDOW, "trailing_times": self.times},
        )
        numbers, _ = measure_run(run, MEASURE_SETTINGS | settings)
        numbers["largest_velocity"] = float(run["sample_velocity"].max())
        return np.array([numbers[name] for name in self.quantities])

    def fitted(
        self, ratio: float, release: str, dx: float, guess: np.ndarray, steps: int
    ) -> tuple[np.ndarray, pd.DataFrame]:
        """Fit tau_0 and gamma to all readings except the arrows, and then to all readings."""
        labels = {"release": release, "damping_ratio": ratio, "dx": dx}
        without_arrows = ~self.readings["arrow"].to_numpy()
        everything = np.ones_like(without_arrows)
        profile = self._gauss_newton(labels, guess, steps, without_arrows)
        # The first step towards the arrows can use the last slopes.
        misfit = self.independent_pulls(profile.exact + profile.correction)
        near = profile.trial - np.linalg.lstsq(profile.slopes, misfit, rcond=None)[0]
        arrows = self._gauss_newton(labels, near, ARROW_STEPS, everything)
        rows = [
            self._rows(fit, chosen).assign(part=part, **labels)
            for part, fit, chosen in (
                ("profile", profile, without_arrows),
                ("arrows", arrows, everything),
            )
        ]
        return profile.trial, pd.concat(rows)

    def _gauss_newton(
        self, labels: Mapping[str, Any], guess: np.ndarray, steps: int, chosen: np.ndarray
    ) -> "Fit":
        """Fit tau_0 and gamma to some readings by Gauss-Newton steps."""
        trial, (release, ratio, dx) = guess, labels.values()
        for step in range(steps + 1):
            exact = self.exact(trial, ratio, release)
            correction = self.lattice(trial, ratio, release, dx) - exact
            misfit = self.independent_pulls(exact + correction)
            if step < steps:
                nudges = np.diag(SLOPE_DIFFERENCE * trial)
                nudged = [self.exact(trial + nudge, ratio, release) for nudge in nudges]
                changes = (np.array(nudged) - exact) / nudges.sum(axis=1)[:, None]
                slopes = self.combinations @ changes.T
                trial = trial - np.linalg.lstsq(slopes[chosen], misfit[chosen], rcond=None)[0]
        return Fit(trial, exact, correction, slopes)

    def _rows(self, fit: "Fit", chosen: np.ndarray) -> pd.DataFrame:
        """Return the readings with the numbers of a fit to some of them."""
        slopes, values = fit.slopes[chosen], fit.exact + fit.correction
        errors = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
        numbers = {"tau0": fit.trial[0], "gamma": fit.trial[1], "tau0_error": errors[0]}
        numbers |= {"gamma_error": errors[1], "exact": fit.exact, "correction": fit.correction}
        numbers |= {"pull": (values - self.drawn) / self.error}
        numbers |= {"independent_pull": self.independent_pulls(values)}
        rows = self.readings.drop(columns=["arrow", "shared_error"])
        return rows.assign(**numbers, weight=chosen.astype(float))
