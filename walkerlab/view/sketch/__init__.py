"""Drawings of robots and worlds as SVG text, fast enough to follow a slider; they need neither OpenGL nor matplotlib.

All functions are safe to call from any thread.
"""

from walkerlab.view.sketch.bodies import draw_robot as draw_robot
from walkerlab.view.sketch.standing import lies_at_start as lies_at_start
from walkerlab.view.sketch.worlds import draw_world as draw_world

__all__ = ["draw_robot", "draw_world", "lies_at_start"]
