"""What a schema cannot say about a configuration: names, sizes, resolution. Each function refuses one kind."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..data.chunks import runs_of
from ..model.checks import ConfigError, nearest, shown
from ..model.samples import Samples
from ..model.scene import Scene
from ..theory.front_law import STRONGEST_DAMPING, front_speed
from ..theory.pulse import steady_pulse
from .cost import HOW_TO_GO_ON, LARGEST_RUNS, LARGEST_WHOLE, expected_cost, too_large

# Lists of a simulation block whose product its runs are.
AXES = ("left", "right", "width", "profiles", "gamma", "damping_ratio", "beta", "dx", "release")
# Below this share of resolved_blocks in every run a block of scenes says nothing about the continuum.
HARDLY_RESOLVED = 0.5
# Lines of a refusal; a reader mends a few at a time.
LINES = 20


def some(problems: Sequence[str]) -> str:
    """The first problems, one a line, and how many more there are."""
    rest = [f"... and {len(problems) - LINES} more"] if len(problems) > LINES else []
    return "\n".join([*problems[:LINES], *rest])


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


def not_finite(value: object, key: str = "") -> list[str]:
    """One line for each infinity or NaN, which pass every bound of a schema."""
    if isinstance(value, Mapping):
        return [
            line for name, entry in value.items() for line in not_finite(entry, f"{key}.{name}".lstrip("."))
        ]
    if isinstance(value, list):
        return [line for index, entry in enumerate(value) for line in not_finite(entry, f"{key}.{index}")]
    if isinstance(value, float) and not math.isfinite(value):
        return [f"{key}: {value}; allowed: a finite number"]
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) > 1e300:
        return [f"{key}: {shown(value)}; allowed: a number below 1e300"]
    return []


def misspelt_parent(path: Sequence[str], shipped: Mapping | None) -> str:
    """A hint where an incomplete new entry stands beside one of nearly the same name."""
    parent = shipped
    for part in path[:-1]:
        parent = parent.get(part) if isinstance(parent, Mapping) else None
    if not path or not isinstance(parent, Mapping) or path[-1] in parent:
        return ""
    return nearest(path[-1], parent)


def unknown_names(config: Mapping, shipped: Mapping | None) -> list[str]:
    """Names that refer to nothing: the preset, the simulation behind a published reading, a claim nobody computes."""
    lines = []
    if config["preset"] not in config["presets"]:
        hint = nearest(config["preset"], config["presets"])
        lines.append(f"preset: {shown(config['preset'])}{hint}; allowed: {', '.join(config['presets'])}")
    for name, entry in config["published"].items():
        if entry["simulation"] not in config["simulations"]:
            hint = nearest(entry["simulation"], config["simulations"])
            lines.append(
                f"published.{name}.simulation: {shown(entry['simulation'])}{hint}; allowed: a name under simulations"
            )
        if f"published_{name}" not in config["claims"]:
            lines.append(f"claims.published_{name}: missing; it is required by published.{name}")
    if shipped is not None:
        known = {*shipped["claims"], *(f"published_{name}" for name in config["published"])}
        for name in config["claims"]:
            if name not in known:
                lines.append(
                    f"claims.{name}: unknown claim{nearest(name, known)}; allowed: the names in config/config.yaml"
                )
    ratios = config["figures"]["fig07_damage_zone"]["stiffness_ratios"]
    if ratios["to"] <= ratios["from"]:
        lines.append(
            f"figures.fig07_damage_zone.stiffness_ratios.to: {ratios['to']}; allowed: > from = {ratios['from']}"
        )
    return lines


def check_targets(arguments: Sequence[str], made: Callable[[str], bool], known: Sequence[str]) -> None:
    """Refuse a file under results/ that no rule makes.

    Parameters
    ----------
    arguments : of the command line; what does not start with results/ is not looked at
    made : whether a rule makes a file
    known : files to suggest

    Raises
    ------
    ConfigError
        Naming the target and the one that was probably meant.
    """
    for argument in arguments:
        if argument.startswith("results/") and not made(argument):
            raise ConfigError(
                f"target: {shown(argument)}{nearest(argument, known)}; allowed: a file that a rule makes"
                " (snakemake --summary lists them)"
            )


def check_folder(path: Path) -> None:
    """Refuse a place for results in which nothing can be written.

    Raises
    ------
    ConfigError
        Naming the folder.
    """
    nearest_there = path if path.exists() else path.absolute().parent
    if path.exists() and not path.is_dir():
        raise ConfigError(f"{path}: a file; allowed: a folder that can be written, or nothing of that name")
    if not os.access(nearest_there, os.W_OK | os.X_OK):
        raise ConfigError(f"{path}: may not be written by this user; allowed: a folder that can be written")


def runs(block: Mapping) -> int:
    """How many runs a block is the product of."""
    lengths = [len(block[axis]) for axis in AXES if isinstance(block.get(axis), list)]
    return math.prod(lengths) * len(block.get("beyond", {"levels": [0]})["levels"])


def counted(block: Mapping, chunks: int = 1) -> Mapping:
    """The block itself, refused before its scenes are built where it has too many for so many chunks.

    Raises
    ------
    ValueError
        Naming the number of runs.
    """
    allowed = min(chunks, LARGEST_WHOLE) * LARGEST_RUNS
    if runs(block) > allowed:
        axes = ", ".join(f"{axis} {len(block[axis])}" for axis in AXES if isinstance(block.get(axis), list))
        dealt = "" if chunks == 1 else f" in {chunks} chunks"
        raise ValueError(
            f"runs: {runs(block)} ({axes}); allowed: up to {allowed} runs{dealt} ({HOW_TO_GO_ON})"
        )
    return block


def corners(block: Mapping) -> dict:
    """A block too large to check run by run: the first and last entry of each list."""
    if runs(block) <= LARGEST_RUNS:
        return dict(block)
    return {
        key: value[:1] + value[1:][-1:] if key in AXES and isinstance(value, list) else value
        for key, value in block.items()
    }


def check_chunks(chunks: int, block: Mapping) -> None:
    """Refuse more chunks than runs.

    Raises
    ------
    ValueError
        Naming both numbers.
    """
    if chunks > runs(block):
        raise ValueError(f"chunks: {chunks}; allowed: up to the number of runs, {runs(block)}")


def check_cost(scenes: Sequence[Scene], samples: Sequence[Samples | None], chunks: int = 1) -> None:
    """Refuse scenes that cost more than a night or a small machine's memory, in one of their chunks or altogether.

    Raises
    ------
    ValueError
        With the estimate, what is allowed and how to go on.
    """
    cost = expected_cost(scenes, samples)
    if limit := too_large(cost, LARGEST_WHOLE if chunks > 1 else 1):
        raise ValueError(f"cost: {cost}; allowed: {limit} ({HOW_TO_GO_ON})")
    if chunks == 1 or not too_large(cost):
        return
    for number in range(1, chunks + 1):
        dealt = list(runs_of(number, chunks, len(scenes)))
        cost = expected_cost([scenes[run] for run in dealt], [samples[run] for run in dealt])
        if limit := too_large(cost):
            raise ValueError(
                f"chunks: {chunks}, and chunk {number} costs {cost}; allowed: {limit} a chunk: more chunks"
                f" ({HOW_TO_GO_ON})"
            )


def check_affordable(blocks: Mapping[str, tuple[Sequence[Scene], Sequence[Samples | None]]]) -> None:
    """Refuse blocks of scenes, by key, each of which `check_cost` refuses.

    Raises
    ------
    ConfigError
        One line a block.
    """
    problems = []
    for key, (scenes, samples) in blocks.items():
        try:
            check_cost(scenes, samples)
        except ValueError as error:
            problems.append(f"{key}.{error}")
    if problems:
        raise ConfigError(some(problems))


def check_resolved(scenes: Sequence[Scene]) -> None:
    """Refuse a block in which no run comes near resolving its pulse.

    Runs with fewer than ``resolved_blocks`` blocks in a pulse go on, and are flagged in the data.

    Raises
    ------
    ValueError
        Naming the widest pulse, in blocks, and what is allowed.
    """
    widest, needed = 0.0, 0
    # Wide pulses first, so that the first run usually settles it.
    for scene in sorted(scenes, key=lambda scene: (scene.gamma * scene.dx**2, -scene.prestress.left)):
        blocks = pulse_blocks(scene)
        if blocks >= HARDLY_RESOLVED * scene.resolved_blocks:
            return
        if blocks >= widest:
            widest, needed = blocks, scene.resolved_blocks
    raise ValueError(
        f"resolved_blocks: {needed}, while the widest pulse has about {widest:.2g} blocks; allowed: a pulse of at least"
        f" {HARDLY_RESOLVED * needed:g} blocks: a smaller dx, or a smaller resolved_blocks where single blocks are the"
        " point"
    )


def pulse_blocks(scene: Scene) -> float:
    """Blocks across the narrowest thing that a scene must resolve; infinite where nothing is predicted.

    The steady pulse of the exact theory under a displacement boundary, the Gaussian under a stress boundary.
    """
    if scene.boundary == "stress":
        return scene.prestress.width / scene.dx
    levels = [level for level in (scene.prestress.left, scene.prestress.right) if 0.0 < level < 1.0]
    if not levels or scene.damping_ratio > STRONGEST_DAMPING:
        return math.inf
    tau = max(levels)
    try:
        speed = float(front_speed(tau, scene.damping_ratio, scene.release))
        return steady_pulse(tau, scene.gamma, scene.beta, speed).width / scene.dx
    except (ValueError, ArithmeticError):
        return math.inf
