"""A picture of a run, drawn by one call in a notebook or a script."""

import io

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..data.points import SAMPLE_AXES
from ..model.layer_units import Layer, layer_of
from ..model.scene import check_run_attributes
from . import space_time
from .si_tables import table_in_si, with_unit
from .style import BLUE, PAGE_WIDTH, by_role, house_style

# A run must have these variables to be drawn.
DRAWN_VARIABLES = ("prestress", "release_time", "stick_time", "slip")


class Picture(Figure):
    """A figure that a notebook shows with any backend of Matplotlib."""

    def _repr_png_(self) -> bytes:
        """Return the PNG file that the notebook shows."""
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=150)
        return buffer.getvalue()


def plot(run: xr.Dataset) -> Picture:
    """Draw pre-stress, slip velocity as a function of time and position, and final slip of a run.

    The map of slip velocity also shows the front (time of first release) and the trailing edge
    (time of stick). The panels are arranged as in the space-time figure of the paper (figure 4).
    Quantities are dimensionless, unless the run is in SI units.

    Parameters
    ----------
    run : xarray.Dataset
        A run with the dimension x that `slippulse.simulate` returned or `Layer.to_si` converted.
        The slip velocity is drawn if the run has samples in which anything slides. Otherwise only
        the front and the trailing edge are drawn.

    Returns
    -------
    Picture
        A Matplotlib figure. A notebook shows it, and ``savefig("name.png")`` writes it.

    Raises
    ------
    TypeError
        If `run` is not such a Dataset. `slippulse.point` takes one run out of a sweep, which can be
        drawn if the sweep was recorded with ``record=("fronts", "fields")``.
    ValueError
        If an attribute of the run is invalid.

    Examples
    --------
    >>> import numpy as np
    >>> import slippulse as sp
    >>> scene = sp.Scene("stress", sp.Prestress(-0.5, 0.0), duration=8.0, dx=0.05)
    >>> samples = sp.Samples(np.linspace(0.0, 8.0, 81), np.linspace(-9.0, 9.0, 181))
    >>> figure = sp.plot(sp.simulate(scene, samples))
    """
    _check_drawable(run)
    layer = layer_of(run.attrs)
    if layer is not None:
        run = layer.from_si(run)
    check_run_attributes(run.attrs)
    with house_style():
        return _draw(_in_order(run), layer)


def _check_drawable(run: object) -> None:
    """Raise TypeError if the argument is not one run that has all drawn variables."""
    # Only sweeps have these dimensions.
    if isinstance(run, xr.Dataset) and {"point", "block"} & {*run.dims}:
        problem, allowed = "a sweep", "one run of the sweep, such as point(sweep, 0)"
    elif not isinstance(run, xr.Dataset) or "end_time" not in run.attrs:
        problem, allowed = type(run).__name__, "a Dataset that simulate returned"
    else:
        missing = [name for name in DRAWN_VARIABLES if name not in run or run[name].dims != ("x",)]
        if not missing:
            return
        problem = f"without {', '.join(missing)}"
        allowed = "a run with these data; a sweep records them if record is ('fronts', 'fields')"
    raise TypeError(f"run: {problem}; allowed: {allowed}")


def _in_order(run: xr.Dataset) -> xr.Dataset:
    """Return a run with each sampled time and position once, in ascending order."""
    for name in SAMPLE_AXES:
        if name in run.dims:
            _, indices = np.unique(run[name], return_index=True)
            run = run.isel({name: indices})
    return run


def _draw(run: xr.Dataset, layer: Layer | None) -> Picture:
    """Draw the panels, in SI units if a layer is given."""
    table = _drawn_table(run)
    # The rows of the table by their role: what they show, such as "map" or "front".
    rows_by_role = by_role(table if layer is None else table_in_si(table, layer))
    # A run in which no block was released has no rows of the front and of the trailing edge.
    for role in ("front", "trailing"):
        rows_by_role.setdefault(role, table.iloc[:0])
    figure = Picture(figsize=(PAGE_WIDTH, 2.8), layout="constrained")
    panels = figure.subplots(1, 3, sharey=True, width_ratios=(0.2, 1.0, 0.3))
    prestress_axes, map_axes, slip_axes = panels
    space_time.draw_profile(prestress_axes, rows_by_role)
    if "map" in rows_by_role:
        space_time.draw_map(map_axes, rows_by_role)
        # An exact solution that is not known everywhere gives the reason.
        if run.attrs.get("limit_reason"):
            _hatch_unknown(map_axes, run, rows_by_role)
            figure.suptitle(f"hatched: solution not known, because {run.attrs['limit_reason']}")
    else:
        space_time.draw_edges(map_axes, rows_by_role, rows_by_role["end"]["time"].iloc[0])
    if np.isfinite(run["release_time"]).any():
        space_time.add_map_legend(map_axes)
    final_slip = rows_by_role["profile"]
    slip_axes.plot(final_slip["value"], final_slip["position"], color=BLUE)
    slip_axes.set_xlabel(with_unit(r"slip $u$", rows_by_role, "slip"))
    return figure


def _drawn_table(run: xr.Dataset) -> pd.DataFrame:
    """Return everything that the panels show, with a role in each row.

    The roles are:

    prestress : pre-stress as a function of position
    front, trailing : times of first release and of last stick as functions of position
    map, largest : sampled slip velocity and its maximum, if anything slides in the samples
    profile : final slip as a function of position
    end : the time at which the run ends
    """
    slip = {"series": "slip", "position": run["x"].values, "value": run["slip"].values}
    rows = [space_time.prestress_rows(run), *space_time.edge_rows(run)]
    rows.append(pd.DataFrame({"role": "profile", **slip}))
    has_samples = run.sizes.get("sample_time", 0) > 1 and run.sizes.get("sample_position", 0) > 1
    if has_samples and bool((run["sample_velocity"] > 0.0).any()):
        rows.append(space_time.velocity_rows(run))
    # The end time of a run in which nothing moves is 0.
    end = run.attrs["end_time"] or run.attrs["duration"]
    rows.append(pd.DataFrame({"role": ["end"], "time": [end]}))
    return pd.concat(rows, ignore_index=True)


def _hatch_unknown(axes: Axes, run: xr.Dataset, rows_by_role: dict[str, pd.DataFrame]) -> None:
    """Hatch the part of the map in which the exact solution is not known."""
    # Positions are the rows of the map, and times its columns.
    is_unknown = run["sample_velocity"].isnull().transpose("sample_position", "sample_time")
    # The axes may be in SI units. These factors convert dimensionless numbers to their units.
    time_scale = rows_by_role["end"]["time"].iloc[0] / run.attrs["end_time"]
    drawn_positions = rows_by_role["profile"]["position"]
    position_scale = np.ptp(drawn_positions) / np.ptp(run["x"].values)
    # Between these levels the mask is True (1).
    hatched: dict = {"levels": [0.5, 1.5], "colors": "none", "hatches": ["///"]}
    times = run["sample_time"] * time_scale
    positions = run["sample_position"] * position_scale
    axes.contourf(times, positions, is_unknown, **hatched)
