"""Names that earlier versions had, and error messages that name their replacements.

A message is kept for one version after its name was removed. CHANGELOG.md lists the names.
"""

from typing import TYPE_CHECKING

# For each class or module, the removed names and their replacements.
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


def describe_removal(owner: str, name: str) -> str:
    """Return a line with the replacement of a removed name; empty text for any other name."""
    replacement = REMOVED.get(owner, {}).get(name, "")
    return f"{owner}: {name} was removed; write {replacement}" if replacement else ""


def refuse_removed_argument(owner: str, name: str) -> None:
    """Raise TypeError with the replacement if an argument was removed."""
    if message := describe_removal(owner, name):
        raise TypeError(message)


class ExplainsRemovedNames:
    """Base of classes whose removed attributes raise an error that names the replacement."""

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            """Raise AttributeError. Python calls this only for an attribute that does not exist."""
            owner = type(self).__name__
            default = f"{owner!r} object has no attribute {name!r}"
            raise AttributeError(describe_removal(owner, name) or default, name=name, obj=self)
