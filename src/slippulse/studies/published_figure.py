"""The published space-time figure: the parameters that fit its readings best at each damping ratio and release rule."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd

from ..claims.inference import inference, readings_of
from ..model.prestress import Prestress
from ..model.roots import root_between
from ..model.samples import Samples
from ..model.scene import RELEASES, Scene
from ..predict.published_figure import exact_values, lattice_values
from ..simulation.simulate import simulate
from ..theory.arrest import ArrestingCrack
from ..theory.rupture import Rupture
from ..theory.transition import paper_transition_displacement

# What it is made from besides its own section of `studies`.
NEEDS = {"settings": ["published"]}

# Lattice: order, step in dx, times at which the largest velocity is looked for, reach of the samples over the duration.
ORDER, STEP, TIMES, REACH = 8, 1.0, 109, 1.5
# Shares of tau_0 and gamma over which a slope is taken; steps from a guess that is not near.
DIFFERENCE, FIRST = 0.01, 2


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Best fits of every reading of the left panel over the damping ratio, and what the right panel says.

    Parameters
    ----------
    settings : `studies.published_figure`, and `published`

    Returns
    -------
    rows by part, one a reading, with drawn, reading_error, exact, correction (lattice less exact) and pull. "profile":
    release, damping_ratio, dx = beta/damping_ratio, and tau0 and gamma that fit best with their errors; "notebook":
    the same at the damping ratio and spacing of the authors' public notebook; "stress": the right panel at the levels
    and width read off it; "arrow": where the arrows end, the paper's estimate, and the exact value at the best fit

    Source: `claims.inference`.
    """
    panel = _Panel(readings_of(settings["published"], "space_time_displacement"), settings["end"])
    start = np.array([settings["near"]["tau0"], settings["near"]["gamma"]])
    parts = []
    for release in RELEASES:
        trials: list[tuple[float, np.ndarray]] = []
        for ratio in settings["damping_ratios"][release]:
            if len(trials) < 2:
                guess, steps = trials[-1][1] if trials else start, FIRST
            else:
                guess, steps = _ahead(trials, ratio), 1
            trial, rows = panel.fitted(ratio, release, settings["beta"] / ratio, guess, steps)
            trials.append((ratio, trial))
            parts.append(rows.assign(part="profile"))
    notebook = settings["notebook"]
    _, rows = panel.fitted(notebook["damping_ratio"], notebook["release"], notebook["dx"], start, FIRST)
    parts += [rows.assign(part="notebook"), _stress(settings)]
    parts.append(pd.DataFrame(_arrows(settings, inference(pd.concat(parts))["best"])))
    return pd.concat(parts, ignore_index=True)


def _ahead(trials: list[tuple[float, np.ndarray]], ratio: float) -> np.ndarray:
    """On the straight line through the last two trials, over the logarithm of the damping ratio."""
    (one, first), (other, second) = trials[-2:]
    return second + (second - first) * np.log(ratio / other) / np.log(other / one)


