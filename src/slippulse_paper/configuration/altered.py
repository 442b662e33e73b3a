"""Differences of single simulations and figures from the shipped configuration, in words."""

from collections.abc import Iterable, Mapping
from itertools import chain
from typing import Any

from ..records.provenance import changes
from .resolve import all_simulations, resolve
from .schema import Configuration

# Symbols of the paper, and of this project, for keys that have one.
SYMBOLS = {"damping_ratio": "b", "left": "tau_l", "right": "tau_r", "width": "W"}
# A note names this number of differences.
MOST = 4


class Alterations:
    """Differences of a configuration from the shipped one, for each simulation as it is run."""

    def __init__(self, shipped: Configuration, here: Configuration) -> None:
        self.shipped, self.here = shipped, here
        self.simulations, self._runs = {}, all_simulations(here)
        before = all_simulations(shipped)
        for name, simulation in self._runs.items():
            # An added one is compared under the shipped model.
            old = resolve(before.get(name, simulation), shipped.model, {})
            new = resolve(simulation, here.model, {})
            # The extent of samples follows from the rest, and beta replaces the ratio.
            derived = ("samples.extent", "damping_ratio" if "beta" in new else "")
            altered = [change for change in changes(old, new) if change["key"] not in derived]
            self.simulations[name] = altered

    def note(self, simulations: Iterable[str], keys: Iterable[str]) -> str:
        """One line on what differs, such as 'altered: b = 0.05'; empty where nothing does."""
        given, used = changes(self.shipped.given(), self.here.given()), tuple(keys)
        altered = [change for change in given if change["key"].startswith(used)]
        of_runs = chain.from_iterable(self.simulations.get(name, ()) for name in simulations)
        different = [*dict.fromkeys(map(_equation, [*of_runs, *altered]))]
        named = different[:MOST]
        if different[MOST:]:
            named.append(f"{len(different) - MOST} more")
        return f"altered: {', '.join(named)}" if named else ""

    def overridden_defaults(self) -> list[str]:
        """A line for each altered default of the model that some simulations do not take."""
        lines = []
        for change in changes(self.shipped.model.plain(), self.here.model.plain()):
            key = change["key"]
            alone = {key, "beta"} if key == "damping_ratio" else {key}
            givers = [name for name, run in self._runs.items() if alone & {*run.plain()}]
            if givers:
                lines.append(
                    f"model.{key} = {change['here']} is a default; simulations that give {key}"
                    f" themselves do not take it: {', '.join(givers)}"
                )
        return lines


def _equation(change: Mapping[str, Any]) -> str:
    name, value = change["key"].rpartition(".")[2], change["here"]
    if isinstance(value, list) and value and not isinstance(value[0], list | dict):
        value = ", ".join(map(str, value))
    elif isinstance(value, list | dict):
        value = "other values"
    return f"{SYMBOLS.get(name, name)} = {'absent' if value is None else value}"
