"""One run as a picture, in one call: for a notebook or a script."""

import io

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.figure import Figure


class Picture(Figure):
    """A figure that a notebook shows as it is, whatever its backend."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=150)
        return buffer.getvalue()


def plot(run: xr.Dataset) -> Picture:
    """Draw pre-stress, slip velocity over time and position with fronts and trailing edge, and the slip at the end.

    run : what `slippulse.simulate` returned; its map is there if it was given ``samples``

    Returns a figure: a notebook shows it, ``figure.savefig("name.png")`` writes it.
    Raises TypeError: if it is not a run (of a sweep, `slippulse.point` takes one).
    """
    drawn = ("prestress", "release_time", "stick_time", "slip")
    known = isinstance(run, xr.Dataset) and "end_time" in run.attrs
    if not known or not all(name in run and run[name].dims == ("x",) for name in drawn):
        raise TypeError(f"run: {type(run).__name__}; allowed: a Dataset that simulate returned")
    # The house style is not forced on the figures of whoever calls.
    with matplotlib.rc_context():
        from .shared import space_time as parts
        from .style import BLUE, PAGE, RC

        matplotlib.rcParams.update(RC)
        front, trailing = parts.edges(run)
        roles = {"prestress": parts.prestress_profile(run), "front": front, "trailing": trailing}
        figure = Picture(figsize=(PAGE, 2.8), layout="constrained")
        profile, times, slip = figure.subplots(1, 3, sharey=True, width_ratios=(0.2, 1.0, 0.3))
        parts.draw_profile(profile, roles["prestress"])
        several = run.sizes.get("sample_time", 0) > 1 and run.sizes.get("sample_position", 0) > 1
        # Else the fronts alone are drawn.
        if several and (run["sample_velocity"] > 0.0).any():
            roles |= {str(role): rows for role, rows in parts.velocity_map(run).groupby("role")}
            image = parts.draw_map(times, roles)
            figure.colorbar(image, ax=times, pad=0.02).set_label(r"slip velocity $\dot u$")
            if run.attrs.get("limit_reason"):
                unknown = (
                    run["sample_time"],
                    run["sample_position"],
                    run["sample_velocity"].isnull().T,
                )
                times.contourf(*unknown, [0.5, 1.5], colors="none", hatches=["///"])
                figure.suptitle(f"hatched: not known, since {run.attrs['limit_reason']}")
        else:
            # A run in which nothing moves ends at 0.
            parts.draw_edges(times, roles, run.attrs["end_time"] or run.attrs["duration"])
        if np.isfinite(run["release_time"]).any():
            times.legend(loc="upper left")
        slip.plot(run["slip"], run["x"], color=BLUE)
        slip.set_xlabel(r"slip $u$")
    return figure
