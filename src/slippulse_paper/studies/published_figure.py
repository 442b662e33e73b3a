"""Fit tau_0 and gamma to the published space-time figure, for each damping ratio and release rule.

A reading is a number that was read off the figure, such as the position of the trailing edge at a
time. A trial is a pair (tau_0, gamma), and has a value for each reading. This is the value of the
exact solution plus a correction, because the figure was drawn from a lattice with a finite spacing.
The correction comes from a lattice run. It is most important for the largest velocity, which is
still growing when the figure ends.
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

from .outermost_fronts import outermost_fronts

NEEDS = {"settings": ["published"]}

# The paper states this beta for the figure. The left panel ends at this time, which was read off.
BETA = 1.0e-3
PANEL_END = 10.8
# The fit begins at this tau_0 and gamma.
FIRST_GUESS = np.array([0.25, 0.55])
# Damping ratios around the best fit of each release rule, in even steps of the logarithm. They
# reach beyond the confidence region.
DAMPING_RATIOS = {
    "total": (0.05, 0.06, 0.072, 0.087, 0.104, 0.125),
    "elastic": (0.095, 0.12, 0.15, 0.19, 0.24, 0.3),
}
# Damping ratio, release rule and spacing of the authors' public notebook for the paper.
NOTEBOOK_RATIO = 0.2
NOTEBOOK_RELEASE = "total"
NOTEBOOK_SPACING = 0.05005
# Right panel: the pre-stress that was read off, and a duration that covers the panel.
RIGHT_PRESTRESS = Prestress(-0.75, 0.0, 5.0)
RIGHT_DURATION = 30.0
# Damping ratios for the right panel, around the best fit of the left panel.
RIGHT_DAMPING_RATIOS = (0.05, 0.1, 0.2)
# Number of times at which the largest velocity is sampled, and the position up to which it is
# sampled, divided by the duration.
TIME_COUNT = 109
RELATIVE_SAMPLE_REACH = 1.5
# Largest time step divided by dx, and order, of all lattice runs.
MAX_STEP, ORDER = 1.0, 8
# Over this last fraction of its path, which is beyond the Gaussian, the front has a constant speed.
FRONT_WINDOW = 0.3
# Number of positions at which the exact trailing edge is computed.
EDGE_POSITION_COUNT = 241
# Readings of the trailing edge are named by this prefix and their time.
TRAILING_EDGE_PREFIX = "trailing_edge_"
# Derivatives are computed from this relative change of tau_0 and of gamma.
RELATIVE_DIFFERENCE = 0.01
# Number of Gauss-Newton steps of a fit from the first guess, and from an extrapolated guess.
FIRST_GUESS_STEPS, EXTRAPOLATED_STEPS = 2, 1
# Number of further steps of the fit with the arrows. Its first step is taken from the optimum of
# the fit without them.
ARROW_STEPS = 1


class Optimum(NamedTuple):
    """The trial that fits some readings best.

    exact, correction : values of the exact solution, and corrections, for each reading
    slopes : derivatives of the independent pulls (see `LeftPanel.independent_pulls`) with respect
        to tau_0 (column 0) and gamma (column 1), before the last step of the fit
    """

    trial: np.ndarray
    exact: np.ndarray
    correction: np.ndarray
    slopes: np.ndarray


class Fit(NamedTuple):
    """The best trial at one damping ratio without the arrows, and the rows of the table."""

    trial: np.ndarray
    rows: pd.DataFrame


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each fit and reading. The column ``part`` has these values:

    profile, arrows : fits of the left panel, to all readings except its arrows, and to all readings
    notebook : the fit without arrows, with the settings of the authors' notebook
    stress : the largest velocity of the right panel, where nothing is fitted
    """
    published = settings["published"]
    panel = LeftPanel(readings_of(published, "space_time_displacement"))
    parts = []
    for release in RELEASES:
        parts += left_panel_rows(panel, release)
    notebook = panel.fit(
        damping_ratio=NOTEBOOK_RATIO,
        release=NOTEBOOK_RELEASE,
        dx=NOTEBOOK_SPACING,
        guess=FIRST_GUESS,
        steps=FIRST_GUESS_STEPS,
    )
    # Of the two fits, only that without arrows is kept.
    is_without_arrows = notebook.rows["part"] == "profile"
    parts.append(notebook.rows[is_without_arrows].assign(part="notebook"))
    readings = readings_of(published, "space_time_stress")
    readings = readings.drop(columns=["arrow", "shared_error"])
    largest_velocity = readings[readings["quantity"] == "largest_velocity"]
    for release, damping_ratio in product(RELEASES, RIGHT_DAMPING_RATIOS):
        parts.append(right_panel_rows(largest_velocity, damping_ratio, release))
    return pd.concat(parts, ignore_index=True)


