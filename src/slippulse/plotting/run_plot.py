"""A run as a picture, in one call: for a notebook or a script."""

import io

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..model.layer_units import Layer, layer_of
from ..model.scene import check_run_attributes
from . import space_time
from .si_tables import table_in_si, with_unit
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

    The edges are the front (time of first release) and the trailing edge (time of stick). The
    panels follow the space-time figure of the paper (figure 4). Quantities are dimensionless, or
    have the units on the axes if the run is in SI units.

    Parameters
    ----------
    run : xarray.Dataset
        A run over x that `slippulse.simulate` returned or `Layer.to_si` converted. The slip
        velocity is drawn if the run has samples in which anything slides; otherwise the edges are
        drawn alone.

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
    layer = layer_of(run.attrs)
    if layer is not None:
        run = layer.from_si(run)
    check_run_attributes(run.attrs)
    with house_style():
        return _draw(run, layer)


def _draw(run: xr.Dataset, layer: Layer | None) -> Picture:
    slipped = {"series": "slip", "position": run["x"].values, "value": run["slip"].values}
    rows = [space_time.prestress_profile(run), *space_time.edges(run)]
    rows.append(pd.DataFrame({"role": "profile", **slipped}))
    sampled = run.sizes.get("sample_time", 0) > 1 and run.sizes.get("sample_position", 0) > 1
    moves = sampled and bool((run["sample_velocity"] > 0.0).any())
    if moves:
        rows.append(space_time.velocity_map(run))
    # A run in which nothing moves ends at 0.
    end = run.attrs["end_time"] or run.attrs["duration"]
    rows.append(pd.DataFrame({"role": ["end"], "time": [end]}))
    table = pd.concat(rows, ignore_index=True)
    roles = {"front": table.iloc[:0], "trailing": table.iloc[:0]}
    roles |= by_role(table if layer is None else table_in_si(table, layer))
    figure = Picture(figsize=(PAGE, 2.8), layout="constrained")
    profile, times, slip = figure.subplots(1, 3, sharey=True, width_ratios=(0.2, 1.0, 0.3))
    space_time.draw_profile(profile, roles)
    if moves:
        space_time.draw_map(times, roles)
        if run.attrs.get("limit_reason"):
            _hatch_unknown(times, run, roles)
            figure.suptitle(f"hatched: not known, since {run.attrs['limit_reason']}")
    else:
        space_time.draw_edges(times, roles, roles["end"]["time"].iloc[0])
    if np.isfinite(run["release_time"]).any():
        times.legend(loc="upper left")
    slip.plot(roles["profile"]["value"], roles["profile"]["position"], color=BLUE)
    slip.set_xlabel(with_unit(r"slip $u$", roles, "slip"))
    return figure


def _hatch_unknown(axes: Axes, run: xr.Dataset, roles: dict[str, pd.DataFrame]) -> None:
    """Hatch the part of the map that the exact solution does not reach."""
    unknown = run["sample_velocity"].isnull().T
    # Coordinates of the axes for one unit of the model.
    scale_of_time = roles["end"]["time"].iloc[0] / run.attrs["end_time"]
    drawn = roles["profile"]["position"]
    scale_of_position = np.ptp(drawn) / np.ptp(run["x"].values)
    hatched: dict = {"levels": [0.5, 1.5], "colors": "none", "hatches": ["///"]}
    times, positions = (
        run["sample_time"] * scale_of_time,
        run["sample_position"] * scale_of_position,
    )
    axes.contourf(times, positions, unknown, **hatched)
