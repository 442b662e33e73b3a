"""Write the animation of one scene."""

from slippulse.data.point import point
from slippulse.data.store import load_dataset
from slippulse.model.layer_units import Layer
from slippulse.plotting.style import house_style

from ..figures.scene_animation import save_animation


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the animation ``gif`` of a scene from its ``data``.

    The settings have the title of the scene, and the parameters of its layer in SI units or None.
    """
    layer = Layer(**settings["layer"]) if settings.get("layer") else None
    # A scene is a simulation of one run, whose number is 0.
    data = point(load_dataset(files["data"]), 0)
    with house_style():
        save_animation(data, settings["title"], outputs["gif"], layer)
