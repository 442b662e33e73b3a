"""Check that each figure can draw at least one run of each of its simulations.

A user may have altered a simulation so that it no longer suits its figure. The module of a figure
therefore has a constant DRAWS, with a condition on the runs of each simulation. The conditions are
checked before anything runs.
"""

from collections.abc import Callable, Mapping

from slippulse.model.run import Run

from .resolve import accuracy_of, all_simulations, resolve
from .runs import runs
from .schema import Configuration


def _forms_pulse(run: Run) -> bool:
    """Return True if the displacement is held, and a pulse forms in positive pre-stress."""
    highest = max(run.prestress.left, run.prestress.right)
    return run.boundary == "displacement" and highest > 0.0


def _has_equal_levels(run: Run) -> bool:
    """Return True if a pulse forms, and the pre-stress is the same on both sides."""
    return _forms_pulse(run) and run.prestress.left == run.prestress.right


def _has_negative_left_level(run: Run) -> bool:
    """Return True if the stress is held, the left level is negative and the right level is 0.

    The pre-stress must not have steps. Such a run has a balance position, which the paper's
    estimate of the transition needs.
    """
    profile = run.prestress
    has_levels = profile.left < 0.0 and profile.right == 0.0 and not profile.steps
    return run.boundary == "stress" and has_levels


# Conditions on a run, by the texts that stand for them in the DRAWS of figures.
CONDITIONS: dict[str, Callable[[Run], bool]] = {
    "`boundary: displacement`": lambda run: run.boundary == "displacement",
    "`boundary: displacement` and a level > 0": _forms_pulse,
    "`boundary: displacement` and equal levels > 0": _has_equal_levels,
    "`boundary: stress`": lambda run: run.boundary == "stress",
    "`boundary: stress`, left level < 0, right level 0, no steps": _has_negative_left_level,
}


def drawing_problems(config: Configuration, draws: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return a line for each simulation of a figure if the figure can draw none of its runs.

    ``draws`` has the simulations of each figure, and for each of these the condition that one of
    its runs must meet, in the words of CONDITIONS.
    """
    accuracy, simulations = accuracy_of(config), all_simulations(config)
    problems = []
    for figure, conditions in draws.items():
        for name, condition in conditions.items():
            sweep = resolve(simulations[name], config.model, accuracy)
            is_drawable = CONDITIONS[condition]
            if not any(is_drawable(run) for run in runs(sweep)):
                problem = f"simulations.{name}: no run that {figure} can draw"
                allowed = (
                    f"at least one run with {condition}; put other runs into a simulation with "
                    f"another name"
                )
                problems.append(f"{problem}; allowed: {allowed}")
    return problems
