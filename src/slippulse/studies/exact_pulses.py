"""Numbers of exact ruptures that no grid study gives: late pulses without damping, and the strain at nucleation."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..measure.shape import FAR
from ..model.scene import Scene
from ..theory.pulse import paper_pulse
from ..theory.rupture import Rupture

NEEDS = {"sweeps": ["space_time_displacement", "steady_displacement", "stress_pulses"]}

# The nucleation reaches this many widths of its Gaussian; a derivative in time by a difference over this, and one in
# space.
BEGINNING, SHORTLY, STEP = 6.0, 1e-4, 1e-3
# Points at which a profile is compared with itself.
POINTS = 41


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """By how much the exact solution differs from the paper, and what refining its panels changes.

    Returns
    -------
    DataFrame of simulation, run, quantity, difference (from the paper's value) and change (when each panel is cut in
    two): pulse_width and pulse_acceleration of pulses that have forgotten their nucleation, profile_change (largest
    change of a profile moved at the wave speed, over the last third of the run; the paper has 0), of runs without
    damping; strain_term (curvature of slip at the nucleation point over the pre-stress there, halfway to the
    transition; the paper neglects it)
    """
    rows = []
    for simulation, quantities in QUANTITIES.items():
        scenes, _ = expand(settings["sweeps"][simulation])
        for run, scene in enumerate(scenes):
            for quantity, (find, applies) in quantities.items():
                if applies(scene):
                    values = [find(scene, refinement) for refinement in (1, 2)]
                    rows.append((simulation, run, quantity, values[0], abs(values[0] - values[1])))
    return pd.DataFrame(rows, columns=["simulation", "run", "quantity", "difference", "change"])


def _symmetric_pulse(scene: Scene) -> bool:
    return scene.beta == 0.0 and 0.0 < scene.prestress.left == scene.prestress.right


def _late(scene: Scene, refinement: int) -> tuple[Rupture, float]:
    """The exact rupture without damping, and a time at which its pulse has forgotten the nucleation."""
    paper = paper_pulse(scene.prestress.left, scene.gamma)
    # The front and the Gaussian behind it, and what the steady pulse remembers.
    time = 2.0 * (BEGINNING * scene.prestress.width + paper.width / (paper.speed - 1.0))
    return Rupture(scene.prestress, scene.gamma, 0.0, scene.release, 1.1 * time, refinement), time


def pulse_width(scene: Scene, refinement: int) -> float:
    """Less the paper's."""
    rupture, time = _late(scene, refinement)
    return rupture.pulse_width(time) - paper_pulse(scene.prestress.left, scene.gamma).width


def pulse_acceleration(scene: Scene, refinement: int) -> float:
    """Amplitude of the sine in the slip acceleration across the pulse, less the paper's."""
    rupture, time = _late(scene, refinement)
    front, width = rupture.fronts_at(time)[1], rupture.pulse_width(time)
    x = front - width * np.linspace(0.1, 0.9, 9)
    late, early = (rupture.slip_velocity(x, time + shift) for shift in (SHORTLY, -SHORTLY))
    sine = np.cos(np.pi * (front - x) / width)
    return float(
        np.sum((late - early) / (2.0 * SHORTLY) * sine) / np.sum(sine**2) - 1.0 / scene.prestress.left
    )


def profile_change(scene: Scene, refinement: int) -> float:
    """Largest change of the velocity profile, moved at the wave speed, over its peak."""
    rupture = Rupture(scene.prestress, 0.0, 0.0, scene.release, scene.duration, refinement)
    moved = scene.duration / 3.0
    x = np.linspace(FAR * scene.prestress.width, scene.duration - moved, POINTS)
    early = rupture.slip_velocity(x, scene.duration - moved)
    late = rupture.slip_velocity(x + moved, scene.duration)
    # Near nucleation the construction may not reach the later time.
    return float(np.nanmax(np.abs(late - early)) / np.nanmax(early))


def strain_term(scene: Scene, refinement: int) -> float:
    """Curvature of slip at x = 0, halfway to the transition, where the pre-stress is 1; NaN without a transition."""
    rupture = Rupture(
        scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration, refinement
    )
    if not np.isfinite(rupture.transition_time):
        return float("nan")
    return float(abs(rupture.strain(np.array([STEP]), 0.5 * rupture.transition_time)[0] / STEP))


# How to compute each, and for which scenes there is one.
QUANTITIES: dict[str, dict[str, tuple[Callable[[Scene, int], float], Callable[[Scene], bool]]]] = {
    "steady_displacement": {
        "pulse_width": (pulse_width, _symmetric_pulse),
        "pulse_acceleration": (pulse_acceleration, _symmetric_pulse),
    },
    "stress_pulses": {"profile_change": (profile_change, lambda scene: scene.beta == 0.0)},
    "space_time_displacement": {"strain_term": (strain_term, lambda scene: scene.gamma > 0.0)},
}
