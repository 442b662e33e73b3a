r"""The spreading of a rupture from every nucleation point, by fast and slow fronts that may meet.

A `Stretch` is a connected part of the rupture with its left and its right front. There is one for
each interval that is released at t = 0. `spread` lets all fronts run, in two steps. First each
front runs as long as it is faster than the waves, because such a front depends on nothing behind
it. Then the slow fronts run by one panel at a time, the earliest one first, because each of them
depends on what the others did before. Where a slow front reaches positive pre-stress again, it
continues as a fast one. Stretches whose fronts have met become one:

    t |`.          .'`.          .'
      |  `.      .'    `.      .'      the two stretches become one
      |    `.  .'        `.  .'        where their fronts meet
      |      `'            `'
      +-------+-------------+------- x
          nucleation    nucleation
"""

from dataclasses import dataclass, field
from itertools import pairwise, product

import numpy as np

from ..model.roots import root_between
from .curve import EQUALITY_TOLERANCE, Curve, Panel, Point, turned_to_right
from .fast_front import FastFront
from .prestress_pieces import nucleation_intervals
from .slow_front import Progress, SlowFront

# Messages for the reasons why a slow front cannot be followed further.
REASONS_UNKNOWN = {
    "unknown": "the motion of a slow front depends on another part of the rupture",
    "unresolved": "the motion of a slow front is not resolved",
    "positive_prestress": "a front stops where the pre-stress is positive",
}
REASON_OVERRUN = "a front arrives where another one has stopped"
# Reasons of `SlowFront.next_panel` for which a front is not followed further.
END_REASONS = ("stops", *REASONS_UNKNOWN)
# The two sides. Multiplied by its side, the position of a front increases while the front runs.
LEFT, RIGHT = SIDES = (-1.0, 1.0)
# Where two fronts meet, the speed of each is judged over this last distance. At the wave speed, 1,
# a front takes a time of the same size for it; a slow front takes longer.
MEETING_DISTANCE = 1e-6


@dataclass
class Stretch:
    """A connected part of the rupture and its two fronts.

    The dictionaries have a value for each side, LEFT or RIGHT. If a value is given "with its side
    turned to the right", the left side is mirrored at x = 0. So both fronts are treated as right
    fronts.
    """

    # The outermost known point of each front.
    ends: dict[float, Point]
    # Position of the next nucleation point on each side, with this side turned to the right;
    # infinite if there is none.
    next_start: dict[float, float]
    panels: list[Panel] = field(default_factory=list)
    # Reason why a front is not followed further: "stops" (for good), "duration" (the time is over),
    # "met" (another front), or a key of REASONS_UNKNOWN. None if it is followed further.
    end_reason: dict[float, str | None] = field(default_factory=lambda: dict.fromkeys(SIDES))
    # Positions where a slow front became faster than the waves again, by side. A position where it
    # met another front is in both lists.
    restarts: dict[float, list[float]] = field(default_factory=lambda: {LEFT: [], RIGHT: []})
    # Positions where two fronts met.
    joins: list[float] = field(default_factory=list)
    # State of a slow front, with its side turned to the right.
    progress: dict[float, Progress] = field(
        default_factory=lambda: dict.fromkeys(SIDES, Progress())
    )
    # Curves that the method `curve` has made, by the side that is turned to the right.
    curves: dict[float, Curve] = field(default_factory=dict)

    def curve(self, side: float = RIGHT) -> Curve:
        """Return the panels as one curve, with a side (LEFT = -1, RIGHT = +1) turned to the right.

        If the left side is turned to the right, the curve is the mirror image at x = 0.
        """
        if side not in self.curves:
            self.curves[side] = Curve(turned_to_right(side, self.panels))
        # Restarts are positions where a slow front became fast again. In the mirror image, those of
        # right fronts become those of left fronts, and change their sign.
        left_restarts = [side * x for x in self.restarts[-side]]
        right_restarts = [side * x for x in self.restarts[side]]
        return self.curves[side].with_restarts((left_restarts, right_restarts))

    def add(self, side: float, panels: list[Panel], end: Point) -> None:
        """Append panels to the front on one side.

        The panels, and the point where they end, are given with this side turned to the right: for
        the left side they are mirrored at x = 0.
        """
        mirrored_panels = turned_to_right(LEFT, panels)
        if side > 0.0:
            self.panels = self.panels + panels
        else:
            self.panels = mirrored_panels + self.panels
        # Existing curves are extended, which is faster than to build them again from all panels.
        # The new panels are the last ones of the curve with this side turned to the right. In the
        # curve with the other side turned to the right they are mirrored, and come first.
        if side in self.curves and panels:
            self.curves[side] = self.curves[side].joined(Curve(panels))
        if -side in self.curves and panels:
            self.curves[-side] = Curve(mirrored_panels).joined(self.curves[-side])
        self.ends[side] = Point(side * end.x, end.time)

    def cut(self, side: float, x: float) -> None:
        """End the front on one side at x: remove what lies beyond this position."""
        # The position with this side turned to the right.
        x_of_cut = side * x
        kept_panels = []
        for panel in turned_to_right(side, self.panels):
            left, right = panel.x_ends
            if right <= x_of_cut:
                kept_panels.append(panel)
            elif left < x_of_cut:
                # The panel is cut at the parameter s, which runs from -1 to 1 along it. By rounding
                # s can be -1, so that nothing of the panel is left.
                _, (s,) = Curve([panel]).locate(np.array([x_of_cut]))
                if s > -1.0:
                    kept_panels.append(panel.left_part(float(s), x_of_cut))
        # Without panels, only the nucleation at t = 0 is left.
        time = kept_panels[-1].time_ends[1] if kept_panels else 0.0
        self.panels = turned_to_right(side, kept_panels)
        # The curves that were made from the old panels are no longer valid.
        self.curves = {}
        self.ends[side] = Point(x, time)
        self.restarts[side] = [start for start in self.restarts[side] if side * start < x_of_cut]


