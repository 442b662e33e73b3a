"""The published space-time figure: the parameters that fit its readings best at each damping ratio and release rule.

The figure was drawn from a lattice. A trial is the exact solution of the continuum limit; what a finite spacing adds
to each reading is taken from a lattice run of the same trial. The largest velocity needs that most: it is the largest
value over all blocks, still grows when the figure ends, and falls with the spacing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import product

import numpy as np
import pandas as pd

from ..measure.fronts import front_speed, position_at
from ..measure.transition import between_fronts
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import RELEASES, Scene
from ..simulation.simulate import simulate
from ..theory.arrest import ArrestingCrack
from ..theory.rupture import Rupture

NEEDS = {"settings": ["published"]}

# As the paper states for the figure; where its left panel ends, as read off; and tau_0 and gamma from
# which the fit converges.
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
# Lattice: order, step in dx, times at which the largest velocity is looked for, reach of the samples over the duration.
ORDER, STEP, TIMES, REACH = 8, 1.0, 109, 1.5
# A lattice's front is a straight line over this last fraction of its path; the exact one is beyond the Gaussian.
WINDOW = 0.3
# Positions of the exact trailing edge and of the last profile of slip velocity.
EDGE, PROFILE = 241, 401
TRAILING = "trailing_edge_"
# Fractions of tau_0 and gamma over which a slope is taken; steps from a guess that is not near.
DIFFERENCE, FIRST = 0.01, 2


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Best fits of every reading of the left panel over the damping ratio, and what the right panel says.

    Parameters
    ----------
    settings : `published` of the configuration

    Returns
    -------
    rows by part, one a reading, with drawn, reading_error, exact, correction (lattice less exact), pull and weight (0
    where it is not fitted). "profile": release, damping_ratio, dx = beta/damping_ratio, and tau0 and gamma that
    fit all but the drawn arrows best, with their errors; "arrows": the same of all readings; "notebook": as "profile"
    at the damping ratio and spacing of the authors' public notebook; "stress": the right panel at the levels and width
    read off it

    Source: `claims.inference`.
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
    notebook = rows[rows["part"] == "profile"].assign(part="notebook")
    right = readings_of(settings["published"], "space_time_stress")
    parts += [notebook, _right_panel(right[right["quantity"] == "largest_velocity"])]
    return pd.concat(parts, ignore_index=True)


def readings_of(published: Mapping, simulation: str) -> pd.DataFrame:
    """What was read off for one simulation, of `published`: rows reading, quantity, drawn, reading_error,
    arrow."""
    rows = [
        {"reading": name, "drawn": entry["value"]}
        | {key: entry[key] for key in ("quantity", "reading_error")}
        | {"arrow": entry.get("arrow", False)}
        for name, entry in published.items()
        if entry["simulation"] == simulation
    ]
    return pd.DataFrame(rows)


class LeftPanel:
    """The left panel: its readings, and what a trial (tau_0 and gamma) gives for them."""

    def __init__(self, readings: pd.DataFrame) -> None:
        self.readings = readings
        self.quantities = readings["quantity"].tolist()
        self.drawn, self.error = readings["drawn"].to_numpy(), readings["reading_error"].to_numpy()

    def exact(self, trial: np.ndarray, ratio: float, release: str) -> np.ndarray:
        tau0, gamma = map(float, trial)
        rupture = Rupture(Prestress(tau0, tau0), gamma, ratio, release, END)
        return _chosen(self.quantities, *_exact_values(rupture))

    def lattice(self, trial: np.ndarray, ratio: float, release: str, dx: float) -> np.ndarray:
        tau0, gamma = map(float, trial)
        of = ("displacement", Prestress(tau0, tau0), END, dx, gamma, ratio * dx, release)
        return _lattice_values(Scene(*of, max_step=STEP, order=ORDER), 0.0, self.quantities)

    def fitted(
        self, ratio: float, release: str, dx: float, guess: np.ndarray, steps: int
    ) -> tuple[np.ndarray, pd.DataFrame]:
        """tau_0 and gamma that fit all but the arrows best, by some steps of Gauss and Newton; rows of both fits.

        That of all readings is so near that one more step, and the same correction for the lattice, suffice.
        """
        trial, fitted = guess, np.flatnonzero(~self.readings["arrow"])
        for step in range(steps + 1):
            exact = self.exact(trial, ratio, release)
            correction = self.lattice(trial, ratio, release, dx) - exact
            misfit = (exact + correction - self.drawn) / self.error
            if step < steps:
                changes = [
                    (self.exact(trial + change, ratio, release) - exact) / change.sum()
                    for change in np.diag(DIFFERENCE * trial)
                ]
                slopes = np.column_stack(changes) / self.error[:, None]
                trial = trial - np.linalg.lstsq(slopes[fitted], misfit[fitted], rcond=None)[0]

        def rows(part: str, at: np.ndarray, exact: np.ndarray, chosen: np.ndarray) -> pd.DataFrame:
            tau0_error, gamma_error = np.sqrt(np.diag(np.linalg.inv(slopes[chosen].T @ slopes[chosen])))
            return self.readings.drop(columns="arrow").assign(
                part=part, release=release, damping_ratio=ratio, dx=dx, tau0=at[0], gamma=at[1],
                tau0_error=tau0_error, gamma_error=gamma_error, exact=exact, correction=correction,
                pull=(exact + correction - self.drawn) / self.error,
                weight=np.isin(np.arange(len(exact)), chosen).astype(float),
            )  # fmt: skip

        every = np.arange(len(exact))
        near = trial - np.linalg.lstsq(slopes, misfit, rcond=None)[0]
        both = (
            rows("profile", trial, exact, fitted),
            rows("arrows", near, self.exact(near, ratio, release), every),
        )
        return trial, pd.concat(both)


# Readings by name, and the trailing edge over time.
Known = tuple[Mapping[str, float], Callable[[float], float]]


def _exact_values(rupture: Rupture) -> Known:
    """Readings of a symmetric exact rupture that ends where the figure does, and its trailing edge over time."""
    end = rupture.front_ends[-1][1]
    before = (1.0 - WINDOW) * end.x
    speed = (end.x - before) / (end.time - float(rupture.release_time(before)))
    x = np.linspace(0.0, end.x, EDGE)
    stick = rupture.stick_time(x)
    edge = stick[np.isfinite(stick)], x[np.isfinite(stick)]
    at_end = rupture.slip_velocity(np.linspace(0.0, end.x, PROFILE), rupture.duration)
    known = {
        "front_speed_right": speed,
        "front_intercept_right": end.x - speed * end.time,
        "first_stick_time": rupture.transition_time,
        "transition_length": rupture.transition_length,
        "largest_velocity": max(rupture.largest_velocity, float(np.max(at_end))),
    }
    return known, lambda time: float(np.interp(time, *edge))


def _lattice_values(scene: Scene, left: float, quantities: Iterable[str]) -> np.ndarray:
    """The same of a lattice run with samples at its blocks from x = left on."""
    positions = scene.dx * np.arange(round(left / scene.dx), round(REACH * scene.duration / scene.dx))
    samples = Samples(np.linspace(0.0, scene.duration, TIMES), positions)
    run = simulate(scene, samples)
    speed, intercept, _ = front_speed(run, WINDOW)
    known = {
        "front_speed_right": speed,
        "front_intercept_right": intercept,
        "first_stick_time": run.attrs["first_stick_time"],
        "transition_length": between_fronts(run, run.attrs["first_stick_time"]),
        "largest_velocity": float(run["sample_velocity"].max()),
    }
    return _chosen(quantities, known, lambda time: float(position_at(run, time, edge="stick_time")))


def _chosen(
    quantities: Iterable[str], known: Mapping[str, float], trailing_edge: Callable[[float], float]
) -> np.ndarray:
    out = []
    for name in quantities:
        if name not in known and not name.startswith(TRAILING):
            raise ValueError(f"quantity: {name!r}; allowed: {', '.join(known)}, {TRAILING}TIME")
        out.append(known[name] if name in known else trailing_edge(float(name.removeprefix(TRAILING))))
    return np.array(out)


def _right_panel(readings: pd.DataFrame) -> pd.DataFrame:
    """The largest velocity of the right panel: half the integral of tau in the limit, whatever the damping ratio."""
    parts = []
    for release, ratio in product(RELEASES, RIGHT_RATIOS):
        crack, dx = ArrestingCrack(RIGHT_PANEL, ratio, release), BETA / ratio
        of = ("stress", RIGHT_PANEL, RIGHT_DURATION, dx, 0.0, BETA, release)
        scene = Scene(*of, max_step=STEP, order=ORDER)
        (found,) = _lattice_values(scene, crack.balance_position, ["largest_velocity"])
        rows = readings.drop(columns="arrow").assign(
            part="stress", release=release, damping_ratio=ratio, dx=dx, left=RIGHT_PANEL.left, width=RIGHT_PANEL.width,
            exact=crack.peak_velocity, correction=found - crack.peak_velocity,
            pull=(found - readings["drawn"]) / readings["reading_error"], weight=1.0,
        )  # fmt: skip
        parts.append(rows)
    return pd.concat(parts)
