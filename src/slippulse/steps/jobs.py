"""What a job of the pipeline does: files in, files out. The pipeline's scripts call these and nothing else."""

from __future__ import annotations

import atexit
import contextlib
import errno
import gc
import os
import sys
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path

# New objects between two searches for cyclic garbage: loading the libraries, a third of a short job, makes fewer.
OBJECTS_BETWEEN_SEARCHES = 1_000_000


@contextlib.contextmanager
def job(log: str | Path) -> Iterator[None]:
    """All that a process does: what it says goes to its log too, and with its last file closed it is gone.

    To take the interpreter apart object by object would be 0.2 s more of every job.
    """
    gc.set_threshold(OBJECTS_BETWEEN_SEARCHES)
    with logged(log):
        yield
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


@contextlib.contextmanager
def logged(path: str | Path) -> Iterator[None]:
    """Copy what a job says to its log; a failure is one line on the terminal and a traceback in the log."""
    terminal = sys.stderr
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        log = open(path, "w", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        terminal.write(f"{path}: {error.strerror}; allowed: a results folder that can be written\n")
        raise SystemExit(1) from None
    sys.stderr = _Both(terminal, log)
    try:
        yield
    except Exception as error:
        # A disk that is full has no room for the log either.
        with contextlib.suppress(OSError):
            log.write(traceback.format_exc())
        terminal.write(f"{_reason(error)} (details: {path})\n")
        raise SystemExit(1) from None
    finally:
        sys.stderr = terminal
        with contextlib.suppress(OSError):
            log.close()


def _reason(error: Exception) -> str:
    """One line: HDF5 says in several, with addresses, that a disk is full."""
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
        return f"{os.strerror(error.errno)}: what was being written is removed; make room and run again"
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


class _Both:
    """A stream that writes to two."""

    def __init__(self, *streams) -> None:
        self.streams = streams

    def write(self, text: str) -> int:
        for stream in self.streams:
            stream.write(text)
        return len(text)

    def flush(self) -> None:
        for stream in self.streams:
            stream.flush()


def compile_kernels(output: str | Path) -> None:
    """Compile every kernel, and note the digest of their sources."""
    from ..data.store import write_whole
    from ..solver.compilation import compile_all
    from ..solver.jit import source_digest

    compile_all()
    digest = source_digest()
    write_whole(output, lambda part: part.write_text(f"{digest}\n", encoding="utf-8"))


def simulate_block(name: str, block: Mapping, threads: int, output: str | Path) -> None:
    """Run the scenes of one simulation block and write their data."""
    from ..configuration.expand import expand
    from ..data.store import save_dataset
    from ..simulation.sweep import run_sweep

    scenes, samples = expand(block)
    shown = time.monotonic()

    def progress(done: int, total: int) -> None:
        nonlocal shown
        if done == total or time.monotonic() - shown > 2.0:
            shown = time.monotonic()
            sys.stderr.write(f"  {name}: {done} of {total} runs\n")
            sys.stderr.flush()

    sweep = run_sweep(scenes, samples, block["record"], threads, progress)
    flags = [run for run in sweep["flags"].values if run]
    for kind in sorted(set(flags)):
        sys.stderr.write(
            f"  {name}: {flags.count(kind)} of {len(scenes)} runs are flagged {kind} (in the data, point by point)\n"
        )
    save_dataset(sweep, output)


def measure_block(data: str | Path, settings: Mapping, output: str | Path) -> None:
    """Measure every run of one simulation block and write the table."""
    from ..comparison.table import measured_table
    from ..data.store import load_dataset, save_table

    save_table(measured_table(load_dataset(data), settings), output)


def study_grid(
    name: str,
    finest: str | Path,
    blocks: Mapping[float, Mapping],
    settings: Mapping,
    threads: int,
    uncertainties: str | Path,
    tables: str | Path,
) -> None:
    """Run and measure one simulation block on coarser lattices, and write the grid study of every number.

    ``blocks`` holds the resolved block by factor of the spacing; where it promises an accuracy, the study says of each
    number whether it is kept. The coarser data are not kept, their measured tables are, one below the other with their
    factor. The study of a chunk has every number that the sweep's may have.
    """
    import pandas as pd

    from ..comparison.table import measured_table
    from ..configuration.expand import expand, promise_of
    from ..data.store import load_table, save_table
    from ..measure.promise import judged, summary
    from ..measure.table import PARAMETERS
    from ..measure.uncertainty import grid_tables
    from ..simulation.sweep import run_sweep

    part = any("chunk" in block for block in blocks.values())
    coarser = {}
    for factor in sorted(blocks):
        sys.stderr.write(f"  {name}: {factor:g} times the spacing\n")
        scenes, samples = expand(blocks[factor])
        coarser[factor] = measured_table(
            run_sweep(scenes, samples, blocks[factor]["record"], threads), settings
        )
    # A column of fractions may happen to have none in a chunk.
    measured = load_table(finest, whole=PARAMETERS if part else None)
    study = grid_tables((measured, *coarser.values()), tuple(coarser), PARAMETERS)
    promise = promise_of(next(iter(blocks.values())))
    if promise is not None:
        study = judged(study, measured, promise, settings["share"])
        sys.stderr.write(f"  {name}: {summary(study, promise)}\n")
    save_table(study, uncertainties)
    save_table(
        pd.concat([table.assign(factor=factor) for factor, table in coarser.items()], ignore_index=True),
        tables,
    )


def join_data(data: Sequence[str], record: Sequence[str], output: str | Path) -> None:
    """Put the data of a sweep's chunks into one file."""
    from ..data.join import join_datasets
    from ..data.store import save_dataset

    save_dataset(join_datasets(data, record), output)


def join_measurements(measured: Sequence[str], output: str | Path) -> None:
    """Put the measured tables of a sweep's chunks into one."""
    from ..data.join import count_rows, joined_table, save_rows

    save_rows(joined_table(measured, count_rows(measured)), output)


def join_uncertainties(
    finest: str | Path,
    uncertainties: Sequence[str],
    coarser: Sequence[str],
    outputs: Mapping[str, str],
) -> None:
    """Put the grid studies of a sweep's chunks into one, and their tables on the coarser lattices."""
    from ..data.join import joined_grid_study, joined_table, save_rows
    from ..data.store import load_table
    from ..measure.table import PARAMETERS
    from ..measure.uncertainty import quantities

    measured = load_table(finest)
    studied = quantities(measured, PARAMETERS)
    save_rows(joined_grid_study(uncertainties, measured, PARAMETERS, studied), outputs["uncertainties"])
    save_rows(joined_table(coarser, len(measured), last=("factor",)), outputs["tables"])


def write_claims(
    measured: Sequence[str],
    coarser: Sequence[str],
    uncertainties: Sequence[str],
    tolerances: Mapping,
    share: float,
    readings: Mapping,
    outputs: Mapping[str, str],
) -> None:
    """Compute every claim's verdict and write the ledger, as JSON and as a table to read."""
    import json

    from ..claims.evidence import Evidence
    from ..claims.paper import all_claims
    from ..data.store import load_table, write_whole
    from ..pages.claims import claims_page

    tables = {Path(path).stem: load_table(path) for path in measured}
    coarse: dict[str, list] = {}
    for path in coarser:
        table = load_table(path)
        coarse[Path(path).stem] = [part.reset_index(drop=True) for _, part in table.groupby("factor")]
    studies = {Path(path).stem: load_table(path) for path in uncertainties}
    claims = [
        claim.as_dict()
        for claim in all_claims(Evidence(tables, coarse, studies, tolerances), share, readings)
    ]
    texts = {
        "json": json.dumps(claims, indent=1, ensure_ascii=False) + "\n",
        "html": claims_page(claims),
    }
    for kind, text in texts.items():
        write_whole(outputs[kind], lambda part, text=text: part.write_text(text, encoding="utf-8"))


def run_study(study: str, settings: Mapping, output: str | Path) -> None:
    """Run one study of the solver and write its table."""
    from ..data.store import save_table

    save_table(import_module(f"slippulse.studies.{study}").table(settings), output)


def draw_pipeline_time(benchmarks: str, results: str, outputs: Mapping[str, str]) -> None:
    """Summarise Snakemake's benchmark files in a table and a figure drawn from it."""
    from ..data.store import load_table, save_table
    from ..figures.pipeline_time import plot, table
    from ..figures.style import save_figure

    save_table(table(benchmarks, results), outputs["csv"])
    save_figure(plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])