def left_panel_rows(panel: "LeftPanel", release: str) -> list[pd.DataFrame]:
    """Fit the left panel at each damping ratio of one release rule, and return the rows."""
    damping_ratios = DAMPING_RATIOS[release]
    fits: list[Fit] = []
    for index, damping_ratio in enumerate(damping_ratios):
        guess = fits[-1].trial if fits else FIRST_GUESS
        steps = FIRST_GUESS_STEPS
        if len(fits) >= 2:
            # Extrapolate the last two fits linearly in the logarithm of the damping ratio.
            previous, last = fits[-2].trial, fits[-1].trial
            previous_ratio, last_ratio = damping_ratios[index - 2], damping_ratios[index - 1]
            change = (last - previous) * np.log(damping_ratio / last_ratio)
            guess = last + change / np.log(last_ratio / previous_ratio)
            steps = EXTRAPOLATED_STEPS
        dx = BETA / damping_ratio
        fits.append(panel.fit(damping_ratio, release, dx, guess=guess, steps=steps))
    return [fit.rows for fit in fits]


def right_panel_rows(
    largest_velocity: pd.DataFrame, damping_ratio: float, release: str
) -> pd.DataFrame:
    """Compare the largest velocity in the right panel with that of a lattice run.

    largest_velocity : the reading of the largest velocity, as a table with one row
    """
    dx = BETA / damping_ratio
    crack = ArrestingCrack(RIGHT_PRESTRESS, damping_ratio, release)
    scene = Scene(
        boundary="stress",
        prestress=RIGHT_PRESTRESS,
        duration=RIGHT_DURATION,
        dx=dx,
        gamma=0.0,
        beta=BETA,
        release=release,
        max_step=MAX_STEP,
        order=ORDER,
    )
    run = sampled_run(scene, left=crack.balance_position)
    velocity = float(run["sample_velocity"].max())
    # The exact value of the largest velocity does not depend on the damping.
    exact = crack.peak_velocity
    pull = (velocity - largest_velocity["drawn"]) / largest_velocity["reading_error"]
    return largest_velocity.assign(
        part="stress",
        release=release,
        damping_ratio=damping_ratio,
        dx=dx,
        left=RIGHT_PRESTRESS.left,
        width=RIGHT_PRESTRESS.width,
        exact=exact,
        correction=velocity - exact,
        pull=pull,
        independent_pull=pull,
        weight=1.0,
    )


def readings_of(published: dict, simulation: str) -> pd.DataFrame:
    """Return the readings of one panel, one row for each.

    published : readings of all panels by name, from the configuration
    simulation : name of the simulation that reproduces the panel

    The column drawn has the number that was read off the figure. The column arrow is True if it is
    the length of an arrow. Errors that several readings have in common are in shared_error.
    """
    rows = pd.DataFrame.from_dict(published, orient="index").rename_axis("reading").reset_index()
    rows = rows[rows["simulation"] == simulation].rename(columns={"value": "drawn"})
    # Readings without these keys have NaN in the table.
    rows["arrow"] = rows["arrow"].eq(True)
    rows["shared_error"] = rows["shared_error"].fillna(0.0)
    return rows[["reading", "drawn", "quantity", "reading_error", "shared_error", "arrow"]]


def sampled_run(scene: Scene, left: float) -> xr.Dataset:
    """Simulate a scene on a lattice, and sample velocities at TIME_COUNT times.

    The samples are taken at all blocks from the position ``left`` to beyond the right front.
    """
    right = RELATIVE_SAMPLE_REACH * scene.duration
    positions = scene.dx * np.arange(round(left / scene.dx), round(right / scene.dx))
    times = np.linspace(0.0, scene.duration, TIME_COUNT)
    return simulate_on_lattice(scene, Samples(times, positions))


