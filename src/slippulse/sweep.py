"""Many scenes in, one Dataset with a ``point`` dimension out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

import numpy as np
import xarray as xr

from .lattice.samples import Samples
from .model import Scene
from .points import FIELDS, FRONTS
from .simulation import VARIABLES, simulate

RECORDS = ("fronts", "fields", "samples")


def run_sweep(
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None] | None = None,
    record: Sequence[str] = ("fronts",),
    threads: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Run scenes in a pool of threads, the most expensive first.

    Parameters
    ----------
    scenes : the scenes, one point each
    samples : per scene, where and when to record; all of one shape
    record : what is kept per block: "fronts" (release and stick times), "fields" (slip, velocity, acceleration at
        the end); "samples" (the recorded samples)
    threads : how many run at once; the result does not depend on it
    progress : called with (done, all) after each scene

    Returns
    -------
    Dataset with every parameter and number of the runs over ``point``; per-block variables as contiguous ragged
    arrays over ``block``, ``row_size`` blocks a point; samples over (point, time, position).
    """
    samples = list(samples) if samples is not None else [None] * len(scenes)
    results: list[xr.Dataset | None] = [None] * len(scenes)
    order = sorted(range(len(scenes)), key=lambda i: -expected_cost(scenes[i]))
    with ThreadPoolExecutor(max_workers=max(1, threads)) as pool:
        futures = {pool.submit(simulate, scenes[i], samples[i]): i for i in order}
        try:
            for done, future in enumerate(as_completed(futures), start=1):
                results[futures[future]] = future.result()
                if progress is not None:
                    progress(done, len(scenes))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return combine([result for result in results if result is not None], record)


def expected_cost(scene: Scene) -> float:
    """Block updates a scene may need, up to a factor: fronts at the wave speed and a crack between them."""
    width = scene.duration
    if scene.boundary == "displacement":
        width = min(width, np.pi / np.sqrt(scene.gamma))
    return scene.duration / scene.dx * (width / scene.dx)


def combine(results: Sequence[xr.Dataset], record: Sequence[str]) -> xr.Dataset:
    """Put the runs of a sweep into one Dataset."""
    first = results[0]
    per_point = {
        name: ("point", np.array([result.attrs[name] for result in results]))
        for name in first.attrs
        if name != "versions"
    }
    out = xr.Dataset(per_point)
    for name in out.variables:
        # Parameters and counts carry their meaning in their name; all are non-dimensional.
        out[name].attrs = {"units": "1", "long_name": name.replace("_", " ")}
    kept = (
        "x",
        "prestress",
        *(FRONTS if "fronts" in record else ()),
        *(FIELDS if "fields" in record else ()),
    )
    if len(kept) > 2:
        out["row_size"] = ("point", np.array([result.sizes["x"] for result in results]))
        out["row_size"].attrs = {
            "units": "1",
            "long_name": "number of blocks of a point",
            "sample_dimension": "block",
        }
        for name in kept:
            out[name] = ("block", np.concatenate([result[name].values for result in results]))
    if "samples" in record:
        out["sample_time"] = (
            ("point", "time"),
            np.stack([result["sample_time"].values for result in results]),
        )
        out["sample_position"] = (
            ("point", "position"),
            np.stack([result["sample_position"].values for result in results]),
        )
        for name in ("sample_slip", "sample_velocity"):
            out[name] = (("point", "time", "position"), np.stack([result[name].values for result in results]))
    for name in set(out.variables) & set(VARIABLES):
        units, long_name = VARIABLES[name]
        out[name].attrs = {"units": units, "long_name": long_name}
    out.attrs = {"versions": first.attrs["versions"]}
    return out
