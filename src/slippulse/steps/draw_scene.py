"""Write the numbers, the table, the figure and the page of one scene."""

from __future__ import annotations

from collections.abc import Mapping

from ..comparison.scene_numbers import scene_numbers
from ..data.files import write_text
from ..data.points import point
from ..data.store import load_dataset, load_table, save_table
from ..figures import scene
from ..figures.style import save_figure
from ..report.scene_page import scene_page

FILES = ("report/templates/parts.html", "report/templates/scene.html")


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: data, measured, uncertainties. Outputs: numbers, csv, png, pdf, html. Settings: scene, title, share."""
    name, title = settings["scene"], settings["title"]
    found = point(load_dataset(files["data"]), 0)
    state = load_table(files["measured"])["pulse_state"].iloc[0]
    numbers = scene_numbers(found.attrs, load_table(files["uncertainties"]), settings["share"], state)
    save_table(numbers, outputs["numbers"])
    save_table(scene.table(found, numbers, {"title": title}), outputs["csv"])
    save_figure(scene.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])
    write_text(
        scene_page(name, title, outputs["png"], numbers, found.attrs | {"pulse_state": state}),
        outputs["html"],
    )
