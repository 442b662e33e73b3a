"""The benchmark: speeds relative to reference codes, on one core (`make benchmark`).

Ratios of times measured in one session can be compared between machines.
"""

import json
import platform
import time
import timeit
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

from slippulse.data.sweeps import versions
from slippulse.measurement.front_paths import fit_front
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.simulation.simulate import simulate
from slippulse.solver.fixed_step import FixedStepLattice
from slippulse.solver.lattice import Lattice
from slippulse.solver.solution import solve_on_lattice
from slippulse.theory.closed_pulse import pulse_at_speed
from slippulse.theory.front_speeds import front_speed as exact_speed
from slippulse_paper.records.provenance import machine_class

from . import stencils

ROOT = Path(__file__).parents[2]
LEVEL, GAMMA = 0.5, 0.65
RATIO, DX = 0.1, 0.01
DURATION = 400.0
REPEATS, TURNS = 3, 18
# The kernel is timed between these two times of a scene: a crack with 4,200 to 6,200 sliding blocks
# on each side, and a steady pulse of 200 blocks.
CRACK, PULSE = (3400.0, 5000.0), (60.0, 200.0)
# The steps of the textbook scheme are near these powers of 1/2, and the front runs along this
# number of blocks.
POWERS, LENGTH = (7, 8, 9), 160.0


def best(run: Callable[[], object], repeats: int) -> float:
    """Return the smallest processor time of a few repeats, in seconds.

    Processor time does not contain other work of the machine.
    """
    return min(timeit.repeat(run, timer=time.process_time, repeat=repeats, number=1))


def stencil_rate(blocks: int) -> float:
    """Return the block updates per second of the stencil without branches, timed once."""
    prestress, derivatives = np.full(blocks, 0.5), np.zeros((6, blocks))

    def run(steps: int) -> None:
        stencils.taylor_steps(derivatives, prestress, steps, 1e-6, 1.0, 1e-6, RATIO)

    # The first call may compile the stencil.
    run(1)
    seconds_of_20_steps = best(lambda: run(20), 1)
    # With this number of steps it runs for about 0.05 s.
    steps = max(20, int(1.0 / max(seconds_of_20_steps, 1e-9)))
    return blocks * steps / best(lambda: run(steps), 1)


class KernelRate(NamedTuple):
    """Speed of the kernel, and the mean number of sliding blocks while it was timed."""

    block_updates_per_second: float
    sliding_blocks: float


def kernel_rate(scene: Scene, until: float) -> KernelRate:
    """Return the speed of the kernel from the end of a scene until a later time."""
    lattice = Lattice(scene, None, scene.beta)
    lattice.advance_to_end(None)
    updates_before, steps_before = int(lattice.tally.block_updates), int(lattice.tally.steps)
    lattice.scene = replace(scene, duration=until)
    seconds = best(lambda: lattice.advance_to_end(None), 1)
    updates = int(lattice.tally.block_updates) - updates_before
    steps = int(lattice.tally.steps) - steps_before
    return KernelRate(updates / seconds, updates / steps)


def kernel() -> dict:
    """Compare the best times of the kernel and of a stencil without branches, timed in turns."""
    step = {"max_step": 0.5, "order": 4}
    profile = Prestress(LEVEL, LEVEL, 8.0)
    crack_start, crack_end = CRACK
    crack = Scene("displacement", profile, crack_start, 1.0, gamma=1e-9, beta=RATIO, **step)
    width = pulse_at_speed(LEVEL, GAMMA, 0.0, exact_speed(LEVEL, RATIO)).width
    pulse_start, pulse_end = PULSE
    pulse = _scene(pulse_start, width / 200.0, step)
    return {
        "many_blocks": compared_rates(crack, crack_end),
        "pulse_of_200_blocks": compared_rates(pulse, pulse_end),
    }


def compared_rates(scene: Scene, until: float) -> dict[str, float]:
    """Return the best speed of the kernel, also divided by the best speed of the stencil."""
    kernel_rates, stencil_rates = [], []
    for _ in range(TURNS):
        rate = kernel_rate(scene, until)
        kernel_rates.append(rate)
        stencil_rates.append(stencil_rate(round(rate.sliding_blocks)))
    fastest = max(kernel_rates)
    return {
        "sliding_blocks": fastest.sliding_blocks,
        "block_updates_per_second": fastest.block_updates_per_second,
        "ratio_to_branch_free": fastest.block_updates_per_second / max(stencil_rates),
    }


