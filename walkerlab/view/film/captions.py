"""Text on the frames of a film: a caption above and a timeline of generations below."""

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from walkerlab.view.film.job import Clip, Job

Picture = NDArray[np.uint8]
"""RGB picture of a frame, shape (height, width, 3)."""

CAPTION_HEIGHT = 0.045  # height of the caption's letters, as a share of the picture's height
TIMELINE_HEIGHT = 0.75  # height of the timeline's numbers, as a share of the caption's letters
MIN_FONT_SIZE = 9  # pixels; the smallest readable size
BACKGROUND_COLOUR = (18, 20, 24, 165)  # RGBA
TEXT_COLOUR = (255, 255, 255, 255)
FAINT_COLOUR = (255, 255, 255, 110)


class CaptionOverlay:
    """Caption and timeline of one clip: drawn once and pasted onto each frame.

    Args:
        clip: Clip with the caption and the generation to mark.
        job: Film with the size, and with the generations of the timeline.
    """

    def __init__(self, clip: Clip, job: Job) -> None:
        self._image = Image.new("RGBA", job.size)
        self._is_blank = not (clip.caption or job.generation_range)
        draw = ImageDraw.Draw(self._image)
        font_size = max(MIN_FONT_SIZE, round(CAPTION_HEIGHT * job.size[1]))
        if clip.caption:
            _draw_caption(draw, job.size, " ".join(clip.caption.split()), font_size)
        if job.generation_range:
            timeline_font_size = max(MIN_FONT_SIZE, round(TIMELINE_HEIGHT * font_size))
            _draw_timeline(draw, job, job.generation_range, clip.generation, timeline_font_size)

    def draw_on(self, picture: Picture) -> Picture:
        """Return a frame with caption and timeline."""
        if self._is_blank:
            return picture
        frame = Image.fromarray(picture)
        frame.paste(self._image, mask=self._image)
        return np.asarray(frame)


def _draw_caption(draw: ImageDraw.ImageDraw, size: tuple[int, int], text: str, font_size: int) -> None:
    """Draw a caption in the upper left corner; long text gets a smaller font and is shortened if necessary."""
    margin = font_size // 2
    max_width = size[0] - 4 * margin
    while font_size > MIN_FONT_SIZE and _load_font(font_size).getlength(text) > max_width:
        font_size -= 1
    font = _load_font(font_size)
    if font.getlength(text) > max_width:
        while text and font.getlength(f"{text}…") > max_width:
            text = text[:-1]
        text += "…"
    right = 3 * margin + font.getlength(text)
    bottom = 2 * margin + 1.25 * font_size
    draw.rounded_rectangle((margin, margin, right, bottom), radius=margin, fill=BACKGROUND_COLOUR)
    draw.text((2 * margin, (margin + bottom) / 2), text, font=font, fill=TEXT_COLOUR, anchor="lm")


def _draw_timeline(
    draw: ImageDraw.ImageDraw, job: Job, generation_range: tuple[int, int], generation: int, font_size: int
) -> None:
    """Draw a line from the first generation to the last with a dot for each clip, and a larger dot for this one.

    Args:
        draw: Image to draw on.
        job: Film with all clips.
        generation_range: First and last generation.
        generation: Generation of the current clip.
        font_size: Font size of the numbers at both ends [pixels].
    """
    width, height = job.size
    first, last = generation_range
    font = _load_font(font_size)
    margin = font_size // 2
    line_start = font.getlength(str(first)) + 4 * margin
    line_end = width - (font.getlength(str(last)) + 4 * margin)
    top = height - 2 * margin - 1.5 * font_size
    middle = height - margin - 0.75 * font_size - margin / 2
    draw.rounded_rectangle((margin, top, width - margin, height - margin), radius=margin, fill=BACKGROUND_COLOUR)
    draw.text((2 * margin, middle), str(first), font=font, fill=TEXT_COLOUR, anchor="lm")
    draw.text((width - 2 * margin, middle), str(last), font=font, fill=TEXT_COLOUR, anchor="rm")

    def position(number: int) -> float:
        return line_start + (line_end - line_start) * (number - first) / max(1, last - first)

    thickness = max(1.0, font_size / 12)
    current = position(generation)
    line_top = middle - thickness / 2
    line_bottom = middle + thickness / 2
    draw.rectangle((line_start, line_top, line_end, line_bottom), fill=FAINT_COLOUR)
    draw.rectangle((line_start, line_top, current, line_bottom), fill=TEXT_COLOUR)
    for clip in job.clips:
        colour = TEXT_COLOUR if clip.generation <= generation else FAINT_COLOUR
        draw.circle((position(clip.generation), middle), 1.6 * thickness, fill=colour)
    draw.circle((current, middle), font_size / 2.6, fill=TEXT_COLOUR)


@lru_cache(maxsize=64)
def _load_font(size: int) -> ImageFont.FreeTypeFont:
    """Load DejaVu Sans, which is installed with matplotlib and covers most alphabets."""
    from matplotlib import get_data_path

    return ImageFont.truetype(str(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")), size)
