"""Libraries that most steps use. They are loaded once for all workers of a run."""

# ruff: noqa: F401
import gc
import os

# Several jobs run at the same time, and so the linear algebra of each uses one core.
os.environ["OMP_NUM_THREADS"] = "1"
# Figures do not depend on the display and the style that the user has chosen.
os.environ |= {"MPLBACKEND": "agg", "MATPLOTLIBRC": os.devnull}
# Results contain no date, and some libraries cannot be loaded if this variable is not a number.
os.environ.pop("SOURCE_DATE_EPOCH", None)

import h5py
import matplotlib.backends.backend_pdf
import numba
import scipy.optimize
import xarray

# The first function that is compiled loads most of numba.
numba.njit(lambda: 0)()
# The workers share memory until one of them writes to it. Garbage collection would write to all
# objects. It can be rare, since few objects of a job refer to each other in a cycle.
gc.freeze()
gc.set_threshold(50_000)
