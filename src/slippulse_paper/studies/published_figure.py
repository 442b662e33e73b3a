"""Fit parameters to the readings of the published space-time figure, by damping and release rule.

A reading is a number that was read off the figure, such as the position of the trailing edge at a
time. A trial is a pair (tau_0, gamma). Its values for the readings are those of the exact solution,
plus a correction for the finite spacing of the lattice from which the figure was drawn; a lattice
run of the same trial gives the correction. The largest velocity needs it most: it is the largest
value over all blocks, still grows when the figure ends, and falls with the spacing.
"""

from itertools import product
from typing import NamedTuple

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
BETA = 1.0e-3
PANEL_END = 10.8
# The fit begins at this tau_0 and gamma.
FIRST_GUESS = np.array([0.25, 0.55])
# Even steps of the logarithm around the best fit of each rule, beyond the range of accepted fits.
DAMPING_RATIOS = {
    "total": (0.05, 0.06, 0.072, 0.087, 0.104, 0.125),
    "elastic": (0.095, 0.12, 0.15, 0.19, 0.24, 0.3),
}
# Damping ratio, release rule and spacing of the authors' public notebook for the paper.
NOTEBOOK_RATIO = 0.2
NOTEBOOK_RELEASE = "total"
NOTEBOOK_SPACING = 0.05005
# Right panel: the pre-stress that was read off, and a duration that covers the panel.
RIGHT_PANEL = Prestress(-0.75, 0.0, 5.0)
RIGHT_DURATION = 30.0
# Damping ratios for the right panel, around the best fit of the left panel.
RIGHT_RATIOS = (0.05, 0.1, 0.2)
# Number of times at which the largest velocity is sampled, and reach of the samples divided by the
# duration.
TIME_COUNT = 109
RELATIVE_SAMPLE_REACH = 1.5
# Largest time step divided by dx, and order, of all lattice runs.
MAX_STEP, ORDER = 1.0, 8
# The front is straight over this last fraction of its path, which is beyond the Gaussian.
FRONT_WINDOW = 0.3
# Number of positions of the exact trailing edge.
EDGE_POSITION_COUNT = 241
# Readings of the trailing edge are named by this prefix and their time.
TRAILING_EDGE_PREFIX = "trailing_edge_"
# Relative change of tau_0 and gamma for a numerical slope.
SLOPE_DIFFERENCE = 0.01
# Number of steps of a fit from the first guess, and from an extrapolated guess.
FIRST_GUESS_STEPS, EXTRAPOLATED_STEPS = 2, 1
# Number of steps to the fit with the arrows, after one with the slopes of the fit without them.
ARROW_STEPS = 1


class Optimum(NamedTuple):
    """A trial that fits some readings best; arrays have one entry or row for each reading."""

    trial: np.ndarray
    exact: np.ndarray
    correction: np.ndarray
    slopes: np.ndarray  # of the independent pulls by tau_0 and gamma, at the trial before


