"""How the rupture spreads from every nucleation point: fronts that outrun the waves, slow ones, and where they meet."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..model.roots import root_between
from .curve import Curve, Panel, seen
from .fronts import FrontLaw, nucleations
from .slow_front import advance

# Why a slow front cannot be followed further.
UNKNOWN = {
    "unknown": "what decides on a slow front comes from another part of the rupture",
    "unresolved": "the motion of a slow front is not resolved",
}
SIDES = (-1.0, 1.0)


@dataclass
class Stretch:
    """A connected part of the rupture and its two fronts, side -1 (left) and +1 (right)."""

    # Position and time of the outermost known point, by side.
    ends: dict[float, tuple[float, float]]
    # How far, seen going right, a front may go before it meets another nucleation point.
    limits: dict[float, float]
    panels: list[Panel] = field(default_factory=list)
    # Why a front goes no further: "dead" (it stops for good), "duration", "met", a key of UNKNOWN, or None.
    stopped: dict[float, str | None] = field(default_factory=lambda: dict.fromkeys(SIDES))
    # Where a front that was slow outran the waves again, and where fronts from different nucleation points met.
    restarts: dict[float, list[float]] = field(default_factory=lambda: {-1.0: [], 1.0: []})
    joins: list[float] = field(default_factory=list)

    def curve(self) -> Curve:
        """Its panels, as one curve."""
        return Curve(self.panels, self.restarts[-1.0], self.restarts[1.0])

    def add(self, side: float, panels: list[Panel], x: float, time: float) -> None:
        """Append panels made by a front seen going right, which ends at x and time so seen."""
        self.panels = seen(seen(self.panels, side) + panels, side)
        self.ends[side] = (side * x, time)

    def cut(self, side: float, x: float) -> None:
        """Take away what lies beyond x."""
        kept = []
        for panel in seen(self.panels, side):
            left, right = panel.x_ends
            if right <= side * x:
                kept.append(panel)
            elif left < side * x:
                s = float(Curve([panel]).locate(np.array([side * x]))[1][0])
                if s > -1.0:
                    kept.append(panel.until(s, side * x))
        time = kept[-1].time_ends[1] if kept else 0.0
        self.panels = seen(kept, side)
        self.ends[side] = (x, time)
        self.restarts[side] = [r for r in self.restarts[side] if side * r < side * x]


def spread(law: FrontLaw, until: float) -> tuple[list[Stretch], list[tuple[float, float, str]]]:
    """All connected parts of the rupture until a time, from left to right, and points where more is not known."""
    starts = nucleations(law.prestress)
    if not starts:
        raise ValueError(
            "prestress: below 1 everywhere; allowed: a profile that reaches 1 somewhere"
        )
    laws = {1.0: law, -1.0: law.mirrored()}
    befores, afters = (
        [-np.inf, *(right for _, right in starts)],
        [*(left for left, _ in starts[1:]), np.inf],
    )
    stretches = []
    for (left, right), before, after in zip(starts, befores, afters, strict=False):
        stretch = Stretch({-1.0: (left, 0.0), 1.0: (right, 0.0)}, {-1.0: -before, 1.0: after})
        if left < right:
            stretch.add(1.0, law.rightwards(left, 0.0, right, np.inf)[0], right, 0.0)
        for side in SIDES:
            _run(laws[side], stretch, side, until)
        stretches.append(stretch)
    stretches = _joined(stretches)
    # The slow fronts, the earliest first: each follows from what the others did before.
    while going := [
        (s.ends[side][1], n, side)
        for n, s in enumerate(stretches)
        for side in SIDES
        if s.stopped[side] is None
    ]:
        _, n, side = min(going)
        _step(laws[side], stretches[n], side, until)
        stretches = _joined(stretches)
    stops = [(s.ends[side], str(s.stopped[side])) for s in stretches for side in SIDES]
    unknown = [(*end, UNKNOWN[reason]) for end, reason in stops if reason in UNKNOWN]
    return stretches, unknown + _overrun(stretches)


def _overrun(stretches: list[Stretch]) -> list[tuple[float, float, str]]:
    """Cut fronts that come to where another has stopped for good: what they do there is not known."""
    out = []
    for left, right in pairwise(stretches):
        for near, far, side in ((left, right, -1.0), (right, left, 1.0)):
            # The front of `far` on this side has passed the end of `near`.
            x = near.ends[-side][0]
            if far.panels and side * far.ends[side][0] > side * x:
                far.cut(side, x)
                far.stopped[side] = "met"
                out.append((*far.ends[side], "a front comes to where another one has stopped"))
    return out


def _run(law: FrontLaw, stretch: Stretch, side: float, until: float) -> None:
    """Let a front go on while it outruns the waves, as far as the next nucleation point."""
    x, time = stretch.ends[side]
    limit = stretch.limits[side]
    panels, x, time = law.rightwards(side * x, time, limit, until)
    if panels:
        stretch.add(side, panels, x, time)
    if time >= until:
        stretch.stopped[side] = "duration"
    elif x >= limit:
        stretch.stopped[side] = "met"


def _step(law: FrontLaw, stretch: Stretch, side: float, until: float) -> None:
    """One panel of a slow front, and where its negative piece ends the fast front that follows."""
    x, _ = stretch.ends[side]
    piece = law.piece_right_of(side * x)
    mark = min(piece.right, stretch.limits[side])
    curve = stretch.curve() if side > 0.0 else stretch.curve().mirrored()
    panel, stop = advance(curve, law.prestress, piece.level, law.gamma, mark, law.alpha)
    if panel is not None:
        stretch.add(side, [panel], panel.x_ends[1], panel.time_ends[1])
    if stop in ("dead", *UNKNOWN):
        stretch.stopped[side] = stop
    elif stretch.ends[side][1] >= until:
        stretch.stopped[side] = "duration"
    elif stop == "mark":
        if mark >= stretch.limits[side]:
            stretch.stopped[side] = "met"
        elif law.piece_right_of(mark).supersonic:
            stretch.restarts[side].append(side * mark)
            _run(law, stretch, side, until)


def _joined(stretches: list[Stretch]) -> list[Stretch]:
    """Neighbours whose fronts have met, made one: where both have been, the earlier counts."""
    out = [stretches[0]]
    for right in stretches[1:]:
        left = out[-1]
        overlap = right.ends[-1.0][0], left.ends[1.0][0]
        if not (overlap[0] <= overlap[1] and left.panels and right.panels):
            out.append(right)
            continue
        first, second = left.curve(), right.curve()

        def lead(x: float, first=first, second=second) -> float:
            return float(first.arrival(np.array(x)) - second.arrival(np.array(x)))

        low = max(overlap[0], float(first.edges[0]))
        high = min(overlap[1], float(second.edges[-1]))
        if not (lead(low) <= 0.0 <= lead(high)):
            out.append(right)
            continue
        x = root_between(lead, low, high, xtol=1e-14)
        rises = np.diff(
            [first.arrival(np.array([x - 1e-6, x])), second.arrival(np.array([x, x + 1e-6]))]
        )
        slow = bool(np.any(np.abs(rises) > 1e-6))
        left.cut(1.0, x)
        right.cut(-1.0, x)
        restart = [x] if slow else []
        out[-1] = Stretch(
            ends={-1.0: left.ends[-1.0], 1.0: right.ends[1.0]},
            limits={-1.0: left.limits[-1.0], 1.0: right.limits[1.0]},
            panels=left.panels + right.panels,
            stopped={-1.0: left.stopped[-1.0], 1.0: right.stopped[1.0]},
            restarts={side: left.restarts[side] + right.restarts[side] + restart for side in SIDES},
            joins=[*left.joins, x, *right.joins],
        )
    return out
