"""What most steps use, loaded once for all jobs of a run; of the project, as it stands when the run begins."""

import gc
import os
from contextlib import suppress

# Jobs run side by side: the linear algebra of each keeps to one core.
os.environ["OMP_NUM_THREADS"] = "1"

import matplotlib.backends.backend_pdf
import matplotlib.pyplot  # noqa: F401
import numba
import scipy.optimize
import scipy.special  # noqa: F401
from matplotlib.mathtext import MathTextParser

# The first function compiled loads most of numba.
numba.njit(lambda: 0)()
# Most jobs. One that is at fault is loaded again by its jobs, which say so.
with suppress(Exception):
    from ..data.versions import versions
    from . import draw_figure, draw_scene, job, measure, predict, simulate, study_grid  # noqa: F401

    versions()
# The first formula sets up the grammar of all, and finds its fonts.
MathTextParser("path").parse("$x$")
# Memory that nobody touches is shared with every job; of what a job makes little is a cycle.
gc.freeze()
gc.set_threshold(50_000)