def draw_figure(
    figure: str, settings: Mapping, data: Sequence[str], measured: Sequence[str], outputs: Mapping[str, str]
) -> None:
    """Write the table of one figure, then draw the figure from that table alone."""
    from ..data.store import load_dataset, load_table, save_table
    from ..figures.style import save_figure

    module = import_module(f"slippulse.figures.{figure}")
    table = module.table(
        {Path(path).stem: load_dataset(path) for path in data},
        {Path(path).stem: load_table(path) for path in measured},
        settings,
    )
    save_table(table, outputs["csv"])
    save_figure(module.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])


def write_report(
    files: Mapping,
    figures: Sequence[str],
    config: Mapping,
    outputs: Mapping[str, str],
) -> None:
    """Execute the replication report and write it as HTML and PDF.

    ``files`` has `source`, `claims` and `shipped`, and the lists `measured`,
    `uncertainties` and `figures` (their PDFs).
    """
    from ..report.build import build_report
    from ..report.inputs import Inputs

    def absolute(path: str) -> str:
        return str(Path(path).resolve())

    inputs = Inputs(
        config=config,
        claims_file=absolute(files["claims"]),
        measured={Path(path).stem: absolute(path) for path in files["measured"]},
        uncertainties={Path(path).stem: absolute(path) for path in files["uncertainties"]},
        figures=list(figures),
        figures_folder=absolute(str(Path(files["figures"][0]).parent)),
        manuscript=absolute(str(Path(files["source"]).parent)),
        shipped_config=absolute(files["shipped"]),
    )
    build_report(inputs, outputs)


