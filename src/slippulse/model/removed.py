"""Names that earlier versions had: each answers with what to write instead.

The answers are kept for one version after the name is gone. CHANGELOG.md lists them.
"""

from typing import TYPE_CHECKING

# Owner, removed name, and the new way.
REMOVED = {
    "Scene": {"rate_strengthening": 'friction=sp.friction("linear_rate", alpha=...)'},
    "Prestress": {
        "integral": "slippulse.model.balance.integral(prestress, lower, upper)",
    },
    "Rupture": {
        "transition_time": "transition.time",
        "transition_length": "transition.length",
    },
    "ArrestingCrack": {
        "time_at_fraction": "transition(fraction).time",
        "length_at_fraction": "transition(fraction).length",
    },
    "theory": {
        "Fronts": "Rupture",
        "slip_velocity": "Rupture(...).slip_velocity(x, time)",
        "steady_front": "weakening_pulse or rate_pulse",
        "SteadyFront": "SteadyRupture",
    },
}


def new_way(owner: str, name: str) -> str:
    """Return one line with the new way of a removed name; empty if the name is none."""
    instead = REMOVED.get(owner, {}).get(name, "")
    return f"{owner}: {name} was removed; write {instead}" if instead else ""


def answer_removed(owner: str, name: str) -> None:
    """Raise TypeError with the new way if an argument was removed."""
    if answer := new_way(owner, name):
        raise TypeError(answer)


class AnswersRemoved:
    """A class whose removed attributes answer with the new way."""

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            """Raise AttributeError; only called for an attribute that there is not."""
            owner = type(self).__name__
            default = f"{owner!r} object has no attribute {name!r}"
            raise AttributeError(new_way(owner, name) or default, name=name, obj=self)
