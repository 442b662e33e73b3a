"""Random scenes on which an exact solution is hard to get, and what two solutions say of each."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import Rupture

# Largest difference of two answers, relative to the duration, or to the largest slip.
AGREEMENT = 1e-6


@dataclass(frozen=True)
class Keys:
    """Arguments of a rupture, and the factors of x and slip that lead back to the first scene."""

    prestress: Prestress
    gamma: float
    damping_ratio: float
    release: str
    duration: float
    refinement: int = 1
    x: float = 1.0

    def rupture(self) -> Rupture:
        *arguments, _ = vars(self).values()
        return Rupture(*arguments)


def stretched(keys: Keys, factor: float) -> Keys:
    """The scene with all lengths and times multiplied; a factor of -1 mirrors it."""
    tau, size = keys.prestress, abs(factor)
    levels = (tau.left, tau.right) if factor > 0.0 else (tau.right, tau.left)
    steps = tuple((factor * x, level) for x, level in tau.steps)
    bumps = tuple((factor * x, height, size * width) for x, height, width in tau.bumps)
    moved = Prestress(*levels, size * tau.width, tau.peak, steps, bumps)
    gamma, duration = keys.gamma / size**2, keys.duration * size
    return replace(keys, prestress=moved, gamma=gamma, duration=duration, x=factor)


VARIANTS: dict[str, Callable[[Keys], Keys]] = {
    "mirrored": lambda keys: stretched(keys, -1.0),
    "scaled": lambda keys: stretched(keys, 1.7),
    "refinement 2": lambda keys: replace(keys, refinement=2),
    "refinement 3": lambda keys: replace(keys, refinement=3),
    "longer": lambda keys: replace(keys, duration=1.5 * keys.duration),
}


def bumps(rng: np.random.Generator, count: int, *heights: float) -> tuple:
    """Bumps on both sides of the nucleation, which they hardly raise."""
    out = []
    for _ in range(count):
        height = rng.uniform(*heights)
        width = rng.uniform(0.3, 1.5) if height > 0.0 else rng.uniform(0.2, 0.6)
        # One that is felt at x = 0 raises the peak.
        nearest = 4.0 if height > 0.0 else 9.5
        centre = rng.choice([-1.0, 1.0]) * (width * rng.uniform(nearest, 9.5) + 0.5)
        out.append((float(centre), float(height), float(width)))
    return tuple(out)


def several_bumps(rng: np.random.Generator) -> Prestress:
    level = rng.uniform(-0.5, 0.6)
    return Prestress(level, level, rng.uniform(0.5, 2.0), bumps=bumps(rng, 3, 0.2, 1.3 - level))


def barriers(rng: np.random.Generator) -> Prestress:
    level, width = rng.uniform(0.2, 0.8), rng.uniform(0.5, 2.0)
    start, low = rng.uniform(2.0, 6.0, 2), rng.uniform(-0.8, -0.1, 2)
    ends = start + rng.uniform(0.3, 4.0, 2)
    steps = ((start[0], low[0]), (ends[0], level), (-start[1], low[1]), (-ends[1], level))
    return Prestress(level, level, width, steps=steps)


def asymmetric(rng: np.random.Generator) -> Prestress:
    left, right = rng.uniform(-0.9, 0.9, 2)
    steps = ((rng.choice([-1, 1]) * rng.uniform(1.0, 9.0), rng.uniform(-0.9, 0.9)),)
    width = rng.uniform(0.4, 2.5)
    return Prestress(left, right, width, steps=steps, bumps=bumps(rng, 1, -0.5, 0.5))


def ending_tails(rng: np.random.Generator) -> Prestress:
    left, right = rng.uniform(-0.6, 0.8, 2)
    ends = rng.uniform(2.0, 9.0, 2)
    beyond = rng.choice([0.0, -0.2, -0.6], 2)
    steps = ((-ends[0], beyond[0]), (ends[1], beyond[1]))
    return Prestress(left, right, rng.uniform(0.5, 2.0), steps=steps)


def stop_and_go(rng: np.random.Generator) -> Prestress:
    """Positive, negative, positive, negative pre-stress, on one or both sides."""
    level, width = -rng.uniform(0.15, 0.8), rng.uniform(0.5, 1.5)
    humps = []
    for side in (1.0, -1.0)[: rng.integers(1, 3)]:
        size = rng.uniform(0.4, 1.2)
        centre = side * (2.0 * width + rng.uniform(1.0, 2.5) * size)
        humps.append((centre, rng.uniform(0.3, 1.4) - level, size))
    return Prestress(level, level, width, bumps=tuple(humps))


FAMILIES = {
    "several bumps": several_bumps,
    "barriers": barriers,
    "bumps under stress": several_bumps,
    "asymmetric": asymmetric,
    "ending tails": ending_tails,
    "stop and go": stop_and_go,
}


def scene(number: int) -> Keys:
    """A random scene; its family is that of its number."""
    rng = np.random.default_rng((number, 37))
    family = list(FAMILIES)[number % len(FAMILIES)]
    stress = family == "bumps under stress" or (family != "several bumps" and rng.random() < 0.2)
    gamma = 0.0 if stress else float(10.0 ** rng.uniform(-1.5, 0.0))
    ratio = float(rng.choice([0.0, 0.1, 10.0 ** rng.uniform(-2.0, 0.3)]))
    duration = min(rng.uniform(0.7, 1.8) * np.pi / np.sqrt(gamma or 0.25), 25.0)
    prestress, release = FAMILIES[family](rng), str(rng.choice(["total", "elastic"]))
    return Keys(prestress, gamma, ratio, release, duration)


class Answers:
    """Numbers of a solution at positions and times, in units of the length of the first scene."""

    def __init__(self, keys: Keys, rupture: Rupture, x: np.ndarray, times: np.ndarray) -> None:
        size = abs(keys.x)
        at, limit = keys.x * x, rupture.limit
        self.limit = limit.time / size if limit else np.inf
        self.known = np.minimum(rupture.horizon(at), rupture.duration) / size
        self.release = np.nan_to_num(rupture.release_time(at), nan=np.inf) / size
        self.stick = np.nan_to_num(rupture.stick_time(at), nan=np.inf) / size
        self.slip = rupture.map(size * times, at, ("slip",))["slip"] / size**2
        first = rupture.first_stick
        self.first = min(first.time if first else np.inf, rupture.duration) / size


class Compared:
    """One solution of a scene, solved once, and what others say of the same points."""

    def __init__(self, keys: Keys, positions: int = 16) -> None:
        self.keys, rupture = keys, keys.rupture()
        ends = [end.x for pair in rupture.front_ends for end in pair]
        self.x = np.linspace(min(ends), max(ends), positions + 2)[1:-1]
        self.times = keys.duration * np.array([0.35, 0.65, 0.95])
        self.answers = Answers(keys, rupture, self.x, self.times)

    def answers_of(self, other: Keys) -> Answers:
        return Answers(other, other.rupture(), self.x, self.times)

    def check(self, two: Answers) -> None:
        """Assert that another solution agrees before either has a limit, and that both can be."""
        one, end = self.answers, self.keys.duration
        near = partial(np.testing.assert_allclose, rtol=0.0, atol=AGREEMENT * end)
        until = np.minimum(np.minimum(one.known, two.known), end) * (1.0 - AGREEMENT)
        near(np.minimum(two.release, until), np.minimum(one.release, until), err_msg="release")
        near(np.minimum(two.stick, until), np.minimum(one.stick, until), err_msg="stick")
        latest = min(one.limit, two.limit, end) * (1.0 - AGREEMENT)
        near(min(two.first, latest), min(one.first, latest), err_msg="first stick")
        error = AGREEMENT * max(1.0, np.nanmax(np.abs(one.slip), initial=0.0))
        assert np.nanmax(np.abs(one.slip - two.slip), initial=0.0) <= error, "slip"
        for answers in (one, two):
            assert np.nanmin(answers.slip, initial=0.0) >= -error, "slip below 0"
            assert not np.any(np.diff(answers.slip, axis=0) < -error), "slip that falls"
            known = np.where(answers.stick < answers.known, answers.stick, np.inf)
            earliest = np.min(known, initial=np.inf) + AGREEMENT * end
            assert min(answers.first, answers.limit) <= earliest, "a first stick that is not"
