"""Pictures become a file, of the kind that its name asks for."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

CODECS: dict[str, tuple[str, dict[str, str], dict[str, str]]] = {
    ".mp4": ("libx264", {"crf": "19", "preset": "medium"}, {"movflags": "+faststart"}),  # plays before it is all there
    ".webm": ("libvpx-vp9", {"crf": "30", "b": "0", "deadline": "good", "cpu-used": "5", "row-mt": "1"}, {}),
}
"""Of each kind of video, the encoder, its options, and those of the file."""

BT709, STUDIO_RANGE = 1, 1  # how colours are written: as every player assumes of what is not old television
SHARED = 128  # colours of a GIF


def record(pictures: Iterable[NDArray[np.uint8]], path: Path, suffix: str, size: tuple[int, int], fps: int) -> None:
    """Write pictures to a file.

    Args:
        pictures: each (height, width, 3).
        path: of the file, whatever its name.
        suffix: the kind of film: ``.mp4``, ``.webm`` or ``.gif``.
        size: width and height, in pixels.
        fps: frames a second.
    """
    if suffix == ".gif":
        _record_gif(pictures, path, fps)
    else:
        _record_video(pictures, path, suffix, size, fps)


def _record_video(
    pictures: Iterable[NDArray[np.uint8]], path: Path, suffix: str, size: tuple[int, int], fps: int
) -> None:
    import av

    codec, options, of_file = CODECS[suffix]
    with av.open(str(path), "w", format=suffix[1:], options=of_file) as file:
        stream: Any = file.add_stream(codec, rate=fps, options={**options, "g": str(2 * fps)})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"  # what phones and browsers can play
        context = stream.codec_context
        context.colorspace = context.color_primaries = context.color_trc = BT709
        context.color_range = STUDIO_RANGE
        for number, picture in enumerate(pictures):
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
            frame = frame.reformat(format="yuv420p", dst_colorspace=BT709, dst_color_range=STUDIO_RANGE)
            frame.pts = number
            file.mux(stream.encode(frame))
        file.mux(stream.encode())


def _record_gif(pictures: Iterable[NDArray[np.uint8]], path: Path, fps: int) -> None:
    """Write a GIF, all its frames in the colours of the first, so that what stands still does not flicker."""
    images = map(Image.fromarray, pictures)
    first = next(images).quantize(SHARED, dither=Image.Dither.NONE)

    def rest() -> Iterator[Image.Image]:
        for image in images:
            yield image.quantize(palette=first, dither=Image.Dither.NONE)

    first.save(path, "GIF", save_all=True, append_images=rest(), duration=1000 / fps, loop=0)