def spread(fast_front: FastFront, until: float) -> tuple[list[Stretch], list[tuple[Point, str]]]:
    """Let all fronts run until a time, and return the connected parts of the rupture in order.

    fast_front has the pre-stress and the law of motion of fast fronts. Also return the points in
    whose future the rupture is unknown, each with its reason.
    """
    fast_fronts = {RIGHT: fast_front, LEFT: fast_front.mirrored()}
    stretches = _nucleate(fast_front)
    for stretch, side in product(stretches, SIDES):
        _advance_fast_front(fast_fronts[side], stretch=stretch, side=side, until=until)
    stretches = _join_met_stretches(stretches)
    # From here on, the fronts that still move are slow.
    while (front := _earliest_moving_front(stretches)) is not None:
        stretch, side = front
        _advance_slow_front(fast_fronts[side], stretch=stretch, side=side, until=until)
        stretches = _join_met_stretches(stretches)
    unknown = []
    for stretch, side in product(stretches, SIDES):
        reason = str(stretch.end_reason[side])
        # At its other reasons to end, such as the final time, the rupture remains known.
        if reason in REASONS_UNKNOWN:
            unknown.append((stretch.ends[side], REASONS_UNKNOWN[reason]))
    points_of_cuts = _cut_overrunning_fronts(stretches)
    return stretches, unknown + points_of_cuts


def _earliest_moving_front(stretches: list[Stretch]) -> tuple[Stretch, float] | None:
    """Return the stretch and the side of the front to advance next; None if no front moves.

    Of all fronts that still move, it is the one whose known path ends first, because each front
    depends on what the others did before.
    """
    earliest_front, earliest_time = None, np.inf
    for stretch, side in product(stretches, SIDES):
        is_moving = stretch.end_reason[side] is None
        if is_moving and stretch.ends[side].time < earliest_time:
            earliest_front, earliest_time = (stretch, side), stretch.ends[side].time
    return earliest_front


def _cut_overrunning_fronts(stretches: list[Stretch]) -> list[tuple[Point, str]]:
    """Cut each front that has run beyond the point where the front of a neighbour has stopped.

    The motion of such a front beyond this point is unknown. Return the points of the cuts, each
    with the reason.
    """
    unknown = []
    for left, right in pairwise(stretches):
        # First the left front of the right stretch may have run over the end of the left stretch.
        # Then the right front of the left stretch may have run over the end of the right stretch.
        for arriving, side, neighbour in ((right, LEFT, left), (left, RIGHT, right)):
            # The front of the neighbour is on its opposite side (LEFT = -1, RIGHT = +1).
            x = neighbour.ends[-side].x
            has_passed = side * arriving.ends[side].x > side * x
            # A stretch without panels is a single point, which has not run anywhere.
            if arriving.panels and has_passed:
                arriving.cut(side, x)
                # Up to this point the front is known, and it ends because it has met another one.
                # What happens after the meeting is unknown, for the reason REASON_OVERRUN.
                arriving.end_reason[side] = "met"
                unknown.append((arriving.ends[side], REASON_OVERRUN))
    return unknown


def _nucleate(fast_front: FastFront) -> list[Stretch]:
    """Return one stretch for each interval that is released at t = 0."""
    nucleations = nucleation_intervals(fast_front.prestress)
    if not nucleations:
        allowed = "a profile that reaches 1 somewhere"
        raise ValueError(f"prestress: below 1 everywhere; allowed: {allowed}")
    stretches = []
    for number, (left, right) in enumerate(nucleations):
        is_first = number == 0
        is_last = number == len(nucleations) - 1
        # The nearest released positions on both sides of this interval.
        end_before = -np.inf if is_first else nucleations[number - 1][1]
        start_after = np.inf if is_last else nucleations[number + 1][0]
        ends = {LEFT: Point(left, 0.0), RIGHT: Point(right, 0.0)}
        # For the left front, x is mirrored: `Stretch` treats both fronts as right fronts.
        stretch = Stretch(ends, next_start={LEFT: -end_before, RIGHT: start_after})
        if left < right:
            # The panels of the interval itself. The pre-stress is at least 1 there, so that T = 0.
            panels, _ = fast_front.panels_to_right(Point(left, 0.0), stop=right, until=np.inf)
            stretch.add(RIGHT, panels, Point(right, 0.0))
        stretches.append(stretch)
    return stretches


