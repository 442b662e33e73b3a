"""The published space-time figure: the parameters that fit its readings best at each damping ratio and release rule.

The figure was drawn from a lattice. A trial is the exact solution of the continuum limit; what a finite spacing adds
to each reading is taken from a lattice run of the same trial. The largest velocity needs that most: it is the largest
value over all blocks, still grows when the figure ends, and falls with the spacing.
"""

from collections.abc import Callable
from functools import partial
from itertools import product

import numpy as np
import pandas as pd
import xarray as xr

from ..measure.fronts import front_speed, position_at
from ..measure.transition import between_fronts
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import RELEASES, Scene
from ..simulation.runs import simulate_on_lattice
from ..theory.arrest import ArrestingCrack
from ..theory.rupture import Rupture

NEEDS = {"settings": ["published"]}

# As the paper states for the figure; where its left panel ends, as read off; tau_0 and gamma where the fit begins.
BETA, END, NEAR = 1.0e-3, 10.8, np.array([0.25, 0.55])
# Evenly in their logarithm about the best fit of each rule, as far as a fit is accepted and beyond.
DAMPING_RATIOS = {
    "total": (0.04, 0.055, 0.075, 0.1, 0.135, 0.18),
    "elastic": (0.075, 0.105, 0.145, 0.2, 0.28, 0.39),
}
# Damping ratio, release rule and spacing of the authors' public notebook for the paper.
NOTEBOOK = 0.2, "total", 0.05005
# The right panel: its pre-stress as read off, damping ratios about the best fit, and a duration that covers the panel.
RIGHT_PANEL, RIGHT_RATIOS, RIGHT_DURATION = Prestress(-0.75, 0.0, 5.0), (0.05, 0.1, 0.2), 30.0
# Lattice; times at which the largest velocity is looked for, and reach of the samples over the duration.
lattice_of, TIMES, REACH = partial(Scene, max_step=1.0, order=8), 109, 1.5
# A lattice's front is a straight line over this last fraction of its path; the exact one is beyond the Gaussian.
WINDOW = 0.3
# Positions of the exact trailing edge.
EDGE = 241
KNOWN = (
    "front_speed_right", "front_intercept_right", "first_stick_time", "transition_length", "largest_velocity"
)  # fmt: skip
TRAILING = "trailing_edge_"
# Fractions of tau_0 and gamma over which a slope is taken; steps from a guess that is not near.
DIFFERENCE, FIRST = 0.01, 2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Best fits of every reading of the left panel over the damping ratio, and what the right panel says.

    Returns rows by part, one a reading, with drawn, reading_error, exact, correction (lattice less exact), pull and
    weight (0 where it is not fitted). "profile": release, damping_ratio, dx = beta/damping_ratio, and tau0 and gamma
    that fit all but the drawn arrows best, with their errors; "arrows": the same of all readings; "notebook": as
    "profile", by NOTEBOOK; "stress": the right panel at the levels and width read off it
    """
    panel = LeftPanel(readings_of(settings["published"], "space_time_displacement"))
    parts = []
    for release in RELEASES:
        trials: list[tuple[float, np.ndarray]] = []
        for ratio in DAMPING_RATIOS[release]:
            guess, steps = trials[-1][1] if trials else NEAR, FIRST
            if len(trials) >= 2:
                # On the straight line through the last two trials, over the logarithm of the damping ratio.
                (one, first), (other, second) = trials[-2:]
                guess = second + (second - first) * np.log(ratio / other) / np.log(other / one)
                steps = 1
            trial, rows = panel.fitted(ratio, release, BETA / ratio, guess, steps)
            trials.append((ratio, trial))
            parts.append(rows)
    _, rows = panel.fitted(*NOTEBOOK, NEAR, FIRST)
    parts.append(rows[rows["part"] == "profile"].assign(part="notebook"))
    readings = readings_of(settings["published"], "space_time_stress").drop(columns="arrow")
    readings = readings[readings["quantity"] == "largest_velocity"]
    for release, ratio in product(RELEASES, RIGHT_RATIOS):
        # Half the integral of tau in the limit, whatever the damping ratio.
        crack, dx = ArrestingCrack(RIGHT_PANEL, ratio, release), BETA / ratio
        scene = lattice_of("stress", RIGHT_PANEL, RIGHT_DURATION, dx, 0.0, BETA, release)
        run = sampled(scene, crack.balance_position)
        found, exact = float(run["sample_velocity"].max()), crack.peak_velocity
        parts.append(readings.assign(
            part="stress", release=release, damping_ratio=ratio, dx=dx, left=RIGHT_PANEL.left, width=RIGHT_PANEL.width,
            exact=exact, correction=found - exact, pull=(found - readings["drawn"]) / readings["reading_error"],
            weight=1.0,
        ))  # fmt: skip
    return pd.concat(parts, ignore_index=True)


def readings_of(published: dict, simulation: str) -> pd.DataFrame:
    """What was read off for one simulation, of `published`: rows reading, drawn, quantity, reading_error, arrow."""
    found = pd.DataFrame.from_dict(published, orient="index").rename_axis("reading").reset_index()
    found = found[found["simulation"] == simulation].rename(columns={"value": "drawn"})
    return found[["reading", "drawn", "quantity", "reading_error"]].assign(
        arrow=found["arrow"].eq(True)
    )


def sampled(scene: Scene, left: float) -> xr.Dataset:
    """The lattice run of a scene, with samples at its blocks from x = left on."""
    positions = scene.dx * np.arange(
        round(left / scene.dx), round(REACH * scene.duration / scene.dx)
    )
    return simulate_on_lattice(scene, Samples(np.linspace(0.0, scene.duration, TIMES), positions))


class LeftPanel:
    """The left panel: its readings, and what a trial (tau_0 and gamma) gives for them."""

    def __init__(self, readings: pd.DataFrame) -> None:
        self.readings = readings
        self.drawn, self.error = readings["drawn"].to_numpy(), readings["reading_error"].to_numpy()

    def exact(self, trial: np.ndarray, ratio: float, release: str) -> np.ndarray:
        """Of the exact rupture, which ends where the figure does."""
        tau0, gamma = map(float, trial)
        rupture = Rupture(Prestress(tau0, tau0), gamma, ratio, release, END)
        end = rupture.front_ends[-1][1]
        before = (1.0 - WINDOW) * end.x
        speed = (end.x - before) / (end.time - float(rupture.release_time(before)))
        x = np.linspace(0.0, end.x, EDGE)
        stick = rupture.stick_time(x)
        edge = stick[np.isfinite(stick)], x[np.isfinite(stick)]
        transition = rupture.transition_time, rupture.transition_length
        known = speed, end.x - speed * end.time, *transition, rupture.largest_velocity
        return self._chosen(known, lambda time: np.interp(time, *edge))

    def lattice(self, trial: np.ndarray, ratio: float, release: str, dx: float) -> np.ndarray:
        """Of a lattice run."""
        tau0, gamma = map(float, trial)
        scene = lattice_of(
            "displacement", Prestress(tau0, tau0), END, dx, gamma, ratio * dx, release
        )
        run = sampled(scene, 0.0)
        speed, intercept, _ = front_speed(run, WINDOW)
        first = run.attrs["first_stick_time"]
        known = (
            speed,
            intercept,
            first,
            between_fronts(run, first),
            float(run["sample_velocity"].max()),
        )
        return self._chosen(known, lambda time: position_at(run, time, edge="stick_time"))

    def _chosen(self, known: tuple[float, ...], trailing_edge: Callable) -> np.ndarray:
        """The readings, of the numbers KNOWN and the trailing edge over time."""
        out, found = [], dict(zip(KNOWN, known, strict=True))
        for name in self.readings["quantity"]:
            if name not in found and not name.startswith(TRAILING):
                raise ValueError(f"quantity: {name!r}; allowed: {', '.join(KNOWN)}, {TRAILING}TIME")
            out.append(
                found[name] if name in found else trailing_edge(float(name.removeprefix(TRAILING)))
            )
        return np.array(out, dtype=float)

    def fitted(
        self, ratio: float, release: str, dx: float, guess: np.ndarray, steps: int
    ) -> tuple[np.ndarray, pd.DataFrame]:
        """tau_0 and gamma that fit all but the arrows best, by some steps of Gauss and Newton; rows of both fits.

        That of all readings is so near that one more step, and the same correction for the lattice, suffice.
        """
        trial, fitted = guess, ~self.readings["arrow"].to_numpy()
        for step in range(steps + 1):
            exact = self.exact(trial, ratio, release)
            correction = self.lattice(trial, ratio, release, dx) - exact
            misfit = (exact + correction - self.drawn) / self.error
            if step < steps:
                nudges = np.diag(DIFFERENCE * trial)
                changes = [
                    (self.exact(trial + each, ratio, release) - exact) / each.sum()
                    for each in nudges
                ]
                slopes = np.column_stack(changes) / self.error[:, None]
                trial = trial - np.linalg.lstsq(slopes[fitted], misfit[fitted], rcond=None)[0]
        near = trial - np.linalg.lstsq(slopes, misfit, rcond=None)[0]
        every, of_near, parts = np.ones_like(fitted), self.exact(near, ratio, release), []
        for part, at, found, chosen in (
            ("profile", trial, exact, fitted),
            ("arrows", near, of_near, every),
        ):
            errors = np.sqrt(np.diag(np.linalg.inv(slopes[chosen].T @ slopes[chosen])))
            rows = self.readings.drop(columns="arrow").assign(
                part=part, release=release, damping_ratio=ratio, dx=dx, tau0=at[0], gamma=at[1], tau0_error=errors[0],
                gamma_error=errors[1], exact=found, correction=correction,
                pull=(found + correction - self.drawn) / self.error, weight=chosen.astype(float),
            )  # fmt: skip
            parts.append(rows)
        return trial, pd.concat(parts)
