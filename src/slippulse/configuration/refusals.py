"""What the definition of the keys refuses, and names that refer to nothing, in lines that a reader can act on."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from ..measure.quantities import QUANTITIES
from ..model.checks import nearest, short_repr
from .keys import Allowed, Name, allowed_text
from .schema import Configuration

# Lines of a refusal; a reader mends a few at a time.
LINES = 20
WORDS = {dict: "a mapping", list: "a list", str: "text"}


def format_problems(problems: Sequence[str]) -> str:
    """The first problems, one a line, and how many more there are."""
    rest = [f"... and {len(problems) - LINES} more"] if len(problems) > LINES else []
    return "\n".join([*problems[:LINES], *rest])


def schema_problems(
    config: Mapping, shipped: Mapping | None = None, removed: Sequence[tuple[str, ...]] = ()
) -> list[str]:
    """One line for each key that the definition of the configuration refuses.

    Parameters
    ----------
    config : the configuration, builtins
    shipped : the configuration without overlays, for hints at misspelt names
    removed : places of the nulls that were taken out
    """
    try:
        Configuration.model_validate(config)
    except ValidationError as error:
        # Errors inside of an alternative, as 'same' or a list, are one line about the key.
        return sorted(
            {_describe(problem, config, shipped, removed) for problem in error.errors(include_url=False)}
        )
    return []


def _describe(problem: Mapping, config: Mapping, shipped: Mapping | None, removed: Sequence) -> str:
    """One line about one error of pydantic."""
    kind, place = problem["type"], problem["loc"]
    if kind == "missing":
        hint = " (null removes a key)" if place in removed else _misspelt_parent(place[:-1], shipped)
        presets = config.get("presets") if place == ("preset",) else None
        names = f"; allowed: {', '.join(map(str, presets))}" if isinstance(presets, Mapping) else ""
        return f"{dotted(place)}: missing; it is required{hint}{names}"
    walked = list(_walk(place))
    depth, _, allowed = walked[-1]
    if kind == "extra_forbidden":
        known = _keys_of(walked[len(place) - 1][1])
        return f"{dotted(place)}: unknown key{nearest(place[-1], known)}; allowed: {', '.join(known)}"
    if place[-1] == "[key]":
        return f"{dotted(place[:-2])}: {short_repr(place[-2])}; allowed: {allowed_text(Name)}"
    value = config
    for part in place[:depth]:
        value = value[part]
    if isinstance(value, Mapping) and kind == "one_unit":
        value = list(value)
    if kind == "finite_number":
        allowed = "a finite number"
    return f"{dotted(place[:depth])}: {short_repr(value)}; allowed: {allowed}{remedy(value)}"


def _walk(place: Sequence[str | int]) -> Any:
    """Depth, type and what is allowed at each part of a place, as far as there is one type for it."""
    annotation: Any = Configuration
    allowed = WORDS[dict]
    yield 0, annotation, allowed
    for depth, part in enumerate(place, start=1):
        kind = get_origin(annotation)
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            fields = {field.alias or name: field for name, field in annotation.model_fields.items()}
            if part not in fields:
                return
            annotation, marks = fields[part].annotation, fields[part].metadata
        elif kind in (dict, list):
            annotation, marks = get_args(annotation)[-1], []
        else:
            return
        if get_origin(annotation) is Annotated:
            annotation, *more = get_args(annotation)
            marks = [*marks, *more]
        texts = [mark.text for mark in marks if isinstance(mark, Allowed)]
        allowed = texts[-1] if texts else words_of(annotation)
        yield depth, annotation, allowed
        if get_origin(annotation) in (Union, UnionType, Literal):
            return


def words_of(annotation: Any) -> str:
    """What a type allows that has no words of its own."""
    kind = get_origin(annotation) or annotation
    return (
        WORDS[dict]
        if isinstance(kind, type) and issubclass(kind, BaseModel)
        else WORDS.get(kind, "another value")
    )


def _keys_of(annotation: Any) -> list[str]:
    return [field.alias or name for name, field in annotation.model_fields.items()]


def dotted(place: Sequence[str | int]) -> str:
    """A key as a refusal names it."""
    words = (
        str(part) if re.fullmatch(r"\w{1,80}", str(part), re.ASCII) else short_repr(part) for part in place
    )
    return ".".join(words) or "the configuration"


def remedy(value: object) -> str:
    """What to write instead of text that was meant as a number or a switch."""
    if not isinstance(value, str):
        return ""
    text = value.strip()
    if re.fullmatch(r"[-+]?\d+[eE][-+]?\d+", text, re.ASCII):
        mantissa, exponent = re.split("[eE]", text)
        return f" (YAML reads {text} as text: write {mantissa}.0e{exponent})"
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text, re.ASCII):
        return " (text: write the number without quotes, with a point and a signed exponent)"
    if re.fullmatch(r"[-+]?\d+,\d+", text, re.ASCII):
        return f" (write {text.replace(',', '.')}, with a point)"
    return ""


def _misspelt_parent(path: Sequence[str | int], shipped: Mapping | None) -> str:
    """A hint where an incomplete new entry stands beside one of nearly the same name."""
    parent: Any = shipped
    for part in path[:-1]:
        parent = parent.get(part) if isinstance(parent, Mapping) else None
    if not path or not isinstance(parent, Mapping) or path[-1] in parent:
        return ""
    return nearest(path[-1], parent)


def removal_problems(removed: Sequence[tuple[str, ...]], shipped: Mapping) -> list[str]:
    """One line for each null that removes what there is not, or what the paper is made from.

    Parameters
    ----------
    removed : places of the nulls
    shipped : the configuration without overlays
    """
    problems = []
    for place in removed:
        walked = list(_walk(place))
        depth, annotation, _ = walked[-1]
        names = shipped.get(place[0], {}) if len(place) == 2 and get_origin(walked[1][1]) is dict else None
        key = dotted(place)
        if depth < len(place):
            known = _keys_of(annotation) if hasattr(annotation, "model_fields") else ()
            problems.append(f"{key}: null{nearest(place[-1], known)}; allowed: null for a key that there is")
        elif names is not None and place[1] not in names:
            problems.append(f"{key}: null{nearest(place[1], names)}; allowed: null for a name that there is")
        elif names is not None and place[0] == "simulations":
            problems.append(
                f"{key}: null; allowed: what is shipped stays, since figures and verdicts need it"
            )
    return problems


def name_problems(config: Mapping, shipped: Mapping | None) -> list[str]:
    """Names that refer to nothing: a preset, what stands behind a published reading, a claim nobody computes."""
    lines = []
    if config["preset"] not in config["presets"]:
        hint = nearest(config["preset"], config["presets"])
        lines.append(f"preset: {short_repr(config['preset'])}{hint}; allowed: {', '.join(config['presets'])}")
    for name in config.get("scenes", {}):
        if name in config["simulations"]:
            lines.append(f"scenes.{name}: also the name of a simulation; allowed: a name of its own")
        if name == "index" or (
            name.endswith("_numbers") and name.removesuffix("_numbers") in config["scenes"]
        ):
            lines.append(
                f"scenes.{name}: results/scenes has another file of that name; allowed: neither index nor SCENE_numbers"
            )
    for name, entry in config["published"].items():
        lines += _reading_problems(f"published.{name}", entry, config)
    return lines + _study_problems(config)


def _study_problems(config: Mapping) -> list[str]:
    """Numbers of figures and studies that do not go together."""
    lines = []
    figures, studies = config["figures"], config["studies"]
    trade, published = studies["accuracy_cost"], studies["published_figure"]
    for key, steps in (
        ("figures.fig07_damage_zone.stiffness_ratios", figures["fig07_damage_zone"]["stiffness_ratios"]),
        ("studies.accuracy_cost.locking.steps", trade["locking"]["steps"]),
    ):
        if steps["to"] <= steps["from"]:
            lines.append(f"{key}.to: {steps['to']}; allowed: > from = {steps['from']}")
    lower, upper = studies["stability"]["between"]
    if upper <= lower:
        lines.append(f"studies.stability.between: {[lower, upper]}; allowed: two increasing numbers > 0")
    presets = [preset["dx"] for preset in config["presets"].values()]
    largest = 1.0 / max(*trade["dx"], *trade["textbook"]["dx"], *presets)
    if trade["stress_scale"] > largest:
        lines.append(
            f"studies.accuracy_cost.stress_scale: {trade['stress_scale']}; allowed: up to {largest:.4g}, 1 over the"
            " largest dx there and of the presets"
        )
    ratios = [*published["stress"]["damping_ratios"], *published["damping_ratios"]["total"]]
    least = min(*ratios, *published["damping_ratios"]["elastic"])
    if published["beta"] > least:
        lines.append(
            f"studies.published_figure.beta: {published['beta']}; allowed: up to the smallest of its damping ratios,"
            f" {least}"
        )
    read = {entry["quantity"] for entry in config["published"].values()}
    times = [time for time in config["measure"]["trailing_times"] if f"trailing_edge_{time:g}" in read]
    if published["end"] <= max(times, default=0.0):
        lines.append(
            f"studies.published_figure.end: {published['end']}; allowed: > {max(times):g}, when the trailing edge is"
            " last read off"
        )
    return lines


def _reading_problems(key: str, entry: Mapping, config: Mapping) -> list[str]:
    """What is wrong with the simulation and the quantity of a published reading."""
    simulations = config["simulations"]
    if entry["simulation"] not in simulations:
        hint = nearest(entry["simulation"], simulations)
        value = short_repr(entry["simulation"])
        return [f"{key}.simulation: {value}{hint}; allowed: a name under simulations"]
    edges = {f"trailing_edge_{time:g}": "fronts" for time in config["measure"]["trailing_times"]}
    known = QUANTITIES | edges
    quantity, value = entry["quantity"], short_repr(entry["quantity"])
    if quantity not in known:
        return [f"{key}.quantity: {value}{nearest(quantity, known)}; allowed: a column of the measured table"]
    if known[quantity] not in ("fronts", *simulations[entry["simulation"]]["record"]):
        return [
            f"{key}.quantity: {value}; allowed: what simulations.{entry['simulation']} records;"
            f" this takes record: [fronts, {known[quantity]}]"
        ]
    return []