class LeftPanel:
    """The readings of the left panel, and a fit of tau_0 and gamma to them.

    Arrays of values, pulls and slopes have one entry or row for each reading, in the order of
    ``readings``.
    """

    def __init__(self, readings: pd.DataFrame) -> None:
        """Keep the readings, from `readings_of`, with arrays of their columns."""
        self.readings = readings
        self.drawn = readings["drawn"].to_numpy()
        self.errors = readings["reading_error"].to_numpy()
        # This matrix turns deviations from the readings into numbers with independent errors of 1.
        shared_errors = readings["shared_error"].to_numpy()
        self.combinations = independent_combinations(self.errors, shared_errors)
        self.quantities = readings["quantity"].tolist()
        # Readings of the trailing edge have the time in their name.
        self.edges = [name for name in self.quantities if name.startswith(TRAILING_EDGE_PREFIX)]
        self.edge_times = [float(name.removeprefix(TRAILING_EDGE_PREFIX)) for name in self.edges]

    def exact_values(self, trial: np.ndarray, damping_ratio: float, release: str) -> np.ndarray:
        """Return the value for each reading by the exact solution of a trial."""
        tau0, gamma = map(float, trial)
        rupture = Rupture(Prestress(tau0, tau0), gamma, damping_ratio, release, PANEL_END)
        front_end = outermost_fronts(rupture).right
        # Over this last part of the path the front has a constant speed.
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
        # The trailing edge is at the position x when x sticks.
        x = np.linspace(0.0, front_end.x, EDGE_POSITION_COUNT)
        stick_time = rupture.stick_time(x)
        is_stuck = np.isfinite(stick_time)
        edge_positions = np.interp(self.edge_times, stick_time[is_stuck], x[is_stuck])
        values |= zip(self.edges, edge_positions, strict=True)
        for name in self.quantities:
            if name not in values:
                raise ValueError(f"quantity: {name!r}; allowed: {allowed}")
        return np.array([values[name] for name in self.quantities])

    def lattice_values(
        self, trial: np.ndarray, damping_ratio: float, release: str, dx: float
    ) -> np.ndarray:
        """Return the value for each reading in a lattice run of a trial."""
        tau0, gamma = map(float, trial)
        scene = Scene(
            boundary="displacement",
            prestress=Prestress(tau0, tau0),
            duration=PANEL_END,
            dx=dx,
            gamma=gamma,
            beta=damping_ratio * dx,
            release=release,
            max_step=MAX_STEP,
            order=ORDER,
        )
        run = sampled_run(scene, left=0.0)
        # The trailing edge is measured at the times of its readings.
        settings = {"front_window": FRONT_WINDOW, "trailing_times": self.edge_times}
        values, _ = measure_run(run, MEASURE_SETTINGS | settings)
        values["largest_velocity"] = float(run["sample_velocity"].max())
        return np.array([values[name] for name in self.quantities])

    def pulls(self, values: np.ndarray) -> np.ndarray:
        """Return the deviations of values from the readings, divided by the reading errors."""
        return (values - self.drawn) / self.errors

    def independent_pulls(self, values: np.ndarray) -> np.ndarray:
        """Return combinations of deviations from the readings that have independent errors of 1.

        The pulls are not independent, because some readings share a part of their errors. The sum
        of squares of the independent pulls is the chi-square.
        """
        return self.combinations @ (values - self.drawn)

    def slopes(
        self, trial: np.ndarray, exact: np.ndarray, damping_ratio: float, release: str
    ) -> np.ndarray:
        """Return the derivatives of the independent pulls at a trial.

        Column 0 has the derivatives with respect to tau_0, and column 1 those with respect to
        gamma.

        exact : the exact values at the trial
        """
        # One row for each parameter and one column for each reading.
        derivatives = []
        for parameter in range(len(trial)):
            change = np.zeros_like(trial)
            change[parameter] = RELATIVE_DIFFERENCE * trial[parameter]
            changed = self.exact_values(trial + change, damping_ratio, release)
            derivatives.append((changed - exact) / change[parameter])
        return self.combinations @ np.array(derivatives).T

    def fit(
        self, damping_ratio: float, release: str, dx: float, guess: np.ndarray, steps: int
    ) -> Fit:
        """Fit tau_0 and gamma by least squares, to all readings except the arrows.

        The returned rows contain this fit, and a second fit to all readings.

        guess : trial at which the first fit begins
        steps : number of steps of the first fit
        """
        without_arrows = ~self.readings["arrow"].to_numpy()
        everything = np.ones_like(without_arrows)
        best = self.optimum(damping_ratio, release, dx, guess, steps, without_arrows)
        # The second fit begins with a step from the first optimum, with the slopes known there.
        pulls = self.independent_pulls(best.exact + best.correction)
        guess_with_arrows = best.trial - least_squares(best.slopes, pulls)
        best_with_arrows = self.optimum(
            damping_ratio, release, dx, guess_with_arrows, ARROW_STEPS, everything
        )
        labels = {"release": release, "damping_ratio": damping_ratio, "dx": dx}
        rows = [
            self.rows_of(best, without_arrows).assign(part="profile", **labels),
            self.rows_of(best_with_arrows, everything).assign(part="arrows", **labels),
        ]
        return Fit(best.trial, pd.concat(rows))

    def optimum(
        self,
        damping_ratio: float,
        release: str,
        dx: float,
        guess: np.ndarray,
        steps: int,
        is_fitted: np.ndarray,
    ) -> Optimum:
        """Fit tau_0 and gamma to some readings by steps of the Gauss-Newton method.

        Each step solves a linear problem of least squares. The values are computed once more after
        the last step.

        is_fitted : True for each reading that is fitted
        """
        trial = guess
        for step in range(steps + 1):
            exact = self.exact_values(trial, damping_ratio, release)
            correction = self.lattice_values(trial, damping_ratio, release, dx) - exact
            pulls = self.independent_pulls(exact + correction)
            if step < steps:
                slopes = self.slopes(trial, exact, damping_ratio, release)
                trial = trial - least_squares(slopes[is_fitted], pulls[is_fitted])
        return Optimum(trial, exact, correction, slopes)

    def rows_of(self, best: Optimum, is_fitted: np.ndarray) -> pd.DataFrame:
        """Return one row for each reading, with its values and pulls at an optimum.

        Each row also has the optimum and the errors of tau_0 and gamma.
        """
        slopes, values = best.slopes[is_fitted], best.exact + best.correction
        # The inverse of this matrix has the variances of tau_0 and gamma on its diagonal.
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
    """Return the vector for which matrix @ vector is as close as possible to ``right_side``."""
    return np.linalg.lstsq(matrix, right_side, rcond=None)[0]
