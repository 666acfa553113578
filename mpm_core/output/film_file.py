"""Pictures one after the other as a file: H.264 video by ffmpeg, or a GIF by Pillow."""

from collections.abc import Generator, Iterable
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_rgb
from PIL import Image

from grainlaw.materials import InputError, SimulationError, atomic
from grainlaw.mpm_core.output.film_pictures import Picture
from grainlaw.mpm_core.output.picture_style import COLOR_MAP
from grainlaw.mpm_core.output.point_image import OUTLINE_COLORS, outline_color

ENDINGS = {".mp4": 1280, ".gif": 900}
"""The endings of films, with the width of their pictures [pixels], which as the height is even."""

# Of the constant rate factor of H.264, from 1 to 10.
_QUALITY = 7
# Colours of a GIF, of which it has 256.
_OF_SCALE, _GREYS = 128, 33
# How long the last picture of a GIF, which begins again after it, stays [ms].
_PAUSE = 1500


def refuse_without_encoder(path: Path) -> None:
    """Raises InputError where a film of that ending cannot be made on this machine."""
    if path.suffix.lower() != ".mp4":
        return
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        get_ffmpeg_exe()
    except (ImportError, RuntimeError) as error:
        raise _no_encoder(path, str(error)) from None


def write_pictures(path: Path, pictures: Iterable[Picture], count: int, rate: float) -> None:
    """Write `count` pictures, `rate` of them per second, complete or not at all.

    Raises InputError without an encoder, and SimulationError where the encoder fails.
    """
    with atomic.replacing(path) as partial:
        if path.suffix.lower() == ".gif":
            _write_gif(partial, pictures, rate)
        else:
            written = _write_video(partial, pictures, rate, path)
            if written != count:
                raise SimulationError(f"{path}: ffmpeg wrote {written} of {count} frames")


def _write_video(partial: Path, pictures: Iterable[Picture], rate: float, path: Path) -> int:
    """Write pictures to `partial`, which will be `path`; returns how many the file holds."""
    from imageio_ffmpeg import count_frames_and_secs

    encoder = None
    try:
        for picture in pictures:
            encoder = encoder or _started(partial, picture.shape, rate, path)
            try:
                encoder.send(np.ascontiguousarray(picture))
            except OSError as error:
                raise SimulationError(f"{path}: ffmpeg stopped: {str(error).splitlines()[0]}") from None
    finally:
        if encoder is not None:
            encoder.close()
    # Whether the encoder ended well its generator does not tell; the file does.
    try:
        return int(count_frames_and_secs(partial)[0])
    except (OSError, RuntimeError):
        return 0


def _started(partial: Path, shape: tuple[int, ...], rate: float, path: Path) -> Generator[None, Picture, None]:
    from imageio_ffmpeg import write_frames

    rows, columns, _ = shape
    try:
        encoder: Generator[None, Picture, None] = write_frames(
            partial,
            (columns, rows),
            fps=rate,
            codec="libx264",
            quality=_QUALITY,
            macro_block_size=2,
            ffmpeg_log_level="quiet",
            output_params=["-movflags", "+faststart"],
        )
        next(encoder)
    except OSError as error:
        raise _no_encoder(path, error.strerror or str(error)) from None
    return encoder


def _no_encoder(path: Path, reason: str) -> InputError:
    return InputError(
        f"{path}: a film in .mp4 needs ffmpeg, of imageio-ffmpeg or of the system: {reason}; .gif needs none"
    )


def _write_gif(path: Path, pictures: Iterable[Picture], rate: float) -> None:
    palette = _palette()
    # Pillow wants a duration for each picture beforehand.
    first, *others = [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures
    ]
    durations = [10 * round(100 / rate)] * len(others) + [_PAUSE]
    first.save(path, save_all=True, append_images=others, duration=durations, loop=0, optimize=False, disposal=1)


def _palette() -> Image.Image:
    """The colours of pictures, the same for all of a film, so that nothing flickers: the scale, greys and outlines.

    Edges between bodies and white are mixtures of them.
    """
    scale = colormaps[COLOR_MAP](np.linspace(0.0, 1.0, _OF_SCALE))[:, :3]
    outlines = np.array([to_rgb(outline_color(number)) for number in range(OUTLINE_COLORS)])
    greys = np.linspace(np.zeros(3), np.ones(3), _GREYS)
    mixtures = [1.0 - share * (1.0 - some) for some in (scale[:: _OF_SCALE // 16], outlines) for share in (0.33, 0.67)]
    colors = np.uint8(np.rint(255 * np.concatenate([greys, scale, outlines, *mixtures])))
    palette = Image.new("P", (1, 1))
    palette.putpalette(colors.ravel().tolist())
    return palette
