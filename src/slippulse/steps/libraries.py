"""Libraries that most steps use, loaded once for all jobs of a run; nothing of ours, which may be edited meanwhile."""

import gc
import os

# Jobs run side by side: the linear algebra of each keeps to one core.
os.environ["OMP_NUM_THREADS"] = "1"

import h5py  # noqa: F401
import matplotlib.backends.backend_pdf
import matplotlib.pyplot  # noqa: F401
import numba
import scipy.optimize
import scipy.special  # noqa: F401
import xarray  # noqa: F401

# The first function compiled loads most of numba.
numba.njit(lambda: 0)()
# Memory that nobody touches is shared with every job.
gc.freeze()
