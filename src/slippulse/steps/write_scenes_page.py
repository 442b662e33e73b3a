"""Write the list of scenes."""

from ..data.files import write_text
from ..report.scene_page import scenes_page

FILES = ("report/templates/scenes.html",)


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: html. Settings: scenes (titles by name)."""
    write_text(scenes_page(settings["scenes"]), outputs["html"])
