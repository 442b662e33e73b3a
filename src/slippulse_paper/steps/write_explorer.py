"""Write the explorer: a page with sliders for the parameters of a rupture."""

from slippulse.data.files import write_text
from slippulse.data.tables import load_table
from slippulse.plotting.style import VELOCITY_MAP

from ..report.explorer_page import explorer_page

# Simulations whose measured numbers the page shows.
SIMULATIONS = [
    "scaling_displacement",
    "damping_displacement",
    "pulse_damping",
    "steady_displacement",
    "any_prestress",
]


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the page ``html`` from the table ``law`` and the tables ``measured``.

    ``law`` is the table of the study `explorer_law`.
    """
    measured = [load_table(path) for path in files["measured"]]
    write_text(explorer_page(load_table(files["law"]), measured, VELOCITY_MAP), outputs["html"])
