"""The spreading of a rupture from every nucleation point, by fast and slow fronts that may meet."""

from dataclasses import dataclass, field
from itertools import pairwise, product

import numpy as np

from ..model.roots import root_between
from .curve import SAME, Curve, Panel, Point, seen_from
from .fast_front import FastFront
from .prestress_pieces import nucleations
from .slow_front import Progress, SlowFront

# Reasons why a slow front cannot be followed further.
UNKNOWN = {
    "unknown": "what decides on a slow front comes from another part of the rupture",
    "unresolved": "the motion of a slow front is not resolved",
    "loaded": "a front stops where the pre-stress is positive",
}
OVERRUN = "a front comes to where another one has stopped"
LEFT, RIGHT = SIDES = (-1.0, 1.0)
# A front that takes longer than this over JUST_BEFORE the meeting point is slow.
JUST_BEFORE = 1e-6


@dataclass
class Stretch:
    """A connected part of the rupture and its two fronts, by side: LEFT or RIGHT."""

    # The outermost known point.
    ends: dict[float, Point]
    # Position, with the side turned to the right, of the next nucleation point.
    next_start: dict[float, float]
    panels: list[Panel] = field(default_factory=list)
    # Reason why a front goes no further: "stops" (for good), "duration", "met", a key of UNKNOWN,
    # or None.
    end_reason: dict[float, str | None] = field(default_factory=lambda: dict.fromkeys(SIDES))
    # Positions where a slow front outran the waves again, and where two fronts met.
    restarts: dict[float, list[float]] = field(default_factory=lambda: {LEFT: [], RIGHT: []})
    joins: list[float] = field(default_factory=list)
    # What a slow front goes on from, with its side turned to the right.
    progress: dict[float, Progress] = field(
        default_factory=lambda: dict.fromkeys(SIDES, Progress())
    )

    # The panels as one curve, by the side that is turned to the right, once it was asked for.
    curves: dict[float, Curve] = field(default_factory=dict)

    def curve(self, side: float = RIGHT) -> Curve:
        """The panels as one curve, with a side turned to the right."""
        left = [side * x for x in self.restarts[-side]]
        right = [side * x for x in self.restarts[side]]
        if side not in self.curves:
            self.curves[side] = Curve(seen_from(side, self.panels))
        return self.curves[side].restarted((left, right))

    def add(self, side: float, panels: list[Panel], end: Point) -> None:
        """Append panels, and their end, of a front whose side is turned to the right."""
        new = seen_from(side, panels)
        self.panels = self.panels + new if side > 0.0 else new + self.panels
        if side in self.curves and panels:
            self.curves[side] = self.curves[side].joined(Curve(panels))
        if -side in self.curves and panels:
            self.curves[-side] = Curve(seen_from(LEFT, panels)).joined(self.curves[-side])
        self.ends[side] = Point(side * end.x, end.time)

    def cut(self, side: float, x: float) -> None:
        """Take away the panels beyond x."""
        kept = []
        for panel in seen_from(side, self.panels):
            left, right = panel.x_ends
            if right <= side * x:
                kept.append(panel)
            elif left < side * x:
                s = float(Curve([panel]).locate(np.array([side * x]))[1][0])
                if s > -1.0:
                    kept.append(panel.until(s, side * x))
        time = kept[-1].time_ends[1] if kept else 0.0
        self.panels, self.curves = seen_from(side, kept), {}
        self.ends[side] = Point(x, time)
        self.restarts[side] = [start for start in self.restarts[side] if side * start < side * x]


def spread(law: FastFront, until: float) -> tuple[list[Stretch], list[tuple[Point, str]]]:
    """Connected parts from left to right at a time, and points beyond which nothing is known."""
    laws = {RIGHT: law, LEFT: law.mirrored()}
    stretches = _nucleated(law)
    for stretch, side in product(stretches, SIDES):
        _run(laws[side], stretch, side, until)
    stretches = _joined(stretches)
    # The earliest slow front goes on first: each follows from what the others did before.
    while going := [(s, side) for s, side in product(stretches, SIDES) if not s.end_reason[side]]:
        stretch, side = min(going, key=lambda front: front[0].ends[front[1]].time)
        _step(laws[side], stretch, side, until)
        stretches = _joined(stretches)
    stops = [(s.ends[side], str(s.end_reason[side])) for s, side in product(stretches, SIDES)]
    unknown = [(point, UNKNOWN[reason]) for point, reason in stops if reason in UNKNOWN]
    # The motion of a front that comes to where another has stopped for good is unknown.
    for (left, right), side in product(pairwise(stretches), SIDES):
        stopped, moving = (left, right) if side == LEFT else (right, left)
        x = stopped.ends[-side].x
        if moving.panels and side * moving.ends[side].x > side * x:
            moving.cut(side, x)
            moving.end_reason[side] = "met"
            unknown.append((moving.ends[side], OVERRUN))
    return stretches, unknown


