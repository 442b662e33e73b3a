"""Write the animation of one scene."""

from slippulse.data.point import point
from slippulse.data.store import load_dataset
from slippulse.model.layer_units import Layer
from slippulse.plotting.style import house_style

from ..figures.scene_animation import save_animation


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the animation ``gif`` of a scene from its ``data``.

    The settings have its title, and its layer in SI units or None.
    """
    layer = Layer(**settings["layer"]) if settings.get("layer") else None
    data = point(load_dataset(files["data"]), 0)
    with house_style():
        save_animation(data, settings["title"], outputs["gif"], layer)
