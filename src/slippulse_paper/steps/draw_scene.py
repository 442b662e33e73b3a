"""Write the numbers, the table, the figure and the page of one scene."""

from slippulse.data.files import write_text
from slippulse.data.point import point
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.model.layer_units import Layer
from slippulse.plotting.style import house_style, save_figure

from ..figures import scene_figure as scene
from ..figures.shared.main_numbers import numbers_in_si, scene_numbers, without_invalid_predictions
from ..report.scene_page import scene_page


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the table of main numbers, the figure with its table, and the page of a scene.

    The outputs are ``numbers`` and ``csv`` (tables), ``png`` and ``pdf`` (the figure) and ``html``.
    The files are the ``data`` of the scene and its tables ``measured``, ``predicted`` and
    ``uncertainties``. The settings have the title of the scene, a note on altered parameters
    (``altered``), and the parameters of its layer in SI units or None.
    """
    title, note = settings["title"], settings["altered"]
    layer = Layer(**settings["layer"]) if settings.get("layer") else None
    # A scene is a simulation of one run, whose number is 0.
    data = point(load_dataset(files["data"]), 0)
    row = load_table(files["measured"]).join(load_table(files["predicted"])).iloc[0]
    # Predictions for a constant pre-stress are invalid if the pre-stress varies ahead of a front.
    row = without_invalid_predictions(row)
    numbers = scene_numbers(row, load_table(files["uncertainties"]))
    if layer is not None:
        numbers = numbers_in_si(numbers, row, layer)
    save_table(numbers, outputs["numbers"])
    table = scene.table(data, numbers, row, title, layer)
    save_table(table.assign(altered=note) if note else table, outputs["csv"])
    with house_style():
        save_figure(scene.draw(load_table(outputs["csv"])), outputs["png"], outputs["pdf"], note)
    values = data.attrs | {"pulse_state": row["pulse_state"]}
    page = scene_page(settings["scene"], title, outputs["png"], numbers, values, note, layer)
    write_text(page, outputs["html"])
