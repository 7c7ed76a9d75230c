"""Encoding of pictures as a video file or a GIF."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

CODECS: dict[str, tuple[str, dict[str, str], dict[str, str]]] = {
    ".mp4": ("libx264", {"crf": "19", "preset": "medium"}, {"movflags": "+faststart"}),  # plays while it downloads
    ".webm": ("libvpx-vp9", {"crf": "30", "b": "0", "deadline": "good", "cpu-used": "5", "row-mt": "1"}, {}),
}
"""Encoder, encoder options and container options of each video format."""

BT709 = 1  # colour space that players assume for HD video; number as in ITU-T H.273
LIMITED_RANGE = 1  # luma from 16 to 235, which players assume; number as in FFmpeg
GIF_COLOURS = 128  # number of colours in a palette
VISIBLE_DIFFERENCE = 24  # difference in any colour component, out of 255, that is visible
MAX_WRONG_SHARE = 0.005  # share of wrong pixels in a picture above which a GIF gets a new palette


def encode(pictures: Iterable[NDArray[np.uint8]], path: Path, suffix: str, size: tuple[int, int], fps: int) -> None:
    """Encode pictures to a file.

    Args:
        pictures: RGB pictures, shape (height, width, 3) each.
        path: Path of the file; its suffix is ignored.
        suffix: Format: ``.mp4``, ``.webm`` or ``.gif``.
        size: Width and height [pixels].
        fps: Frames per second.
    """
    if suffix == ".gif":
        _encode_gif(pictures, path, fps)
    else:
        _encode_video(pictures, path, suffix, size, fps)


def _encode_video(
    pictures: Iterable[NDArray[np.uint8]], path: Path, suffix: str, size: tuple[int, int], fps: int
) -> None:
    import av

    codec, codec_options, container_options = CODECS[suffix]
    with av.open(str(path), "w", format=suffix[1:], options=container_options) as file:
        stream: Any = file.add_stream(codec, rate=fps, options={**codec_options, "g": str(2 * fps)})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"  # the format that phones and browsers can play
        context = stream.codec_context
        context.colorspace = context.color_primaries = context.color_trc = BT709
        context.color_range = LIMITED_RANGE
        for number, picture in enumerate(pictures):
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
            frame = frame.reformat(format="yuv420p", dst_colorspace=BT709, dst_color_range=LIMITED_RANGE)
            frame.pts = number
            file.mux(stream.encode(frame))
        file.mux(stream.encode())


def _encode_gif(pictures: Iterable[NDArray[np.uint8]], path: Path, fps: int) -> None:
    """Encode a GIF; each frame uses the palette of the previous one if it fits, so that still areas do not flicker."""
    images = map(Image.fromarray, pictures)
    first_image = next(images)
    first_frame = _apply_palette(first_image, _create_palette(first_image))

    def further_frames() -> Iterator[Image.Image]:
        palette = first_frame
        for image in images:
            frame = _apply_palette(image, palette)
            wrong_share = _wrong_share(image, frame)
            if wrong_share > MAX_WRONG_SHARE:
                with_new_palette = _apply_palette(image, _create_palette(image))
                if _wrong_share(image, with_new_palette) < wrong_share / 2:
                    palette = frame = with_new_palette
            yield frame

    first_frame.save(path, "GIF", save_all=True, append_images=further_frames(), duration=1000 / fps, loop=0)


def _create_palette(image: Image.Image) -> Image.Image:
    """Return an image with a palette that suits the given image."""
    return image.quantize(GIF_COLOURS, dither=Image.Dither.NONE)


def _apply_palette(image: Image.Image, palette: Image.Image) -> Image.Image:
    """Give each pixel the nearest colour of a palette.

    ``Image.quantize`` without a palette does not choose the nearest colours, so the next frame would differ.
    """
    return image.quantize(palette=palette, dither=Image.Dither.NONE)


def _wrong_share(image: Image.Image, frame: Image.Image) -> float:
    """Return the share of pixels whose colours visibly differ between an image and its quantized frame."""
    difference = np.abs(np.asarray(image, dtype=np.int16) - np.asarray(frame.convert("RGB"), dtype=np.int16))
    return float((difference.max(axis=2) > VISIBLE_DIFFERENCE).mean())
