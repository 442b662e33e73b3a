"""Random scenes that are hard to solve exactly, and the comparison of two solutions of each.

A scene is solved several times, for example mirrored or scaled, and all solutions must agree.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from slippulse.model.prestress import Prestress
from slippulse.theory.rupture import Rupture

# Largest difference of two answers, relative to the duration, or to the largest slip.
AGREEMENT = 1e-6


@dataclass(frozen=True)
class HardScene:
    """Arguments of a rupture, and the factor by which its positions were stretched."""

    prestress: Prestress
    gamma: float
    damping_ratio: float
    release: str
    duration: float
    refinement: int = 1
    stretch: float = 1.0

    def rupture(self) -> Rupture:
        """Return the exact rupture of the scene."""
        return Rupture(
            self.prestress,
            self.gamma,
            self.damping_ratio,
            self.release,
            self.duration,
            self.refinement,
        )


def stretched(scene: HardScene, factor: float) -> HardScene:
    """Return the scene with all lengths and times multiplied; a factor of -1 mirrors it."""
    old, size = scene.prestress, abs(factor)
    left, right = (old.left, old.right) if factor > 0.0 else (old.right, old.left)
    steps = tuple((factor * x, level) for x, level in old.steps)
    bumps = tuple((factor * x, height, size * width) for x, height, width in old.bumps)
    return replace(
        scene,
        prestress=Prestress(left, right, size * old.width, old.peak, steps, bumps),
        gamma=scene.gamma / size**2,
        duration=scene.duration * size,
        stretch=factor,
    )


# Other forms of a scene, whose solutions must agree with it.
VARIANTS: dict[str, Callable[[HardScene], HardScene]] = {
    "mirrored": lambda scene: stretched(scene, -1.0),
    "scaled": lambda scene: stretched(scene, 1.7),
    "refinement 2": lambda scene: replace(scene, refinement=2),
    "refinement 3": lambda scene: replace(scene, refinement=3),
    "longer": lambda scene: replace(scene, duration=1.5 * scene.duration),
}


def random_bumps(rng: np.random.Generator, count: int, lowest: float, highest: float) -> tuple:
    """Return bumps on both sides of the nucleation, with heights in a range.

    They hardly raise the peak at x = 0.
    """
    bumps = []
    for _ in range(count):
        height = rng.uniform(lowest, highest)
        width = rng.uniform(0.3, 1.5) if height > 0.0 else rng.uniform(0.2, 0.6)
        # A bump that reaches x = 0 would change the peak.
        nearest_in_widths = 4.0 if height > 0.0 else 9.5
        side = rng.choice([-1.0, 1.0])
        centre = side * (width * rng.uniform(nearest_in_widths, 9.5) + 0.5)
        bumps.append((float(centre), float(height), float(width)))
    return tuple(bumps)


def several_bumps(rng: np.random.Generator) -> Prestress:
    """Return a pre-stress on one level with three positive bumps."""
    level = rng.uniform(-0.5, 0.6)
    width = rng.uniform(0.5, 2.0)
    return Prestress(level, level, width, bumps=random_bumps(rng, 3, 0.2, 1.3 - level))


def barriers(rng: np.random.Generator) -> Prestress:
    """Return a pre-stress on one level with a stretch of negative pre-stress on each side."""
    level, width = rng.uniform(0.2, 0.8), rng.uniform(0.5, 2.0)
    starts = rng.uniform(2.0, 6.0, 2)
    depths = rng.uniform(-0.8, -0.1, 2)
    ends = starts + rng.uniform(0.3, 4.0, 2)
    right_barrier = ((starts[0], depths[0]), (ends[0], level))
    left_barrier = ((-starts[1], depths[1]), (-ends[1], level))
    return Prestress(level, level, width, steps=right_barrier + left_barrier)


def asymmetric(rng: np.random.Generator) -> Prestress:
    """Return a pre-stress with different levels, a step on one side, and a bump."""
    left, right = rng.uniform(-0.9, 0.9, 2)
    side, distance = rng.choice([-1, 1]), rng.uniform(1.0, 9.0)
    steps = ((side * distance, rng.uniform(-0.9, 0.9)),)
    width = rng.uniform(0.4, 2.5)
    return Prestress(left, right, width, steps=steps, bumps=random_bumps(rng, 1, -0.5, 0.5))


def ending_tails(rng: np.random.Generator) -> Prestress:
    """Return a pre-stress that is zero or negative beyond a distance on each side."""
    left, right = rng.uniform(-0.6, 0.8, 2)
    ends = rng.uniform(2.0, 9.0, 2)
    beyond_left, beyond_right = rng.choice([0.0, -0.2, -0.6], 2)
    steps = ((-ends[0], beyond_left), (ends[1], beyond_right))
    return Prestress(left, right, rng.uniform(0.5, 2.0), steps=steps)


def stop_and_go(rng: np.random.Generator) -> Prestress:
    """Return positive, negative, positive, negative pre-stress, on one or both sides."""
    level, width = -rng.uniform(0.15, 0.8), rng.uniform(0.5, 1.5)
    sides = (1.0, -1.0)[: rng.integers(1, 3)]
    bumps = []
    for side in sides:
        bump_width = rng.uniform(0.4, 1.2)
        centre = side * (2.0 * width + rng.uniform(1.0, 2.5) * bump_width)
        bumps.append((centre, rng.uniform(0.3, 1.4) - level, bump_width))
    return Prestress(level, level, width, bumps=tuple(bumps))


FAMILIES = {
    "several bumps": several_bumps,
    "barriers": barriers,
    "bumps under stress": several_bumps,
    "asymmetric": asymmetric,
    "ending tails": ending_tails,
    "stop and go": stop_and_go,
}


def scene(number: int) -> HardScene:
    """Return the random scene with a number, which also chooses its family."""
    rng = np.random.default_rng((number, 37))
    family = list(FAMILIES)[number % len(FAMILIES)]
    has_held_stress = family == "bumps under stress" or (
        family != "several bumps" and rng.random() < 0.2
    )
    gamma = 0.0 if has_held_stress else float(10.0 ** rng.uniform(-1.5, 0.0))
    damping_ratio = float(rng.choice([0.0, 0.1, 10.0 ** rng.uniform(-2.0, 0.3)]))
    half_periods = rng.uniform(0.7, 1.8)
    duration = min(half_periods * np.pi / np.sqrt(gamma or 0.25), 25.0)
    prestress = FAMILIES[family](rng)
    release = str(rng.choice(["total", "elastic"]))
    return HardScene(prestress, gamma, damping_ratio, release, duration)


class Answers:
    """Results of a rupture at positions and times, in the units of the scene before stretching.

    Times are infinite for events that do not happen. Results hold until ``horizon``.
    """

    def __init__(
        self, scene: HardScene, rupture: Rupture, positions: np.ndarray, times: np.ndarray
    ) -> None:
        size = abs(scene.stretch)
        x, limit = scene.stretch * positions, rupture.limit
        self.limit = limit.time / size if limit else np.inf
        self.horizon = np.minimum(rupture.horizon(x), rupture.duration) / size
        self.release = np.nan_to_num(rupture.release_time(x), nan=np.inf) / size
        self.stick = np.nan_to_num(rupture.stick_time(x), nan=np.inf) / size
        self.slip = rupture.map(size * times, x, ("slip",))["slip"] / size**2
        first_stick = rupture.first_stick.time if rupture.first_stick else np.inf
        self.first_stick = min(first_stick, rupture.duration) / size


class ComparedScene:
    """A scene that is solved once, to compare its results with those of other solutions."""

    def __init__(self, scene: HardScene, positions: int = 16) -> None:
        self.scene, rupture = scene, scene.rupture()
        front_ends = [end.x for end in chain.from_iterable(rupture.front_ends)]
        self.x = np.linspace(min(front_ends), max(front_ends), positions + 2)[1:-1]
        self.times = scene.duration * np.array([0.35, 0.65, 0.95])
        self.answers = Answers(scene, rupture, self.x, self.times)

    def answers_of(self, other: HardScene) -> Answers:
        """Return the results of another scene at the same positions and times."""
        return Answers(other, other.rupture(), self.x, self.times)

    def check(self, other: Answers) -> None:
        """Assert that the results of two solutions agree while both hold, and are possible."""
        answers, end = self.answers, self.scene.duration
        allowed = AGREEMENT * end
        horizon = np.minimum(np.minimum(answers.horizon, other.horizon), end) * (1.0 - AGREEMENT)
        for name in ("release", "stick"):
            times = np.minimum(getattr(answers, name), horizon)
            other_times = np.minimum(getattr(other, name), horizon)
            np.testing.assert_allclose(other_times, times, rtol=0.0, atol=allowed, err_msg=name)
        limit = min(answers.limit, other.limit, end) * (1.0 - AGREEMENT)
        difference = min(other.first_stick, limit) - min(answers.first_stick, limit)
        assert abs(difference) <= allowed, "first stick"
        allowed_slip = AGREEMENT * max(1.0, np.nanmax(np.abs(answers.slip), initial=0.0))
        assert np.nanmax(np.abs(answers.slip - other.slip), initial=0.0) <= allowed_slip, "slip"
        for each_solution in (answers, other):
            check_possible(each_solution, allowed, allowed_slip)


def check_possible(answers: Answers, allowed: float, allowed_slip: float) -> None:
    """Assert that slip is not negative and never falls, and that the first stick is the first."""
    assert np.nanmin(answers.slip, initial=0.0) >= -allowed_slip, "slip below 0"
    assert not np.any(np.diff(answers.slip, axis=0) < -allowed_slip), "slip that falls"
    known_sticks = answers.stick[answers.stick < answers.horizon]
    earliest = np.min(known_sticks, initial=np.inf)
    assert min(answers.first_stick, answers.limit) <= earliest + allowed, "a stick before the first"
