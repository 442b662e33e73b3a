"""Write the page that lists all scenes."""

from slippulse.data.files import write_text

from ..report.html import page


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the page ``html``; the settings have the title of each scene by name."""
    write_text(page("scenes.html", scenes=settings["scenes"]), outputs["html"])
