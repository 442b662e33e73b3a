"""Write the list of scenes."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.files import write_text
from ..report.scene_page import scenes_page

FILES = ("report/templates/scenes.html",)


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Outputs: html. Settings: scenes (titles by name)."""
    write_text(scenes_page(settings["scenes"]), outputs["html"])
