"""Libraries that most steps use, loaded once for all workers of a run."""

# ruff: noqa: F401
import gc
import os

# Jobs run side by side: the linear algebra of each keeps to one core.
os.environ["OMP_NUM_THREADS"] = "1"
# Figures are files in the house style, whatever display and style the user has chosen.
os.environ |= {"MPLBACKEND": "agg", "MATPLOTLIBRC": os.devnull}
# Results carry no date, and some libraries cannot be loaded if this one is not a number.
os.environ.pop("SOURCE_DATE_EPOCH", None)

import h5py
import matplotlib.backends.backend_pdf
import numba
import scipy.optimize
import xarray

# The first function that is compiled loads most of numba.
numba.njit(lambda: 0)()
# The workers share memory that none of them touches; few objects that jobs make are in cycles.
gc.freeze()
gc.set_threshold(50_000)
