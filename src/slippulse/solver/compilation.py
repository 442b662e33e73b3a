"""Compiles every kernel into the cache, in two processes side by side."""

from __future__ import annotations

import contextlib
import hashlib
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
from numba.core.registry import cpu_target

from ..model.prestress import Prestress
from ..model.scene import Scene
from . import events, foresight, segments, taylor
from .lattice import Lattice

# What the other process says when all that an event sets off is in the cache.
EVENTS_ARE_COMPILED = "events"


def compile_all() -> None:
    """Compile the kernels of both schemes, unless that is done or the compiler is switched off.

    This process compiles what a step calls, then the step; the other one what an event sets off, and meanwhile what no
    step calls. What the other has compiled is taken from the cache; should it have failed, it is compiled here.
    """
    if numba.config.DISABLE_JIT:
        return
    mark = _mark()
    if mark.exists():
        _compile_the_step()
    else:
        with subprocess.Popen([sys.executable, "-m", __name__], stdout=subprocess.PIPE, text=True) as other:
            _compile_steps()
            other.stdout.readline()
            _compile_the_step()
            other.wait()
    _compile_rest()
    with contextlib.suppress(OSError):
        mark.touch()


def _mark() -> Path:
    """The file beside the kernels that says that all are there, for this processor and this compiler."""
    target = (numba.__version__, *cpu_target.target_context.codegen().magic_tuple())
    digest = hashlib.sha256(repr(target).encode()).hexdigest()[:16]
    return Path(taylor.advance.stats.cache_path) / f"compiled-{digest}"


def _scene(scheme: str) -> Scene:
    return Scene("displacement", Prestress(0.5, 0.5), 1.0, 0.5, gamma=0.5, scheme=scheme)


def _compile(kernel, *arguments) -> None:
    """Compile a kernel for arguments like these."""
    kernel.compile(tuple(numba.typeof(argument) for argument in arguments))


class _Arguments:
    """A lattice before its first step, and its arrays as `advance` passes them on."""

    def __init__(self) -> None:
        self.lattice = lattice = Lattice(_scene("localised"), None, 0.0)
        self.order = lattice.scene.order
        self.runs = (lattice.starts, lattice.ends, int(lattice.counts[taylor.RUNS]))
        self.rules = (lattice.scene.dx, lattice.leaf, lattice.beta)
        self.foreseen = (lattice.stopping_block, lattice.stopping_time)
        self.difference, self.own, self.values, *self.polynomials = taylor.scratch(self.order)[:5]


def _compile_steps() -> None:
    """All that a step calls but the expansion of an event."""
    given = _Arguments()
    lattice, order, dx = given.lattice, given.order, given.lattice.scene.dx
    w, strain, tau = lattice.w, lattice.strain, lattice.tau
    _compile(
        taylor.foresee_sticks,
        w,
        lattice.velocity,
        *given.runs,
        *given.foreseen,
        *given.polynomials,
        order,
        0.1,
    )
    _compile(
        foresight.foresee_releases, lattice.release_at, *given.polynomials, w, lattice.offset, strain, tau,
        *given.runs, 0.0, 0.1, lattice.mirror, *given.rules, True, order + 1, 0, 1,
    )  # fmt: skip
    _compile(taylor.derivatives, w, strain, tau, *given.runs, lattice.mirror, order + 1, *given.rules)
    _compile(taylor.viscous_rate, w, *given.runs, lattice.mirror, dx, lattice.beta)
    none = np.zeros(0, dtype=np.int64)
    _compile(
        taylor.take_over, w, lattice.offset, strain, lattice.velocity, *given.runs, none, none, none, 0, order, 0.1,
        lattice.mirror, dx,
    )  # fmt: skip
    _compile(
        taylor.take_samples, w, lattice.offset, 0.0, 0.1, order, lattice.counts, lattice.sample_times,
        lattice.sample_blocks, lattice.sample_slip, lattice.sample_velocity,
    )  # fmt: skip


def _compile_the_step() -> None:
    """The step itself, which takes in all that it calls."""
    Lattice(_scene("localised"), None, 0.0).run(None)


def _compile_events() -> None:
    """What a release or a stick sets off, and how the next one is found."""
    given = _Arguments()
    lattice, top = given.lattice, given.order + 1
    ahead = (lattice.release_at, *given.runs, lattice.mirror)
    _compile(foresight.next_event, *ahead, *given.foreseen, 0)
    _compile(foresight.crowded, *ahead, *given.foreseen, 0, 1, 0.1)
    _compile(foresight.due_releases, *ahead, 0.1, lattice.stopping_block)
    _compile(segments.holds, *given.runs, 1)
    _compile(segments.release_block, *given.runs, 1)
    _compile(segments.stick_block, *given.runs, 1)
    _compile(
        events.change_course, lattice.w, lattice.offset, lattice.strain, lattice.tau, lattice.velocity, *given.runs, 1,
        True, 0.05, 0.1, lattice.release_at, *given.foreseen, 0, given.difference, given.own, given.values,
        *given.polynomials, lattice.mirror, True, *given.rules, top,
    )  # fmt: skip


def _compile_rest() -> None:
    """How a run ends, and the textbook scheme."""
    Lattice(_scene("fixed_step"), None, 0.0).run(None)
    given = _Arguments()
    lattice = given.lattice
    _compile(
        taylor.finish, lattice.w, lattice.strain, lattice.tau, lattice.starts, lattice.ends, lattice.counts,
        lattice.totals, lattice.mirror, *given.rules,
    )  # fmt: skip


if __name__ == "__main__":
    _compile_events()
    print(EVENTS_ARE_COMPILED, flush=True)
    _compile_rest()
