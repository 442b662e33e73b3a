"""Fit tau_0 and gamma to the published space-time figure, for each damping ratio and release rule.

A reading is a number that was read off the figure, such as the position of the trailing edge at a
time. A trial is a pair (tau_0, gamma), and has a value for each reading. This value is taken from a
lattice run, because the figure was drawn from a lattice with a finite spacing. The table also has
the value of the exact solution, and the correction, which is the lattice value minus the exact one.
The correction is largest for the largest velocity, which is still growing when the figure ends.
"""

from functools import cache
from itertools import product

import numpy as np
import pandas as pd
import xarray as xr
from scipy.optimize import least_squares

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
# The first fit of each release rule begins at this tau_0 and gamma.
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
# A fit ends when a step changes chi-square, or tau_0 and gamma, by less than this fraction.
FIT_TOLERANCE = 1e-2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each fit and reading. The column ``part`` has these values:

    profile, arrows : fits of the left panel, to all readings except its arrows, and to all readings
    notebook : the fit without arrows, with the settings of the authors' notebook
    stress : the largest velocity of the right panel, where nothing is fitted
    """
    published = settings["published"]
    panel = LeftPanel(readings_of(published, "space_time_displacement"))
    parts = [
        left_panel_rows(panel, release, part)
        for release, part in product(RELEASES, ("profile", "arrows"))
    ]
    # The damping ratio of the notebook is larger than those of the fits with its release rule. The
    # fit of the notebook begins at the result for the largest of these, which is in the last row.
    profiles = pd.concat(parts).query("part == 'profile'")
    closest = profiles[profiles["release"] == NOTEBOOK_RELEASE].iloc[-1]
    guess = closest[["tau0", "gamma"]].to_numpy(float)
    notebook = panel.fit(NOTEBOOK_RATIO, NOTEBOOK_RELEASE, NOTEBOOK_SPACING, guess)
    parts.append(notebook.assign(part="notebook"))
    readings = readings_of(published, "space_time_stress")
    # The table does not have these columns, which only fits use.
    readings = readings.drop(columns=["arrow", "shared_error"])
    largest_velocity = readings[readings["quantity"] == "largest_velocity"]
    for release, damping_ratio in product(RELEASES, RIGHT_DAMPING_RATIOS):
        parts.append(right_panel_rows(largest_velocity, damping_ratio, release))
    return pd.concat(parts, ignore_index=True)


def left_panel_rows(panel: "LeftPanel", release: str, part: str) -> pd.DataFrame:
    """Return the rows of one release rule, with a fit for each of its damping ratios.

    part : "profile" to fit all readings except the arrows, or "arrows" to fit all readings
    """
    rows: list[pd.DataFrame] = []
    trials = [FIRST_GUESS]
    for damping_ratio in DAMPING_RATIOS[release]:
        guess = trials[-1]
        if len(rows) >= 2:
            # The last two optima are extrapolated. The logarithms of the ratios are evenly spaced.
            guess = 2.0 * trials[-1] - trials[-2]
        dx = BETA / damping_ratio
        fit = panel.fit(damping_ratio, release, dx, guess, with_arrows=part == "arrows")
        rows.append(fit.assign(part=part))
        trials.append(fit[["tau0", "gamma"]].to_numpy()[0])
    return pd.concat(rows)


def right_panel_rows(
    largest_velocity: pd.DataFrame, damping_ratio: float, release: str
) -> pd.DataFrame:
    """Return a row that compares the largest velocity in the right panel with a lattice run.

    The run has the pre-stress that was read off the panel. Nothing is fitted.

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
    # The left front never runs beyond the balance position.
    run = sampled_run(scene, left=crack.balance_position)
    velocity = float(run["sample_velocity"].max())
    # The exact value of the largest velocity does not depend on the damping.
    exact = crack.peak_velocity
    # A pull is a deviation from a reading, divided by the error of the reading.
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
        # This reading shares no error with another one.
        independent_pull=pull,
        # A reading that is not fitted has the weight 0.
        weight=0.0,
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
        # Values that were read off the figure.
        self.drawn = readings["drawn"].to_numpy()
        self.errors = readings["reading_error"].to_numpy()
        shared_errors = readings["shared_error"].to_numpy()
        # This matrix turns deviations from the readings into numbers with independent errors of 1.
        self.decorrelation_matrix = independent_combinations(self.errors, shared_errors)
        self.quantities = readings["quantity"].tolist()
        # Readings of the trailing edge have the time in their name.
        self.edge_names, self.edge_times = [], []
        for name in self.quantities:
            if name.startswith(TRAILING_EDGE_PREFIX):
                self.edge_names.append(name)
                self.edge_times.append(float(name.removeprefix(TRAILING_EDGE_PREFIX)))

    def exact_values(self, trial: np.ndarray, damping_ratio: float, release: str) -> np.ndarray:
        """Return the value for each reading by the exact solution of a trial (tau_0, gamma)."""
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
        for name in self.quantities:
            if name not in values and name not in self.edge_names:
                allowed = f"{', '.join(values)}, {TRAILING_EDGE_PREFIX}TIME"
                raise ValueError(f"quantity: {name!r}; allowed: {allowed}")
        # The trailing edge is at the position x at the stick time of x.
        x = np.linspace(0.0, front_end.x, EDGE_POSITION_COUNT)
        stick_time = rupture.stick_time(x)
        is_stuck = np.isfinite(stick_time)
        edge_positions = np.interp(self.edge_times, stick_time[is_stuck], x[is_stuck])
        values |= zip(self.edge_names, edge_positions, strict=True)
        return np.array([values[name] for name in self.quantities])

    def lattice_values(
        self, trial: np.ndarray, damping_ratio: float, release: str, dx: float
    ) -> np.ndarray:
        """Return the value for each reading in a lattice run of a trial (tau_0, gamma)."""
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
        # The rupture is symmetric, so its right half is enough.
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
        return self.decorrelation_matrix @ (values - self.drawn)

    def fit(
        self,
        damping_ratio: float,
        release: str,
        dx: float,
        guess: np.ndarray,
        with_arrows: bool = False,
    ) -> pd.DataFrame:
        """Fit tau_0 and gamma by least squares, and return one row for each reading.

        Each row has the best tau_0 and gamma, their errors, and the values and pulls of the
        reading at this optimum. A pull is a deviation from the reading, divided by its error. The
        fit uses combinations of the pulls that have independent errors. The weight is 1 if the
        reading is fitted, and 0 if it is only compared with the fit.

        guess : tau_0 and gamma at which the fit begins
        with_arrows : whether the lengths of arrows are fitted, too
        """
        is_fitted = with_arrows | ~self.readings["arrow"].to_numpy()

        @cache
        def values_at(tau0: float, gamma: float) -> np.ndarray:
            """Return the lattice values of a trial. Those of the optimum are used twice."""
            return self.lattice_values(np.array([tau0, gamma]), damping_ratio, release, dx)

        def fitted_pulls(trial: np.ndarray) -> np.ndarray:
            """Return the independent pulls of all fitted readings, at a trial (tau_0, gamma)."""
            return self.independent_pulls(values_at(*trial))[is_fitted]

        optimum = least_squares(
            fitted_pulls,
            guess,
            diff_step=RELATIVE_DIFFERENCE,
            ftol=FIT_TOLERANCE,
            xtol=FIT_TOLERANCE,
        )
        # The inverse of this matrix has the variances of tau_0 and gamma on its diagonal.
        variances = np.diag(np.linalg.inv(optimum.jac.T @ optimum.jac))
        tau0_error, gamma_error = np.sqrt(variances)
        values = values_at(*optimum.x)
        exact = self.exact_values(optimum.x, damping_ratio, release)
        return self.readings.drop(columns=["arrow", "shared_error"]).assign(
            release=release,
            damping_ratio=damping_ratio,
            dx=dx,
            tau0=optimum.x[0],
            gamma=optimum.x[1],
            tau0_error=tau0_error,
            gamma_error=gamma_error,
            exact=exact,
            correction=values - exact,
            pull=self.pulls(values),
            independent_pull=self.independent_pulls(values),
            weight=is_fitted.astype(float),
        )
