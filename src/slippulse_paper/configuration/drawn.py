"""Refuse altered simulations that have no run which a figure can draw.

The module of a figure lists in DRAWS what it needs of each of its simulations. That is checked
before anything runs.
"""

from collections.abc import Callable, Mapping

from slippulse.model.run import Run

from .resolve import accuracy_of, all_simulations, resolve
from .runs import runs
from .schema import Configuration


def _is_pulse(run: Run) -> bool:
    """Return True if the displacement is held and a level is above 0."""
    highest = max(run.prestress.left, run.prestress.right)
    return run.boundary == "displacement" and highest > 0.0


def _has_equal_levels(run: Run) -> bool:
    """Return True for a pulse on equal levels."""
    return _is_pulse(run) and run.prestress.left == run.prestress.right


def _has_negative_left_level(run: Run) -> bool:
    """Return True if the stress is held, and the levels are negative on the left, 0 on the right.

    Such a run has a balance position, which the paper's estimate of the transition needs.
    """
    profile = run.prestress
    has_levels = profile.left < 0.0 and profile.right == 0.0 and not profile.steps
    return run.boundary == "stress" and has_levels


# Conditions on a run, by the words that the DRAWS of figures use for them.
CONDITIONS: dict[str, Callable[[Run], bool]] = {
    "boundary displacement": lambda run: run.boundary == "displacement",
    "boundary displacement and a level above 0": _is_pulse,
    "boundary displacement and equal levels above 0": _has_equal_levels,
    "boundary stress": lambda run: run.boundary == "stress",
    "boundary stress, left level below 0, right level 0 and no steps": _has_negative_left_level,
}


def drawing_problems(config: Configuration, draws: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return a line for each simulation that has no run which a figure can draw.

    ``draws`` has the DRAWS of each figure: a condition for each of its simulations.
    """
    accuracy, simulations = accuracy_of(config), all_simulations(config)
    problems = []
    for figure, conditions in draws.items():
        for name, condition in conditions.items():
            sweep = resolve(simulations[name], config.model, accuracy)
            is_drawable = CONDITIONS[condition]
            if not any(is_drawable(run) for run in runs(sweep)):
                problem = f"simulations.{name}: no run that {figure} can draw"
                allowed = f"at least one run with {condition}; other runs need another name"
                problems.append(f"{problem}; allowed: {allowed}")
    return problems
