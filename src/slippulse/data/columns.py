"""Units and meaning of every column of a table; data files hold the first of them (`variables`).

python -m slippulse.data.columns > docs/columns.md
"""

from __future__ import annotations

from .variables import VARIABLES

# Per name: units (1: a number, count, text) and meaning.
COLUMNS = VARIABLES | {
    "beyond": ("1", "level beyond the last step, or the right level without one"),
    "front_speed_left": ("1", "speed of the left front over the last share of its path, in wave speeds"),
    "front_speed_right": ("1", "the same of the right front"),
    "front_intercept_left": ("1", "where the line through the left front's path meets t = 0"),
    "front_intercept_right": ("1", "the same of the right front"),
    "front_speed_error_left": ("1", "standard error of the left front's speed"),
    "front_speed_error_right": ("1", "the same of the right front"),
    "transition_time": (
        "1",
        "T_trans: first stick (Gamma = 1), or when the left front has covered measure.share of |x_minus| (Gamma = 0)",
    ),
    "transition_length": ("1", "L_trans: distance between the fronts then, in units of H"),
    "transition_longest_wait": ("1", "longest wait of the left front between two blocks, over T_trans"),
    "transition_state": ("text", "resolved, stalled (held up by the lattice) or not reached"),
    "paper_transition_time": ("1", "T_trans by the paper's formula"),
    "paper_transition_length": ("1", "L_trans by the paper's formula"),
    "balance_distance": ("1", "|x_minus|, in units of H"),
    "last_release_time": ("1", "time of the last release on the left"),
    "last_release_distance": ("1", "distance of the last release on the left, in units of H"),
    "last_release_length": ("1", "distance between the fronts then"),
    "slip_time_background": ("1", "when slip at x = 0 reaches 2 tau_0/gamma"),
    "slip_length_background": ("1", "distance between the fronts then"),
    "slip_time_nucleation": ("1", "when slip at x = 0 reaches 2/gamma"),
    "slip_length_nucleation": ("1", "distance between the fronts then"),
    "largest_velocity": ("1", "largest slip velocity at the end"),
    "largest_velocity_change": ("1", "its relative change over the last third of the run"),
    "pulse_front": ("1", "distance of the right front at the end, in units of H"),
    "pulse_width": ("1", "width of the right pulse at the end, in units of H"),
    "pulse_peak_velocity": ("1", "largest slip velocity of the right pulse"),
    "pulse_slip": ("1", "slip that the right pulse leaves behind"),
    "pulse_stress_drop": ("1", "gamma times that slip"),
    "pulse_acceleration": ("1", "amplitude of slip acceleration in the right pulse"),
    "pulse_state": ("text", "steady, unsteady, thick_front, or none"),
    "slip_variation": ("1", "relative variation of the slip behind the right pulse"),
    "pulse_half_width": ("1", "breadth of the right pulse's slip velocity at half its peak, in units of H"),
    "pulse_shape_deviation": (
        "1",
        "largest distance of the right pulse's slip velocity from the paper's equation (9), over its peak, the peaks"
        " aligned, two blocks from its ends",
    ),
    "lattice_noise": (
        "1",
        "share of the power of slip velocity on the right in waves of a few blocks, by a fourth difference",
    ),
    "sliding_at_once": (
        "count",
        "largest number of blocks on the right that slide at once over the second half",
    ),
    "profile_change": (
        "1",
        "largest change over the last third of the run of the right pulse's velocity profile, moved at the wave speed,"
        " over its largest velocity",
    ),
    "energy_change": ("1", "relative change of its kinetic plus strain energy meanwhile"),
    "strain_left": ("1", "strain left behind where it entered, over the largest strain"),
    "regime": ("text", "crack-like or pulse-like, one-way or two-way, arrested"),
    "centre_velocity_share": ("1", "slip velocity at the centre over the largest"),
    "late_front_speed_left": ("1", "speed of the left front between the last samples"),
    "late_front_speed_right": ("1", "the same of the right front"),
    "trailing_edge_5": (
        "1",
        "position of the right trailing edge at t = 5; likewise for every time of measure.trailing_times",
    ),
    "point": ("count", "number of the run in its simulation, from 0"),
    "quantity": ("text", "which number"),
    "value": ("1", "the number, at the finest spacing"),
    "extrapolated": ("1", "the number at spacing 0, by its observed order"),
    "uncertainty": ("1", "numerical uncertainty of the number"),
    "factor": ("1", "spacing over that of the finest lattice"),
    "promised": ("1", "accuracy that was asked for"),
    "kept": ("text", "whether it is kept"),
    "label": ("text", "how a number or a curve is called"),
    "theory": ("1", "what exact theory has for the number"),
    "role": ("text", "what a row of a figure's table is drawn as"),
    "panel": ("text", "which panel it is drawn in"),
    "series": ("text", "which curve it belongs to"),
    "y": ("1", "vertical axis"),
    "x_end": ("1", "end of an arrow or bar, horizontal"),
    "y_end": ("1", "end of an arrow or bar, vertical"),
    "time": ("1", "time, in units of H over the wave speed"),
    "source": ("text", "exact, lattice, or whose formula"),
    "places": ("count", "points that a mean is over"),
    "position": ("1", "position, in units of H"),
    "field": ("text", "which field is drawn"),
    "state": ("text", "sliding, stuck or untouched"),
    "kind": ("text", "which kind of row"),
    "name": ("text", "name of what is drawn"),
    "text": ("text", "words that are drawn"),
    "scale": ("1", "size of what is drawn"),
    "step": ("1", "time step over dx"),
    "work": ("1", "block updates over sliding blocks and steps"),
    "measured": ("1", "measured number"),
    "exact": ("1", "exact number"),
    "paper": ("1", "number by the paper's formula"),
    "paper_definition": ("1", "the number by the paper's own definition"),
    "expected": ("1", "number that theory expects"),
    "error": ("1", "relative deviation from what is expected"),
    "tolerance": ("1", "largest deviation that counts as right"),
    "verdict": ("text", "what came of it"),
    "message": ("text", "refusal or flag in words"),
    "should": ("text", "what should happen"),
    "family": ("text", "which edge of the domain"),
    "part": ("text", "which part of a study"),
    "scene": ("text", "which scene"),
    "preset": ("text", "which preset of the configuration"),
    "dominated_by": ("text", "a cheaper setting that is as exact"),
    "blocks": ("count", "blocks"),
    "level": ("1", "pre-stress level"),
    "tau0": ("1", "pre-stress level"),
    "thickness_ratio": ("1", "H_r/H, host rock over damage zone"),
    "share": ("1", "share of |x_minus| that the left front has covered"),
    "share_time": ("1", "time at which it has covered the share"),
    "simulation": ("text", "which simulation"),
    "run": ("count", "number of the run"),
    "runs": ("count", "how many runs"),
    "median": ("1", "median deviation"),
    "largest": ("1", "largest deviation"),
    "fixed": ("1", "what is held as the spacing falls"),
    "height": ("1", "height in the layer, in units of H"),
    "row": ("count", "row of a map"),
    "place": ("text", "where a mark is drawn"),
    "speed": ("1", "front speed, in wave speeds"),
    "energy": ("1", "energy residual"),
    "derived": ("1", "derived bound"),
    "measured_ratio": ("1", "measured over derived"),
    "measured_rupture": ("1", "bound measured on a rupture"),
    "measured_rupture_ratio": ("1", "the same over the derived bound"),
    "front_speed": ("1", "relative error of the front speed"),
    "peak_velocity": ("1", "relative error of the largest slip velocity"),
    "final_slip": ("1", "relative error of the final slip"),
    "arrest_position": ("1", "relative error of the arrest position"),
    "arresting_block": ("count", "block at which the left front stops"),
    "before": ("1", "level before the step"),
    "memory": ("1", "distance beyond a change of level after which a pulse is exactly steady, in units of H"),
    "springs": ("1", "leaf springs of the lattice, gamma dx^2"),
    "ratio_arsinh": ("1", "asinh(b/0.005), in even steps"),
    "excess_log": ("1", "ln(v - 1), in even steps"),
    "logit": ("1", "ln(tau/(1 - tau)) of the pre-stress"),
    "barrier": ("1", "pre-stress in the barrier"),
    "length": ("1", "length of a barrier over the exact depth of the pulse in it"),
    "steady": ("1", "the steady pulse's number"),
    "steady_before": ("1", "the same before the step"),
    "beta_from": ("1", "least damping of a range"),
    "beta_to": ("1", "largest damping of a range"),
    "instant": ("1", "when a state is drawn"),
    "axis": ("text", "what varies along the horizontal axis"),
    "observed_order": ("1", "order at which a number converges as the spacing falls"),
    "seconds": ("s", "time on one core, as estimated"),
    "reading": ("text", "which number was read off a published figure"),
    "drawn": ("1", "the number as it was read"),
    "reading_error": ("1", "uncertainty of the reading"),
    "tau0_error": ("1", "uncertainty of the fitted pre-stress level"),
    "gamma_error": ("1", "uncertainty of the fitted elasticity ratio"),
    "correction": ("1", "what the published lattice adds to the exact number"),
    "pull": ("1", "deviation over its uncertainty"),
    "chi2": ("1", "sum of the squared pulls"),
    "x_scale": ("1", "what x is drawn in units of"),
    "y_scale": ("1", "what y is drawn in units of"),
    "searched_to": ("1", "largest step that was tried, over the derived bound"),
    "final": ("text", "regime that exact theory has in the end"),
    "end": ("text", "regime by the state at the end of the run"),
    "coarser": ("count", "coarser lattices on which the regime is another"),
}
# A column of its own for each time that the configuration lists.
TIMES_IN_NAMES = "trailing_edge_"


def is_described(column: str) -> bool:
    """Whether the table of columns explains a column."""
    return column in COLUMNS or column.startswith(TIMES_IN_NAMES)


def is_text(column: str) -> bool:
    """Whether a column may hold text."""
    return COLUMNS.get(column, ("text",))[0] == "text" and not column.startswith(TIMES_IN_NAMES)


def columns_page() -> str:
    """The same as a table in Markdown."""
    rows = [
        f"| `{name}` | {units} | {meaning.replace('|', chr(92) + '|')} |"
        for name, (units, meaning) in sorted(COLUMNS.items())
    ]
    head = "# Every column\n\nOf netCDF files and CSV tables; made by `python -m slippulse.data.columns`.\n"
    return "\n".join([head, "| name | units | meaning |", "|---|---|---|", *rows]) + "\n"


if __name__ == "__main__":
    print(columns_page(), end="")
