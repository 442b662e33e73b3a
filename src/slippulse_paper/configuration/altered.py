"""Short notes on how a configuration differs from the shipped one.

Figures and pages carry a note that names the altered parameters of the simulations that they show.
"""

from collections.abc import Iterable, Mapping
from itertools import chain
from typing import Any

from ..records.provenance import changes
from .resolve import all_simulations, resolve
from .schema import Configuration

# Symbols of the paper, and of this project, for the keys that have one.
SYMBOLS = {"damping_ratio": "b", "left": "tau_l", "right": "tau_r", "width": "W"}
MAX_NAMED_DIFFERENCES = 4


class Alterations:
    """Differences between a configuration and the shipped one, for each resolved simulation.

    ``simulations`` has the list of changes, as `changes` returns them, for each simulation.
    """

    def __init__(self, shipped: Configuration, altered: Configuration) -> None:
        self.shipped, self.altered = shipped, altered
        self.simulations = {}
        self._altered_simulations = all_simulations(altered)
        shipped_simulations = all_simulations(shipped)
        for name, simulation in self._altered_simulations.items():
            # A simulation that is not shipped is compared with itself under the shipped model.
            shipped_one = shipped_simulations.get(name, simulation)
            before = resolve(shipped_one, shipped.model, {})
            after = resolve(simulation, altered.model, {})
            # The extent of samples follows from other keys, and beta replaces the damping ratio.
            derived = ("samples.extent", "damping_ratio" if "beta" in after else "")
            differences = changes(before, after)
            own_differences = [change for change in differences if change["key"] not in derived]
            self.simulations[name] = own_differences

    def note(self, simulations: Iterable[str], keys: Iterable[str]) -> str:
        """Return one line on the differences in some simulations and below some keys.

        An example is 'altered: b = 0.05'. The text is empty if nothing differs.
        """
        all_changes = changes(self.shipped.given(), self.altered.given())
        relevant_keys = tuple(keys)
        of_keys = [change for change in all_changes if change["key"].startswith(relevant_keys)]
        of_simulations = chain.from_iterable(self.simulations.get(name, ()) for name in simulations)
        differences = [*dict.fromkeys(map(_equation, [*of_simulations, *of_keys]))]
        named = differences[:MAX_NAMED_DIFFERENCES]
        if len(differences) > MAX_NAMED_DIFFERENCES:
            named.append(f"{len(differences) - MAX_NAMED_DIFFERENCES} more")
        return f"altered: {', '.join(named)}" if named else ""

    def overridden_defaults(self) -> list[str]:
        """Return a line for each altered default of the model that some simulations override."""
        lines = []
        for change in changes(self.shipped.model.plain(), self.altered.model.plain()):
            key = change["key"]
            overriding_keys = {key, "beta"} if key == "damping_ratio" else {key}
            overriding = [
                name
                for name, simulation in self._altered_simulations.items()
                if overriding_keys & {*simulation.plain()}
            ]
            if overriding:
                lines.append(
                    f"model.{key} = {change['here']} is only a default; these simulations set their"
                    f" own value: {', '.join(overriding)}"
                )
        return lines


def _equation(change: Mapping[str, Any]) -> str:
    """Return a change as an equation, such as 'b = 0.05'."""
    name, value = change["key"].rpartition(".")[2], change["here"]
    if isinstance(value, list) and value and not isinstance(value[0], list | dict):
        value = ", ".join(map(str, value))
    elif isinstance(value, list | dict):
        value = "other values"
    return f"{SYMBOLS.get(name, name)} = {'absent' if value is None else value}"
