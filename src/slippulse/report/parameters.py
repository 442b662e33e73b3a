"""The parameters of a simulation in words, for the caption of the figure that draws it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ..data.numerals import setting

# Of more values than this only the ends are named.
FEW = 3


def parameters(config: Mapping, name: str) -> str:
    """Boundary, elasticity ratio, pre-stress and damping of all runs of one of its simulations, as Markdown.

    Raises
    ------
    ValueError
        Naming the simulation and those that there are.
    """
    if name not in config["simulations"]:
        raise ValueError(f"simulation: {name!r}; allowed: {', '.join(config['simulations'])}")
    simulation = config["simulations"][name]
    profiles = simulation.get("profiles") or [simulation]
    left, right, width = (_flat(each.get(key) for each in profiles) for key in ("left", "right", "width"))
    springs = simulation["boundary"] == "displacement"
    parts = [r"$\Gamma=1$" if springs else r"$\Gamma=0$"]
    if springs:
        parts.append(rf"$\gamma$ = {_listed(simulation['gamma'])}")
    if right == ["same"]:
        parts.append(rf"$\tau_0$ = {_listed(left)}")
    else:
        parts += [rf"$\tau_{{0,l}}$ = {_listed(left)}", rf"$\tau_{{0,r}}$ = {_listed(right)}"]
    if "beyond" in simulation:
        parts.append(rf"then $\tau$ = {_listed(simulation['beyond']['levels'])}")
    if width:
        parts.append(f"$W$ = {_listed(width)}")
    if "beta" in simulation:
        return ", ".join([*parts, rf"$\beta$ = {_listed(simulation['beta'])}"])
    ratios = simulation.get("damping_ratio") or [config["model"]["damping_ratio"]]
    return ", ".join([*parts, f"$b$ = {_listed(ratios)}"])


def _flat(values: Iterable) -> list:
    """All values, each once, of entries that are lists, single values or missing."""
    lists = (entry if isinstance(entry, list) else [entry] for entry in values)
    return [*dict.fromkeys(value for entry in lists for value in entry if value is not None)]


def _listed(values: Sequence[float]) -> str:
    if len(values) > FEW:
        return f"{setting(min(values))} to {setting(max(values))}"
    *first, last = (setting(value) for value in sorted(values))
    return f"{', '.join(first)} and {last}" if first else last
