"""What is written on a film: a caption above, and a ruler of generations below."""

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from walkerlab.cinema.job import Act, Job

Picture = NDArray[np.uint8]
"""(height, width, 3) of a frame."""

LETTERS = 0.045  # height of the letters of a caption over that of the picture
SMALLEST = 9  # pixels, in which one can still read
PLATE, WHITE, FAINT = (18, 20, 24, 165), (255, 255, 255, 255), (255, 255, 255, 110)


class Titles:
    """All that is written on the frames of one act; drawn once, and laid over each."""

    def __init__(self, act: Act, job: Job) -> None:
        self._sheet = Image.new("RGBA", job.size)
        pen, height = ImageDraw.Draw(self._sheet), job.size[1]
        letters = max(SMALLEST, round(LETTERS * height))
        if act.caption:
            _write_caption(pen, job.size, " ".join(act.caption.split()), letters)
        if job.ruler:
            _draw_ruler(pen, job, act.generation, max(SMALLEST, round(0.75 * letters)))
        self._is_blank = not (act.caption or job.ruler)

    def over(self, picture: Picture) -> Picture:
        """Return the frame with what is written on it."""
        if self._is_blank:
            return picture
        frame = Image.fromarray(picture)
        frame.paste(self._sheet, mask=self._sheet)
        return np.asarray(frame)


def _write_caption(pen: ImageDraw.ImageDraw, size: tuple[int, int], text: str, letters: int) -> None:
    """Write in the upper left, smaller if there is too much of it, and cut it where even that will not do."""
    edge = letters // 2
    room = size[0] - 4 * edge
    while letters > SMALLEST and _font(letters).getlength(text) > room:
        letters -= 1
    font = _font(letters)
    if font.getlength(text) > room:
        while text and font.getlength(f"{text}…") > room:
            text = text[:-1]
        text += "…"
    right, bottom = 3 * edge + font.getlength(text), 2 * edge + 1.25 * letters
    pen.rounded_rectangle((edge, edge, right, bottom), radius=edge, fill=PLATE)
    pen.text((2 * edge, (edge + bottom) / 2), text, font=font, fill=WHITE, anchor="lm")


def _draw_ruler(pen: ImageDraw.ImageDraw, job: Job, generation: int, letters: int) -> None:
    """Draw a line from the first generation to the last, with a dot for each act, and say where this one is."""
    (width, height), (first, last), font, edge = job.size, job.ruler or (0, 0), _font(letters), letters // 2
    start, end = (font.getlength(str(number)) + 4 * edge for number in (first, last))
    end = width - end
    top, middle = height - 2 * edge - 1.5 * letters, height - edge - 0.75 * letters - edge / 2
    pen.rounded_rectangle((edge, top, width - edge, height - edge), radius=edge, fill=PLATE)
    pen.text((2 * edge, middle), str(first), font=font, fill=WHITE, anchor="lm")
    pen.text((width - 2 * edge, middle), str(last), font=font, fill=WHITE, anchor="rm")

    def place(number: int) -> float:
        return start + (end - start) * (number - first) / max(1, last - first)

    thick, here = max(1.0, letters / 12), place(generation)
    pen.rectangle((start, middle - thick / 2, end, middle + thick / 2), fill=FAINT)
    pen.rectangle((start, middle - thick / 2, here, middle + thick / 2), fill=WHITE)
    for act in job.acts:
        pen.circle((place(act.generation), middle), 1.6 * thick, fill=WHITE if act.generation <= generation else FAINT)
    pen.circle((here, middle), letters / 2.6, fill=WHITE)


@lru_cache(maxsize=64)
def _font(letters: int) -> ImageFont.FreeTypeFont:
    """Find the font that comes with matplotlib: it is wherever walkerlab is, and knows most alphabets."""
    from matplotlib import get_data_path

    return ImageFont.truetype(str(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")), letters)