def draw_scene(
    name: str, title: str, data: str, study: str, share: float, outputs: Mapping[str, str]
) -> None:
    """Write the numbers, the table, the figure and the page of one scene."""
    from ..comparison.scene_numbers import scene_numbers
    from ..data.points import point
    from ..data.store import load_dataset, load_table, save_table, write_whole
    from ..figures import scene
    from ..figures.style import save_figure
    from ..pages.scene import scene_page

    run = point(load_dataset(data), 0)
    numbers = scene_numbers(run.attrs, load_table(study), share)
    save_table(numbers, outputs["numbers"])
    save_table(scene.table(run, numbers, {"title": title}), outputs["csv"])
    save_figure(scene.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])
    text = scene_page(name, title, outputs["png"], numbers, run.attrs)
    write_whole(outputs["html"], lambda part: part.write_text(text, encoding="utf-8"))


def animate_scene(title: str, data: str, output: str) -> None:
    """Write the animation of one scene."""
    from ..data.points import point
    from ..data.store import load_dataset
    from ..figures.scene_animation import animate, save_animation

    save_animation(animate(point(load_dataset(data), 0), title), output)


def write_provenance(
    root: str,
    config: Mapping,
    shipped: Mapping,
    files: Sequence[str],
    captions: str,
    outputs: Mapping[str, str],
) -> None:
    """Write what the results were made from, their checksums and their manifest."""
    import json

    from ..data.provenance import checksums, manifest, provenance
    from ..data.store import write_whole
    from ..texts.captions import read_captions

    base = Path(outputs["provenance"]).parent
    facts = provenance(root, config, shipped, base / "benchmarks")
    comments = {name: caption.title for name, caption in read_captions(captions).items()}
    texts = {
        "checksums": checksums(files, base),
        "manifest": manifest(files, base, comments),
        "provenance": json.dumps(facts, indent=1, ensure_ascii=False) + "\n",
    }
    for name, text in texts.items():
        write_whole(outputs[name], lambda part, text=text: part.write_text(text, encoding="utf-8"))


def write_index(
    texts: Mapping[str, str], galleries: Mapping[str, Sequence[str]], scenes: Mapping[str, str], output: str
) -> None:
    """Write the page that leads to all results, beside claims.json and provenance.json."""
    from ..data.store import write_whole
    from ..pages.index import index_page

    text = index_page(Path(output).parent, texts, galleries, scenes)
    write_whole(output, lambda part: part.write_text(text, encoding="utf-8"))


def write_scenes_page(scenes: Mapping[str, str], output: str) -> None:
    """Write the list of scenes."""
    from ..data.store import write_whole
    from ..pages.scene import scenes_page

    write_whole(output, lambda part: part.write_text(scenes_page(scenes), encoding="utf-8"))