class _Panel:
    """The left panel: its readings, and when it ends."""

    def __init__(self, readings: pd.DataFrame, end: float) -> None:
        self.readings, self.end = readings, end
        self.quantities = readings["quantity"].tolist()
        self.drawn, self.error = readings["drawn"].to_numpy(), readings["reading_error"].to_numpy()

    def exact(self, trial: np.ndarray, ratio: float, release: str) -> np.ndarray:
        tau0, gamma = map(float, trial)
        return exact_values(Rupture(Prestress(tau0, tau0), gamma, ratio, release, self.end), self.quantities)

    def lattice(self, trial: np.ndarray, ratio: float, release: str, dx: float) -> np.ndarray:
        tau0, gamma = map(float, trial)
        scene = Scene(
            "displacement", Prestress(tau0, tau0), self.end, dx, gamma, ratio * dx, release,
            max_step=STEP, order=ORDER,
        )  # fmt: skip
        return lattice_values(simulate(scene, _every_block(scene, 0.0)), self.quantities)

    def fitted(
        self, ratio: float, release: str, dx: float, guess: np.ndarray, steps: int
    ) -> tuple[np.ndarray, pd.DataFrame]:
        """tau_0 and gamma that fit best, by so many steps of Gauss and Newton, and their rows."""
        trial = guess
        exact = self.exact(trial, ratio, release)
        correction = self.lattice(trial, ratio, release, dx) - exact
        for _ in range(steps):
            changes = [
                (self.exact(trial + change, ratio, release) - exact) / change.sum()
                for change in np.diag(DIFFERENCE * trial)
            ]
            slopes = np.column_stack(changes) / self.error[:, None]
            misfit = (exact + correction - self.drawn) / self.error
            trial = trial - np.linalg.lstsq(slopes, misfit, rcond=None)[0]
            exact = self.exact(trial, ratio, release)
            correction = self.lattice(trial, ratio, release, dx) - exact
        tau0_error, gamma_error = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
        rows = self.readings.assign(
            release=release, damping_ratio=ratio, dx=dx, tau0=trial[0], gamma=trial[1], tau0_error=tau0_error,
            gamma_error=gamma_error, exact=exact, correction=correction,
            pull=(exact + correction - self.drawn) / self.error,
        )  # fmt: skip
        return trial, rows


def _every_block(scene: Scene, left: float) -> Samples:
    """Samples at the blocks from x = left on."""
    positions = scene.dx * np.arange(round(left / scene.dx), round(REACH * scene.duration / scene.dx))
    return Samples(np.linspace(0.0, scene.duration, TIMES), positions)


def _stress(settings: Mapping) -> pd.DataFrame:
    """The largest velocity of the right panel: half the integral of tau in the limit, whatever the damping ratio."""
    readings = readings_of(settings["published"], "space_time_stress")
    readings = readings[readings["quantity"] == "largest_velocity"]
    right = settings["stress"]
    profile = Prestress(right["left"], 0.0, right["width"])
    parts = []
    for release in RELEASES:
        for ratio in right["damping_ratios"]:
            crack, dx = ArrestingCrack(profile, ratio, release), settings["beta"] / ratio
            scene = Scene(
                "stress", profile, right["duration"], dx, 0.0, ratio * dx, release, max_step=STEP, order=ORDER
            )
            run = simulate(scene, _every_block(scene, crack.balance_position))
            found = lattice_values(run, ["largest_velocity"])[0]
            rows = readings.assign(
                part="stress", release=release, damping_ratio=ratio, dx=dx, left=profile.left, width=profile.width,
                exact=crack.peak_velocity, correction=found - crack.peak_velocity,
                pull=(found - readings["drawn"]) / readings["reading_error"],
            )  # fmt: skip
            parts.append(rows)
    return pd.concat(parts)


def _arrows(settings: Mapping, best: Mapping) -> Iterator[dict]:
    """Where the drawn arrows end; they have no reading error and do not enter the fit."""
    tau0, gamma, drawn = best["tau0"], best["gamma"], settings["arrows"]
    rupture = Rupture(Prestress(tau0, tau0), gamma, best["damping_ratio"], best["release"], settings["end"])
    time, length = paper_transition_displacement(tau0, gamma)
    left, right = rupture.fronts_at(drawn["time"])
    profile = Prestress(settings["stress"]["left"], 0.0, settings["stress"]["width"])
    crack = ArrestingCrack(profile, best["damping_ratio"], best["release"])
    # The left front never arrives: how much of its way it has made at the arrow.
    late = drawn["stress_time"]
    share = root_between(lambda s: crack.share_time(s) - late, 0.5, 0.999, xtol=1e-9)
    for name, shown, estimate, exact in (
        ("time", drawn["time"], time, rupture.transition_time),
        ("length", drawn["length"], length, rupture.transition_length),
        ("length_at_drawn_time", drawn["length"], np.nan, right - left),
        ("stress_time", late, -crack.balance_position, np.nan),
        ("stress_share", 1.0, np.nan, share),
    ):
        yield {"part": "arrow", "reading": name, "drawn": shown, "paper": estimate, "exact": exact}