def whole_scene(accuracy: Mapping, window: float) -> dict:
    """Compare a scene with the textbook scheme on the whole lattice, at equal error in front speed.

    The time of the textbook scheme is the time of one step, multiplied by the number of steps.
    """
    scene = _scene(DURATION, DX, accuracy)
    exact = float(exact_speed(LEVEL, RATIO))
    measured = measured_front_speed(scene, window)
    error = abs(measured / exact - 1.0)
    seconds = best(lambda: solve_on_lattice(scene), REPEATS)
    step = error / textbook_error(window)
    textbook_steps = DURATION / (step * DX)
    blocks = int(2.0 * exact * DURATION / DX)
    seconds_per_step = textbook_step(blocks)
    return {
        "seconds": seconds,
        "front_speed_error": error,
        "textbook_step_at_equal_error": step,
        "textbook_steps": textbook_steps,
        "textbook_seconds_per_step": seconds_per_step,
        "times_faster_than_textbook": textbook_steps * seconds_per_step / seconds,
    }


def measured_front_speed(scene: Scene, window: float) -> float:
    """Simulate a scene and return its front speed, fitted to the last fraction of the path."""
    return fit_front(simulate(scene), window).slope


def _scene(duration: float, dx: float, accuracy: Mapping) -> Scene:
    """Return the scene of the benchmark with a duration, a spacing, and a step and order."""
    step = {key: accuracy[key] for key in ("max_step", "order")}
    prestress = Prestress(LEVEL, LEVEL)
    return Scene("displacement", prestress, duration, dx, gamma=GAMMA, beta=RATIO * dx, **step)


def textbook_error(window: float) -> float:
    """Return the error in front speed of the textbook scheme, divided by the step.

    The result is the median over several steps. The error is of first order in the step and does
    not depend on the spacing, so a small lattice is enough. The reference is the localised scheme
    at order 8 on the same path, so the approach to the steady speed does not count as an error.
    """

    def speed(scheme: str, step: float) -> float:
        values = {"scheme": scheme, "max_step": step, "order": 8}
        scene = Scene("stress", Prestress(LEVEL, LEVEL, 2.0), LENGTH, 1.0, beta=RATIO, **values)
        return measured_front_speed(scene, window)

    reference = speed("localised", 0.5)
    # Each step is near a power of 1/2, so that the error does not depend on a single step.
    steps = [factor * 2.0**-power for power, factor in product(POWERS, (1.0, 0.93, 0.86))]
    errors = [abs(speed("fixed_step", step) / reference - 1.0) / step for step in steps]
    return float(np.median(errors))


def textbook_step(blocks: int) -> float:
    """Return the seconds per step of the compiled textbook scheme for a number of blocks."""
    # Bumps at its ends make the lattice as large as needed. They are too small to matter.
    end = 0.5 * blocks * DX
    profile = Prestress(LEVEL, LEVEL, bumps=((end, 1e-12, DX), (-end, 1e-12, DX)))
    scene = _scene(2.0, DX, {"max_step": 0.25, "order": 4})
    scene = replace(scene, prestress=profile, scheme="fixed_step", half_lattice=False)
    lattice_blocks = FixedStepLattice(scene, None, scene.beta).size
    seconds = best(lambda: FixedStepLattice(scene, None, scene.beta).advance_to_end(None), 2)
    steps = scene.duration / (scene.max_step * DX)
    return seconds / steps * blocks / lattice_blocks


def main(folder: Path) -> None:
    """Run the benchmark, print the results and write them to a folder."""
    config = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
    machine = machine_class() | {"python": platform.python_version(), "versions": versions()}
    scene = whole_scene(config["presets"]["paper"], config["measure"]["front_window"])
    timed = kernel() | {"whole_scene": scene}
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"machine": machine} | timed, indent=1)
    (folder / "benchmark.json").write_text(f"{text}\n", encoding="utf-8")
    print(f"{text}\nAll in {folder}/benchmark.json")


if __name__ == "__main__":
    main(ROOT / "results/benchmarks")
