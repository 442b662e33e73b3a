"""Refusal of altered simulations of which a figure cannot draw a single run.

The module of a figure lists in DRAWS what it needs of each of its simulations. That is checked
before anything runs.
"""

from collections.abc import Callable, Mapping

from slippulse.model.run import Run

from .resolve import accuracy_of, all_simulations, resolve
from .runs import runs
from .schema import Configuration


def _is_pulse(run: Run) -> bool:
    highest = max(run.prestress.left, run.prestress.right)
    return run.boundary == "displacement" and highest > 0.0


def _has_equal_levels(run: Run) -> bool:
    return _is_pulse(run) and run.prestress.left == run.prestress.right


def _is_balanced(run: Run) -> bool:
    profile = run.prestress
    return run.boundary == "stress" and profile.left < 0.0 == profile.right and not profile.steps


# Conditions on a run, by the words that the DRAWS of figures use for them.
CONDITIONS: dict[str, Callable[[Run], bool]] = {
    "boundary displacement": lambda run: run.boundary == "displacement",
    "boundary displacement and a level above 0": _is_pulse,
    "boundary displacement and equal levels above 0": _has_equal_levels,
    "boundary stress": lambda run: run.boundary == "stress",
    "boundary stress, left level below 0, right level 0 and no steps": _is_balanced,
}


def drawing_problems(config: Configuration, draws: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return a line for each simulation that has no run which a figure can draw.

    ``draws`` has the DRAWS of each figure: a condition for each of its simulations.
    """
    accuracy, simulations = accuracy_of(config), all_simulations(config)
    problems: dict[str, None] = {}
    for figure, needs in draws.items():
        for name, condition in needs.items():
            sweep = resolve(simulations[name], config.model, accuracy)
            if not any(map(CONDITIONS[condition], runs(sweep))):
                allowed = f"at least one run with {condition}; or another name for the simulation"
                given = f"simulations.{name}: no run that {figure} can draw"
                problems[f"{given}; allowed: {allowed}"] = None
    return [*problems]
