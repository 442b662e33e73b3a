"""Short notes on how a configuration differs from the shipped one.

Figures and pages carry a note that names the altered parameters of the simulations that they show.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from ..records.provenance import changes
from .resolve import all_simulations, resolve
from .schema import Configuration, Simulation

# Symbols of the paper, and of this project, for the keys that have one.
SYMBOLS = {"damping_ratio": "b", "left": "tau_l", "right": "tau_r", "width": "W"}
MAX_NAMED_DIFFERENCES = 4


class Alterations:
    """Differences between a configuration and the shipped one, for each resolved simulation.

    ``changes_of`` has the list of changes of each simulation, by name. The entries of such a list
    are those of `provenance.changes`: each has a dotted ``key``, the ``shipped`` value, and the
    altered value (``here``).
    """

    def __init__(self, shipped: Configuration, altered: Configuration) -> None:
        """Find the changes of each simulation, except those that have no influence of their own."""
        self.shipped, self.altered = shipped, altered
        self.changes_of = {}
        # In these simulations a key without a value of its own is None. Only `resolve` inserts the
        # defaults of the model.
        self._unresolved_simulations = all_simulations(altered)
        shipped_simulations = all_simulations(shipped)
        for name, simulation in self._unresolved_simulations.items():
            # A simulation that is not shipped is compared with itself under the shipped model.
            shipped_simulation = shipped_simulations.get(name, simulation)
            # Presets are not compared, and so no accuracy is given.
            before = resolve(shipped_simulation, shipped.model, accuracy={})
            after = resolve(simulation, altered.model, accuracy={})
            # This key follows from others, whose changes are listed.
            omitted_keys = {"samples.extent"}
            if "beta" in after:
                # A simulation with beta does not use the damping ratio.
                omitted_keys.add("damping_ratio")
            all_changes = changes(before, after)
            self.changes_of[name] = [
                change for change in all_changes if change["key"] not in omitted_keys
            ]

    def note(self, simulations: Iterable[str], keys: Iterable[str]) -> str:
        """Return one line that names altered parameters, such as 'altered: b = 0.05'.

        The line is empty if nothing is altered.

        simulations : names of simulations whose parameters count
        keys : beginnings of dotted keys of the configuration whose values count
        """
        relevant_changes: list[Mapping[str, Any]] = []
        for name in simulations:
            relevant_changes += self.changes_of.get(name, [])
        beginnings = tuple(keys)
        for change in changes(self.shipped.given(), self.altered.given()):
            if change["key"].startswith(beginnings):
                relevant_changes.append(change)
        # Several simulations may have the same change, which is named once.
        equations = [*dict.fromkeys(map(_equation, relevant_changes))]
        named = equations[:MAX_NAMED_DIFFERENCES]
        if len(equations) > MAX_NAMED_DIFFERENCES:
            named.append(f"{len(equations) - MAX_NAMED_DIFFERENCES} more")
        return f"altered: {', '.join(named)}" if named else ""

    def overridden_defaults(self) -> list[str]:
        """Return a warning for each altered default of the model that some simulations override."""
        lines = []
        for change in changes(self.shipped.model.plain(), self.altered.model.plain()):
            key = change["key"]
            overriding = [
                name
                for name, simulation in self._unresolved_simulations.items()
                if _overrides_default(simulation, key)
            ]
            if overriding:
                lines.append(
                    f"model.{key} = {change['here']} is only a default; these simulations set their"
                    f" own value: {', '.join(overriding)}"
                )
        return lines


def _overrides_default(simulation: Simulation, key: str) -> bool:
    """Return True if an unresolved simulation does not use the model's default for a key.

    In such a simulation a key without a value of its own is None.
    """
    # A simulation with its own beta does not use the default damping ratio either.
    own_keys = ("damping_ratio", "beta") if key == "damping_ratio" else (key,)
    return any(getattr(simulation, own_key, None) is not None for own_key in own_keys)


def _equation(change: Mapping[str, Any]) -> str:
    """Return a change as an equation, such as 'b = 0.05'."""
    # The last part of the dotted key.
    name = change["key"].rpartition(".")[2]
    return f"{SYMBOLS.get(name, name)} = {_value_text(change['here'])}"


def _value_text(value: Any) -> str:
    """Return a value of the configuration as text.

    The text is 'absent' for None, and 'other values' for a nested or an empty value.
    """
    if value is None:
        return "absent"
    if not isinstance(value, list | dict):
        return str(value)
    is_plain_list = isinstance(value, list) and value and not isinstance(value[0], list | dict)
    return ", ".join(map(str, value)) if is_plain_list else "other values"