def _nucleated(law: FastFront) -> list[Stretch]:
    """One stretch for each interval that is released at t = 0."""
    starts = nucleations(law.prestress)
    if not starts:
        allowed = "a profile that reaches 1 somewhere"
        raise ValueError(f"prestress: below 1 everywhere; allowed: {allowed}")
    out = []
    befores = [-np.inf, *(right for _, right in starts)]
    afters = [*(left for left, _ in starts[1:]), np.inf]
    for before, (left, right), after in zip(befores, starts, afters, strict=False):
        ends = {LEFT: Point(left, 0.0), RIGHT: Point(right, 0.0)}
        stretch = Stretch(ends, {LEFT: -before, RIGHT: after})
        if left < right:
            panels, _ = law.rightwards(Point(left, 0.0), right, np.inf)
            stretch.add(RIGHT, panels, Point(right, 0.0))
        out.append(stretch)
    return out


def _run(law: FastFront, stretch: Stretch, side: float, until: float) -> None:
    """Let a front go on while it outruns the waves, as far as the next nucleation point."""
    start, stop = stretch.ends[side], stretch.next_start[side]
    panels, end = law.rightwards(Point(side * start.x, start.time), stop, until)
    if panels:
        stretch.add(side, panels, end)
    if end.time >= until:
        stretch.end_reason[side] = "duration"
    elif end.x >= stop:
        stretch.end_reason[side] = "met"


def _step(law: FastFront, stretch: Stretch, side: float, until: float) -> None:
    """Add one panel of a slow front; where its negative piece ends, a fast front follows."""
    piece = law.piece_right_of(side * stretch.ends[side].x)
    mark = min(piece.right, stretch.next_start[side])
    front = SlowFront(stretch.curve(side), law.prestress, piece.background, law.gamma, law.alpha)
    panel, stop, stretch.progress[side] = front.next_panel(mark, stretch.progress[side])
    if panel is not None:
        stretch.add(side, [panel], panel.end)
    if stop in ("stops", *UNKNOWN):
        loaded = stop == "stops" and law.prestress(side * stretch.ends[side].x) > SAME
        stretch.end_reason[side] = "loaded" if loaded else stop
    elif stretch.ends[side].time >= until:
        stretch.end_reason[side] = "duration"
    elif stop == "mark":
        # Where the next piece is negative, too, the next step goes on.
        if mark >= stretch.next_start[side]:
            stretch.end_reason[side] = "met"
        elif law.piece_right_of(mark).above:
            stretch.progress[side] = Progress()
            stretch.restarts[side].append(side * mark)
            _run(law, stretch, side, until)


def _joined(stretches: list[Stretch]) -> list[Stretch]:
    """The stretches, with neighbours whose fronts have met made one."""
    out = [stretches[0]]
    for right in stretches[1:]:
        merged = _merged(out[-1], right)
        out = [*out, right] if merged is None else [*out[:-1], merged]
    return out


def _merged(left: Stretch, right: Stretch) -> Stretch | None:
    """One stretch of two if their fronts have met: each position belongs to the earlier front."""
    if not (left.panels and right.panels and right.ends[LEFT].x <= left.ends[RIGHT].x):
        return None
    first, second = left.curve(), right.curve()

    def lead(x: float) -> float:
        return float(first.arrival(x) - second.arrival(x))

    low = max(right.ends[LEFT].x, float(first.edges[0]))
    high = min(left.ends[RIGHT].x, float(second.edges[-1]))
    if not (lead(low) <= 0.0 <= lead(high)):
        return None
    x = root_between(lead, low, high, xtol=1e-14)
    before, after = np.array([x - JUST_BEFORE, x]), np.array([x, x + JUST_BEFORE])
    times = np.array([first.arrival(before), second.arrival(after)])
    restart = [x] if np.any(np.abs(np.diff(times)) > JUST_BEFORE) else []
    left.cut(RIGHT, x)
    right.cut(LEFT, x)
    return Stretch(
        ends={LEFT: left.ends[LEFT], RIGHT: right.ends[RIGHT]},
        next_start={LEFT: left.next_start[LEFT], RIGHT: right.next_start[RIGHT]},
        panels=left.panels + right.panels,
        end_reason={LEFT: left.end_reason[LEFT], RIGHT: right.end_reason[RIGHT]},
        restarts={side: left.restarts[side] + right.restarts[side] + restart for side in SIDES},
        joins=[*left.joins, x, *right.joins],
        progress={LEFT: left.progress[LEFT], RIGHT: right.progress[RIGHT]},
    )
