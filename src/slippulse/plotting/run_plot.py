"""A run as a picture, in one call: for a notebook or a script."""

import io

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ..model.scene import check_run_attributes
from . import space_time
from .style import BLUE, PAGE, by_role, house_style

DRAWN = ("prestress", "release_time", "stick_time", "slip")


class Picture(Figure):
    """A figure that a notebook shows, whatever its backend."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=150)
        return buffer.getvalue()


def plot(run: xr.Dataset) -> Picture:
    """Draw a run: pre-stress, slip velocity over time and position with both edges, final slip.

    The edges are the front (time of first release) and the trailing edge (time of stick). All
    quantities are dimensionless; the panels follow the space-time figure of the paper (figure 4).

    Parameters
    ----------
    run : xarray.Dataset
        A run over x that `slippulse.simulate` returned. The slip velocity is drawn if the run has
        samples in which anything slides; otherwise the edges are drawn alone.

    Returns
    -------
    Picture
        A Matplotlib figure. A notebook shows it, and ``savefig("name.png")`` writes it.

    Raises
    ------
    TypeError
        If `run` is no such Dataset; `slippulse.point` takes one run out of a sweep.
    ValueError
        If an attribute of it is not of its kind.

    Examples
    --------
    >>> import numpy as np
    >>> import slippulse as sp
    >>> scene = sp.Scene("stress", sp.Prestress(-0.5, 0.0), duration=8.0, dx=0.05)
    >>> samples = sp.Samples(np.linspace(0.0, 8.0, 81), np.linspace(-9.0, 9.0, 181))
    >>> figure = sp.plot(sp.simulate(scene, samples))
    """
    known = isinstance(run, xr.Dataset) and "end_time" in run.attrs
    if not known or not all(name in run and run[name].dims == ("x",) for name in DRAWN):
        raise TypeError(f"run: {type(run).__name__}; allowed: a Dataset that simulate returned")
    check_run_attributes(run.attrs)
    with house_style():
        return _draw(run)


def _draw(run: xr.Dataset) -> Picture:
    figure = Picture(figsize=(PAGE, 2.8), layout="constrained")
    profile, times, slip = figure.subplots(1, 3, sharey=True, width_ratios=(0.2, 1.0, 0.3))
    roles = {"prestress": space_time.prestress_profile(run)}
    roles["front"], roles["trailing"] = space_time.edges(run)
    space_time.draw_profile(profile, roles["prestress"])
    sampled = run.sizes.get("sample_time", 0) > 1 and run.sizes.get("sample_position", 0) > 1
    if sampled and (run["sample_velocity"] > 0.0).any():
        roles |= by_role(space_time.velocity_map(run))
        space_time.draw_map(times, roles)
        if run.attrs.get("limit_reason"):
            # The exact run does not reach this part of the map.
            unknown = run["sample_velocity"].isnull().T
            hatched: dict = {"levels": [0.5, 1.5], "colors": "none", "hatches": ["///"]}
            times.contourf(run["sample_time"], run["sample_position"], unknown, **hatched)
            figure.suptitle(f"hatched: not known, since {run.attrs['limit_reason']}")
    else:
        # A run in which nothing moves ends at 0.
        space_time.draw_edges(times, roles, run.attrs["end_time"] or run.attrs["duration"])
    if np.isfinite(run["release_time"]).any():
        times.legend(loc="upper left")
    slip.plot(run["slip"], run["x"], color=BLUE)
    slip.set_xlabel(r"slip $u$")
    return figure
