"""The window itself: moderngl-window shows what the state draws, and passes keys and drags on."""

from functools import partial

import moderngl
import moderngl_window
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from renderer.context import context
from reports.display import display
from reports.run.window.state import State

KEYS = (
    ("C", "case", "the next case of the suite"),
    ("T", "technique", "the next technique"),
    ("M", "material", "the next material, of every judged object"),
    ("E", "environment", "the next environment"),
    ("W", "weight", "the next share of GGX"),
)
OTHERS = (
    ("R", "the reference from the store, and back"),
    ("UP, DOWN", "half a stop brighter, darker"),
    ("HOME", "the suite's case, from its own camera"),
    ("drag, wheel", "orbit, come nearer"),
)
PER_PIXEL = 0.008  # radians that a drag turns
COARSE = 2  # pixels aside that are drawn as one while the view moves
FONT = 15
VERTEX = """
#version 330
out vec2 uv;
void main() {
    vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    uv = 2.0 * at;
    gl_Position = vec4(4.0 * at - 1.0, 0.0, 1.0);
}
"""
FRAGMENT = """
#version 330
in vec2 uv;
out vec4 colour;
uniform sampler2D picture;
void main() { colour = vec4(texture(picture, vec2(uv.x, 1.0 - uv.y)).rgb, 1.0); }
"""


class Window(moderngl_window.WindowConfig):
    """Draws when something has changed, and not otherwise."""

    title = "shadeproof"
    window_size = (1024, 576)
    aspect_ratio = None
    resizable = True
    vsync = True
    state: State  # set before the window is made

    def __init__(self, **given) -> None:
        super().__init__(**given)
        self.program = self.ctx.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        self.triangle = self.ctx.vertex_array(self.program, [])
        self.texture: moderngl.Texture | None = None
        self.stale, self.moving = True, False

    def on_render(self, time: float, frame_time: float) -> None:
        """Draw anew what has changed, and show it."""
        if self.stale or self.moving:
            moving, self.moving = self.moving, False
            self._upload(self.picture(COARSE if moving else 1))
            self.stale = moving  # once more, sharply, when it rests
        self.ctx.clear()
        if self.texture:
            self.texture.use()
            self.triangle.render(moderngl.TRIANGLES, vertices=3)

    def picture(self, coarse: int = 1) -> np.ndarray:
        """What is shown, (h, w, 3) uint8, row 0 on top, with the words in its corner."""
        size = tuple(max(n // coarse, 1) for n in self.wnd.buffer_size)
        state = self.state
        with context():  # the renderer draws in a context of its own
            light = state.traced() if state.reference else state.drawn(size)
        self.ctx.__enter__()
        if light is None:
            state.reference = False
            shown = np.zeros((size[1], size[0], 3), np.uint8)
        else:
            shown = (255 * display(light, state.exposure(light)) + 0.5).astype(np.uint8)
        image = Image.fromarray(shown).resize(self.wnd.buffer_size, Image.Resampling.BILINEAR)
        return labelled(image, state.words)

    def _upload(self, pixels: np.ndarray) -> None:
        size = (pixels.shape[1], pixels.shape[0])
        if self.texture is None or self.texture.size != size:
            if self.texture:
                self.texture.release()
            self.texture = self.ctx.texture(size, 3, alignment=1)
        self.texture.write(np.ascontiguousarray(pixels), alignment=1)

    def on_key_event(self, key, action, modifiers) -> None:
        """A letter walks on, with Shift back."""
        keys = self.wnd.keys
        if action != keys.ACTION_PRESS:
            return
        step = -1 if modifiers.shift else 1
        acts = {getattr(keys, k): partial(self.state.walk, what, step) for k, what, _ in KEYS}
        acts |= {
            keys.R: self._toggle,
            keys.HOME: self.state.home,
            keys.UP: partial(self._expose, 0.5),
            keys.DOWN: partial(self._expose, -0.5),
        }
        if act := acts.get(key):
            act()
            self.stale = True

    def _toggle(self) -> None:
        self.state.said = ""
        self.state.reference = not self.state.reference

    def _expose(self, stops: float) -> None:
        self.state.stops += stops

    def on_mouse_drag_event(self, x: int, y: int, dx: int, dy: int) -> None:
        """Turn about what is looked at."""
        orbit = self.state.orbit
        orbit.yaw -= PER_PIXEL * dx
        orbit.pitch += PER_PIXEL * dy
        self._moved()

    def on_mouse_scroll_event(self, x_offset: float, y_offset: float) -> None:
        """Come nearer, or go away."""
        self.state.orbit.zoom *= 0.9**y_offset
        self._moved()

    def _moved(self) -> None:
        self.state.reference, self.state.said, self.moving = False, "", True

    def on_resize(self, width: int, height: int) -> None:
        """A larger window is drawn with more pixels."""
        self.stale = True


def labelled(image: Image.Image, lines: list[str]) -> np.ndarray:
    """A picture with lines of text in its upper left corner, (h, w, 3) uint8."""
    font = ImageFont.load_default(FONT)
    draw = ImageDraw.Draw(image, "RGBA")
    text = "\n".join(lines)
    left, top, right, bottom = draw.multiline_textbbox((10, 8), text, font=font)
    draw.rectangle((left - 6, top - 4, right + 6, bottom + 6), fill=(0, 0, 0, 150))
    draw.multiline_text((10, 8), text, font=font, fill=(255, 255, 255, 255))
    return np.asarray(image)


def show(state: State) -> None:
    """Open the window; returns when it is closed."""
    Window.state = state
    moderngl_window.run_window_config(Window, args=("--window", "pyglet"))
