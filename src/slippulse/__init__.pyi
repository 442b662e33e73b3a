# The public names, which the package loads when they are used.
from . import theory as theory
from .data.point import point as point
from .data.sweep_views import as_grid as as_grid
from .data.sweep_views import open_sweep as open_sweep
from .model.friction import friction as friction
from .model.layer_units import Layer as Layer
from .model.prestress import Prestress as Prestress
from .model.rough_prestress import rough as rough
from .model.samples import Samples as Samples
from .model.scene import Scene as Scene
from .plotting.run_plot import plot as plot
from .prediction.measured_run import measure as measure
from .simulation.accuracy import settings_for as settings_for
from .simulation.parameter_product import sweep as sweep
from .simulation.simulate import UnresolvedRun as UnresolvedRun
from .simulation.simulate import run_sweep as run_sweep
from .simulation.simulate import simulate as simulate
from .solver.lattice import UnstableRun as UnstableRun

__version__: str
