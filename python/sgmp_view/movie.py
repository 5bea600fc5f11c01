"""All dumps of a run as pictures with one colour scale, a scale bar and the time, or as a film of them.

    sgmp-view movie taylor_bar.out --field plastic_strain            # taylor_bar.out/movie.gif
    sgmp-view movie taylor_bar.out -o impact.mp4                     # needs ffmpeg
    sgmp-view movie taylor_bar.out --frames pictures                 # pictures/frame_0000.png, …
"""

import shutil
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.transforms import ScaledTranslation
from mpl_toolkits.axes_grid1.anchored_artists import AnchoredSizeBar
from PIL import Image

from .files import SgmpFileError, dumps_of, folder_of, plot_style, read_units
from .picture import dimension_of, draw, drawing_arguments, field_of


def common_limits(dumps, field):
    """Ends of the colour scale that hold nearly all of the field in the second half of the dumps: a charge would leave
    its blast without colours."""
    return limits_of([field_of(dump.read(), field)[1] for dump in dumps[len(dumps) // 2:]])


def limits_of(columns):
    """Ends of the colour scale that hold nearly all of some columns."""
    ends = [np.percentile(column, [0.2, 99.8]) for column in columns]
    low, high = float(min(end[0] for end in ends)), float(max(end[1] for end in ends))
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        low, high = -max(-low, high), max(-low, high)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def round_length(width):
    """The largest of 1, 2, 5, 10, … that is at most a fourth of a width."""
    power = 10.0 ** np.floor(np.log10(width / 4))
    return float(max(step for step in (1, 2, 5) if step * power <= width / 4 * (1 + 1e-9)) * power)


def add_scale_bar(axis, unit):
    """A bar of a round length, on the right of the label below the picture."""
    length = round_length(np.ptp(axis.get_xlim()))
    below = axis.transAxes + ScaledTranslation(0, -21 / 72, axis.figure.dpi_scale_trans)
    bar = AnchoredSizeBar(
        axis.transData, length, f"{length:g} {unit}".strip(), "upper right", pad=0, borderpad=0, sep=2, frameon=False,
        bbox_to_anchor=(1.0, 0.0), bbox_transform=below, size_vertical=np.ptp(axis.get_ylim()) / 200,
    )
    bar.set_in_layout(False)
    axis.add_artist(bar)


def draw_frames(dumps, folder, options):
    """One picture for each dump, all of one size; their files."""
    options.limits = options.limits or common_limits(dumps, options.field)
    files, points = [], [dump.read().points for dump in dumps]
    low, high = np.min([p.min(axis=0) for p in points], axis=0), np.max([p.max(axis=0) for p in points], axis=0)
    with plt.rc_context({**plot_style(), "savefig.dpi": options.dpi}):
        for number, dump in enumerate(dumps):
            figure = draw(dump.read(), options.source, options, box=(low, high))
            if max(map(dimension_of, points)) > 1:
                add_scale_bar(figure.axes[0], read_units(folder_of(options.source))["length"])
            files.append(folder / f"frame_{number:04d}.png")
            figure.savefig(files[-1])
            plt.close(figure)
    return files


def write_gif(files, output, rate):
    """An animated GIF."""
    images = [Image.open(file).convert("P", palette=Image.Palette.ADAPTIVE) for file in files]
    images[0].save(output, save_all=True, append_images=images[1:], duration=round(1000 / rate), loop=0)


def write_video(files, output, rate):
    """A film by ffmpeg, whose kind the suffix of its name says."""
    if not shutil.which("ffmpeg"):
        raise SgmpFileError(f"{output}: only .gif without ffmpeg, which is not installed")
    pattern = files[0].parent / "frame_%04d.png"
    done = subprocess.run(
        [
            "ffmpeg", "-y", "-framerate", str(rate), "-i", str(pattern), "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2:0:0:white", "-pix_fmt", "yuv420p", str(output),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SgmpFileError(f"{output}: ffmpeg: {done.stderr.strip().splitlines()[-1]}")


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("source", type=Path, metavar="OUT_DIR", help="output folder")
    parser.add_argument("--rate", type=float, default=10, help="frames per second (default: 10)")
    parser.add_argument("--dpi", type=int, default=100, help="resolution (default: 100)")
    parser.add_argument("--frames", type=Path, metavar="DIR", help="write pictures there, no film")
    drawing_arguments(parser)


def run(options):
    """Writes the frames or the film and prints where."""
    dumps = dumps_of(options.source)
    if not dumps:
        raise SgmpFileError(
            f"{options.source}: no dumps (add `output vtu every=…` or `output vtkhdf every=…` to the deck)"
        )
    if options.frames:
        options.frames.mkdir(parents=True, exist_ok=True)
        draw_frames(dumps, options.frames, options)
        print(options.frames)
        return
    output = options.output or folder_of(options.source) / "movie.gif"
    with tempfile.TemporaryDirectory() as scratch:
        files = draw_frames(dumps, Path(scratch), options)
        (write_gif if output.suffix == ".gif" else write_video)(files, output, options.rate)
    print(output)