class Fit(NamedTuple):
    """The best trial at one damping ratio, and its rows of the table."""

    trial: np.ndarray
    rows: pd.DataFrame


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each fit and reading, in four parts, which the column part names.

    profile, arrows : fits of the left panel, without its arrows and to all readings
    notebook : the fit without arrows, with the settings of the authors' notebook
    stress : the largest velocity of the right panel, where nothing is fitted
    """
    published = settings["published"]
    panel = LeftPanel(readings_of(published, "space_time_displacement"))
    parts = []
    for release in RELEASES:
        parts += profile_rows(panel, release)
    notebook = panel.fitted(
        ratio=NOTEBOOK_RATIO,
        release=NOTEBOOK_RELEASE,
        dx=NOTEBOOK_SPACING,
        guess=FIRST_GUESS,
        steps=FIRST_GUESS_STEPS,
    )
    without_arrows = notebook.rows["part"] == "profile"
    parts.append(notebook.rows[without_arrows].assign(part="notebook"))
    readings = readings_of(published, "space_time_stress")
    readings = readings.drop(columns=["arrow", "shared_error"])
    readings = readings[readings["quantity"] == "largest_velocity"]
    for release, ratio in product(RELEASES, RIGHT_RATIOS):
        parts.append(right_panel_rows(readings, ratio, release))
    return pd.concat(parts, ignore_index=True)


def profile_rows(panel: "LeftPanel", release: str) -> list[pd.DataFrame]:
    """Return the fits of the left panel at all damping ratios of one release rule."""
    ratios = DAMPING_RATIOS[release]
    fits: list[Fit] = []
    for index, ratio in enumerate(ratios):
        guess = fits[-1].trial if fits else FIRST_GUESS
        steps = FIRST_GUESS_STEPS
        if len(fits) >= 2:
            # Extrapolate the last two fits linearly in the logarithm of the damping ratio.
            previous, last = fits[-2].trial, fits[-1].trial
            previous_ratio, last_ratio = ratios[index - 2], ratios[index - 1]
            change = (last - previous) * np.log(ratio / last_ratio)
            guess = last + change / np.log(last_ratio / previous_ratio)
            steps = EXTRAPOLATED_STEPS
        fits.append(panel.fitted(ratio, release, BETA / ratio, guess, steps))
    return [fit.rows for fit in fits]


def right_panel_rows(readings: pd.DataFrame, ratio: float, release: str) -> pd.DataFrame:
    """Compare the largest velocity of the right panel with a lattice run of the pre-stress in it.

    readings : the reading of the largest velocity
    """
    dx = BETA / ratio
    crack = ArrestingCrack(RIGHT_PANEL, ratio, release)
    scene = Scene(
        boundary="stress",
        prestress=RIGHT_PANEL,
        duration=RIGHT_DURATION,
        dx=dx,
        gamma=0.0,
        beta=BETA,
        release=release,
        max_step=MAX_STEP,
        order=ORDER,
    )
    run = sampled(scene, crack.balance_position)
    velocity = float(run["sample_velocity"].max())
    # The exact value of the largest velocity does not depend on the damping.
    exact = crack.peak_velocity
    pull = (velocity - readings["drawn"]) / readings["reading_error"]
    return readings.assign(
        part="stress",
        release=release,
        damping_ratio=ratio,
        dx=dx,
        left=RIGHT_PANEL.left,
        width=RIGHT_PANEL.width,
        exact=exact,
        correction=velocity - exact,
        pull=pull,
        independent_pull=pull,
        weight=1.0,
    )


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
    right = RELATIVE_SAMPLE_REACH * scene.duration
    positions = scene.dx * np.arange(round(left / scene.dx), round(right / scene.dx))
    times = np.linspace(0.0, scene.duration, TIME_COUNT)
    return simulate_on_lattice(scene, Samples(times, positions))


class LeftPanel:
    """The left panel: its readings, and the values for them at a trial tau_0 and gamma.

    All arrays of values and slopes have one entry or row for each reading, in the order of
    ``readings``.
    """

    def __init__(self, readings: pd.DataFrame) -> None:
        self.readings = readings
        self.drawn = readings["drawn"].to_numpy()
        self.error = readings["reading_error"].to_numpy()
        # The sum of squares of these combinations of deviations is the chi-square.
        shared_error = readings["shared_error"].to_numpy()
        self.combinations = independent_combinations(self.error, shared_error)
        self.quantities = readings["quantity"].tolist()
        self.edges = [name for name in self.quantities if name.startswith(TRAILING_EDGE_PREFIX)]
        self.edge_times = [float(name.removeprefix(TRAILING_EDGE_PREFIX)) for name in self.edges]

    def exact(self, trial: np.ndarray, ratio: float, release: str) -> np.ndarray:
        """Return the values of the exact rupture for the readings, at a trial."""
        tau0, gamma = map(float, trial)
        rupture = Rupture(Prestress(tau0, tau0), gamma, ratio, release, PANEL_END)
        front_end = rupture.front_ends[-1][1]
        # The last part of the path of the right front is a straight line.
        start = (1.0 - FRONT_WINDOW) * front_end.x
        start_time = float(rupture.release_time(start))
        speed = (front_end.x - start) / (front_end.time - start_time)
        values = {
            "front_speed_right": speed,
            "front_intercept_right": front_end.x - speed * front_end.time,
            "first_stick_time": rupture.transition.time,
            "transition_length": rupture.transition.length,
            "largest_velocity": rupture.largest_velocity,
        }
        allowed = f"{', '.join(values)}, {TRAILING_EDGE_PREFIX}TIME"
        x = np.linspace(0.0, front_end.x, EDGE_POSITION_COUNT)
        stick_time = rupture.stick_time(x)
        is_stuck = np.isfinite(stick_time)
        edge_positions = np.interp(self.edge_times, stick_time[is_stuck], x[is_stuck])
        values |= zip(self.edges, edge_positions, strict=True)
        for name in self.quantities:
            if name not in values:
                raise ValueError(f"quantity: {name!r}; allowed: {allowed}")
        return np.array([values[name] for name in self.quantities])

    def lattice(self, trial: np.ndarray, ratio: float, release: str, dx: float) -> np.ndarray:
        """Return the values of a lattice run for the readings, at a trial."""
        tau0, gamma = map(float, trial)
        scene = Scene(
            boundary="displacement",
            prestress=Prestress(tau0, tau0),
            duration=PANEL_END,
            dx=dx,
            gamma=gamma,
            beta=ratio * dx,
            release=release,
            max_step=MAX_STEP,
            order=ORDER,
        )
        run = sampled(scene, 0.0)
        settings = {"front_window": FRONT_WINDOW, "trailing_times": self.edge_times}
        values, _ = measure_run(run, MEASURE_SETTINGS | settings)
        values["largest_velocity"] = float(run["sample_velocity"].max())
        return np.array([values[name] for name in self.quantities])

    def pulls(self, values: np.ndarray) -> np.ndarray:
        """Return how far values are from the readings, divided by the reading errors."""
        return (values - self.drawn) / self.error

    def independent_pulls(self, values: np.ndarray) -> np.ndarray:
        """Return deviations from the readings, combined and scaled to independent errors of 1."""
        return self.combinations @ (values - self.drawn)

    def slopes(
        self, trial: np.ndarray, exact: np.ndarray, ratio: float, release: str
    ) -> np.ndarray:
        """Return the derivatives of the independent pulls by tau_0 (column 0) and gamma (1).

        exact : the exact values at the trial
        """
        # One row for each parameter: only this parameter changes.
        changes = np.diag(SLOPE_DIFFERENCE * trial)
        changed = np.array([self.exact(trial + change, ratio, release) for change in changes])
        derivatives = (changed - exact) / changes.sum(axis=1)[:, np.newaxis]
        return self.combinations @ derivatives.T

    def fitted(self, ratio: float, release: str, dx: float, guess: np.ndarray, steps: int) -> Fit:
        """Fit tau_0 and gamma by least squares to all readings except the arrows.

        The rows contain this fit and the fit to all readings, arrows included. The first step
        towards the second fit uses the last slopes of the first one.
        """
        without_arrows = ~self.readings["arrow"].to_numpy()
        everything = np.ones_like(without_arrows)
        best = self.optimum(ratio, release, dx, guess, steps, without_arrows)
        pulls = self.independent_pulls(best.exact + best.correction)
        first_step = least_squares(best.slopes, pulls)
        guess_with_arrows = best.trial - first_step
        best_with_arrows = self.optimum(
            ratio, release, dx, guess_with_arrows, ARROW_STEPS, everything
        )
        labels = {"release": release, "damping_ratio": ratio, "dx": dx}
        rows = [
            self.rows_of(best, without_arrows).assign(part="profile", **labels),
            self.rows_of(best_with_arrows, everything).assign(part="arrows", **labels),
        ]
        return Fit(best.trial, pd.concat(rows))

    def optimum(
        self,
        ratio: float,
        release: str,
        dx: float,
        guess: np.ndarray,
        steps: int,
        is_fitted: np.ndarray,
    ) -> Optimum:
        """Fit tau_0 and gamma to some readings by steps of the Gauss-Newton method.

        Each step solves a linear problem. After the last step the values are computed once more, at
        the optimum.
        """
        trial = guess
        for step in range(steps + 1):
            exact = self.exact(trial, ratio, release)
            correction = self.lattice(trial, ratio, release, dx) - exact
            pulls = self.independent_pulls(exact + correction)
            if step < steps:
                slopes = self.slopes(trial, exact, ratio, release)
                trial = trial - least_squares(slopes[is_fitted], pulls[is_fitted])
        return Optimum(trial, exact, correction, slopes)

    def rows_of(self, best: Optimum, is_fitted: np.ndarray) -> pd.DataFrame:
        """Return one row for each reading, with its values and deviations.

        Each row also has the trial and the errors of tau_0 and gamma.
        """
        slopes, values = best.slopes[is_fitted], best.exact + best.correction
        tau0_error, gamma_error = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
        return self.readings.drop(columns=["arrow", "shared_error"]).assign(
            tau0=best.trial[0],
            gamma=best.trial[1],
            tau0_error=tau0_error,
            gamma_error=gamma_error,
            exact=best.exact,
            correction=best.correction,
            pull=self.pulls(values),
            independent_pull=self.independent_pulls(values),
            weight=is_fitted.astype(float),
        )


def least_squares(matrix: np.ndarray, right_side: np.ndarray) -> np.ndarray:
    """Return the vector that solves matrix @ vector = right_side in the sense of least squares."""
    return np.linalg.lstsq(matrix, right_side, rcond=None)[0]
