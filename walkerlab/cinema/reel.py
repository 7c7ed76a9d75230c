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
SHARED = 128  # colours of a GIF at a time
OFF = 24  # of 255, by which a colour must be off to be seen
FEW = 0.005  # share of a picture that may be so


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
    """Write a GIF, each frame in the colours of the last while they will do: what stands still must not flicker."""
    images = map(Image.fromarray, pictures)
    start = next(images)
    first = _painted(start, _colours(start))

    def rest() -> Iterator[Image.Image]:
        colours = first
        for image in images:
            shown = _painted(image, colours)
            if (off := _share_off(image, shown)) > FEW:
                own = _painted(image, _colours(image))
                if _share_off(image, own) < off / 2:
                    colours = shown = own
            yield shown

    first.save(path, "GIF", save_all=True, append_images=rest(), duration=1000 / fps, loop=0)


def _colours(image: Image.Image) -> Image.Image:
    """Choose the colours of an image: those of the one that is returned."""
    return image.quantize(SHARED, dither=Image.Dither.NONE)


def _painted(image: Image.Image, colours: Image.Image) -> Image.Image:
    """Give each pixel the nearest colour; ``quantize`` alone does not, and the next frame would differ."""
    return image.quantize(palette=colours, dither=Image.Dither.NONE)


def _share_off(image: Image.Image, shown: Image.Image) -> float:
    """Return the share of an image whose colours are not as they should be."""
    off = np.abs(np.asarray(image, dtype=np.int16) - np.asarray(shown.convert("RGB"), dtype=np.int16))
    return float((off.max(axis=2) > OFF).mean())
