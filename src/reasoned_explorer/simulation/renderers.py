"""Renderers of worlds, shared by all who look at the same one."""

import threading
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from reasoned_explorer.rendering.renderer import Renderer
    from reasoned_explorer.world.atlas import Atlas

#: Renderers of worlds that are in use, by conditions: a scene takes a second, and many missions share one.
_RENDERERS: "WeakKeyDictionary[Atlas, dict[str, Renderer]]" = WeakKeyDictionary()
_MAKING = threading.Lock()


def renderer_of(atlas: "Atlas", conditions: str | None = None) -> "Renderer":
    """Return the renderer of a world; all of one world draw the same scene, made when it is first asked for.

    Args:
        atlas: Of the world.
        conditions: Time of day and weather, a name of `rendering.conditions.PRESETS`; None for whichever is there, by
            those who ask for depth and ids alone.
    """
    from reasoned_explorer.rendering.conditions import PRESETS
    from reasoned_explorer.rendering.readiness import begin
    from reasoned_explorer.rendering.renderer import Renderer
    from reasoned_explorer.rendering.scene import Scene

    with _MAKING:
        made = _RENDERERS.setdefault(atlas, {})
        if conditions is None and made:
            return next(iter(made.values()))
        name = conditions or "clear"
        # What is not compiled yet is compiled beside the making of the scene.
        begin()
        if name not in made:
            scene = next((renderer.scene for renderer in made.values()), None) or Scene.of(atlas)
            made[name] = Renderer(scene, PRESETS[name])
        return made[name]