def _advance_fast_front(fast_front: FastFront, stretch: Stretch, side: float, until: float) -> None:
    """Advance the front on one side of a stretch while it is faster than the waves.

    The front runs at most up to the next nucleation point, or until a time.

    fast_front : the law of motion for the pre-stress with this side turned to the right, so that
        for the left side it is mirrored at x = 0
    """
    # With this side turned to the right, the front runs from the point start to the position stop.
    # The points in ``ends`` are not turned, but the positions in ``next_start`` are.
    known_end = stretch.ends[side]
    start, stop = Point(side * known_end.x, known_end.time), stretch.next_start[side]
    panels, end = fast_front.panels_to_right(start, stop, until)
    if panels:
        stretch.add(side, panels, end)
    if end.time >= until:
        stretch.end_reason[side] = "duration"
    elif end.x >= stop:
        stretch.end_reason[side] = "met"
    # Otherwise the front has reached negative pre-stress. It is slow from now on.


def _advance_slow_front(fast_front: FastFront, stretch: Stretch, side: float, until: float) -> None:
    """Add one panel to the slow front on one side of a stretch.

    If the front is not followed further, the reason is recorded. If it reaches positive pre-stress,
    it continues as a fast front until a time.

    fast_front : as for `_advance_fast_front`, with this side turned to the right, so that the front
        runs to the right
    """
    piece = fast_front.piece_right_of(side * stretch.ends[side].x)
    # The front is slow up to this position at most: the end of the piece of negative pre-stress, or
    # the next nucleation point.
    mark = min(piece.right, stretch.next_start[side])
    front = SlowFront(
        curve=stretch.curve(side),
        prestress=fast_front.prestress,
        background=piece.background,
        gamma=fast_front.gamma,
        alpha=fast_front.alpha,
    )
    panel, reason, stretch.progress[side] = front.next_panel(mark, stretch.progress[side])
    if panel is not None:
        stretch.add(side, [panel], panel.end)
    end = stretch.ends[side]
    # A front cannot stop in positive pre-stress. If it seems to, its motion is not known.
    if reason == "stops" and fast_front.prestress(side * end.x) > EQUALITY_TOLERANCE:
        reason = "positive_prestress"
    if reason in END_REASONS:
        stretch.end_reason[side] = reason
    elif end.time >= until:
        stretch.end_reason[side] = "duration"
    elif reason == "mark" and mark >= stretch.next_start[side]:
        stretch.end_reason[side] = "met"
    elif reason == "mark" and fast_front.piece_right_of(mark).is_above:
        # The pre-stress is positive beyond the mark.
        stretch.progress[side] = Progress()
        stretch.restarts[side].append(side * mark)
        _advance_fast_front(fast_front, stretch=stretch, side=side, until=until)
    # In all other cases the front is still slow, and the next call adds its next panel.


def _join_met_stretches(stretches: list[Stretch]) -> list[Stretch]:
    """Return the stretches, with neighbours combined if their fronts have met."""
    joined = [stretches[0]]
    for right in stretches[1:]:
        merged = _merge_if_met(joined[-1], right)
        if merged is None:
            joined.append(right)
        else:
            joined[-1] = merged
    return joined


def _merge_if_met(left: Stretch, right: Stretch) -> Stretch | None:
    """Return two neighbouring stretches combined into one, or None if their fronts have not met.

    Both stretches are cut at the position that their fronts reach at the same time. So each
    position belongs to the front that arrives there first.
    """
    # If their known paths do not overlap, the fronts have not met.
    if not (left.panels and right.panels and right.ends[LEFT].x <= left.ends[RIGHT].x):
        return None
    left_curve, right_curve = left.curve(), right.curve()

    def delay_of_left(x: float) -> float:
        """Return how much later the left stretch reaches x than the right one."""
        return float(left_curve.arrival(x) - right_curve.arrival(x))

    # Both stretches have reached the positions from low to high. If their fronts have met, the left
    # stretch arrived first at low, and the right one at high.
    low = max(right.ends[LEFT].x, float(left_curve.edges[0]))
    high = min(left.ends[RIGHT].x, float(right_curve.edges[-1]))
    if not (delay_of_left(low) <= 0.0 <= delay_of_left(high)):
        return None
    x = root_between(delay_of_left, low, high, xtol=1e-14)
    # Like a slow front that becomes fast again, a slow front that meets another one is a restart of
    # the curve, here in the lists of both sides. A slow front takes longer for the last distance
    # than a wave, whose speed is 1.
    left_times = left_curve.arrival(np.array([x - MEETING_DISTANCE, x]))
    right_times = right_curve.arrival(np.array([x, x + MEETING_DISTANCE]))
    durations = np.abs(np.diff([left_times, right_times]))
    is_one_slow = np.any(durations > MEETING_DISTANCE)
    restart = [x] if is_one_slow else []
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
