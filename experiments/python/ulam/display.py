"""What notebooks show."""

import base64
import html
import struct
import zlib
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .cell import Cell
    from .run import Run

REPORT_HEIGHT = 720  # CSS pixels
PICTURE_WIDTH = 256  # CSS pixels


def run_html(run: "Run") -> str:
    """The run's report in a frame of its own, where its scripts see nothing of the notebook, but may save files and print."""
    report = run.folder / "report.html"
    if not report.exists():
        hint = f"<p>There is no {html.escape(str(report))}: <code>ulam report</code> makes it.</p>"
        return run.cells.to_html(max_rows=20) + hint
    page = html.escape(report.read_text(encoding="utf8"))
    return (
        f'<iframe sandbox="allow-scripts allow-downloads allow-modals" srcdoc="{page}" title="{html.escape(run.name)}" '
        f'style="width: 100%; height: {REPORT_HEIGHT}px; border: 0"></iframe>'
    )


def cell_html(cell: "Cell") -> str:
    """Its errors, verdicts and the mean of its images beside the reference."""
    summary, comparisons = cell.summary, cell.run.comparisons
    rows = [(name, with_interval(metric["mean"], metric["ci95"])) for name, metric in summary["metrics"].items()]
    rows += [(name, f"{summary[name]:.4g}") for name in ("replicates", "seconds", "rays", "mutations")]
    for _, judged in comparisons[comparisons["cell"] == cell.name].iterrows():
        interval = (judged["ci95_low"], judged["ci95_high"])
        rows.append((f"ratio to {judged['baseline']}", f"{with_interval(judged['ratio'], interval)}: {judged['verdict']}"))
    table = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(text)}</td></tr>" for name, text in rows)
    pictures = picture(cell.images.mean(axis=0, dtype=np.float64), "mean of the images")
    pictures += picture(cell.reference.image, "reference")
    return f'<b>{html.escape(cell.name)}</b><div style="display: flex; gap: 1em"><table>{table}</table>{pictures}</div>'


def with_interval(value: float | None, interval: tuple[float | None, float | None] | None) -> str:
    low, high = (number(x) for x in interval or (None, None))
    return f"{number(value)} ({low} to {high})"


def number(value: float | None) -> str:
    return "?" if value is None or np.isnan(value) else f"{value:.4g}"


def picture(image: np.ndarray, caption: str) -> str:
    data = base64.b64encode(png(srgb(image))).decode()
    return (
        f'<figure style="margin: 0"><img src="data:image/png;base64,{data}" alt="{caption}" '
        f'style="width: {PICTURE_WIDTH}px; image-rendering: pixelated"><figcaption>{caption}</figcaption></figure>'
    )


def srgb(linear: np.ndarray) -> np.ndarray:
    """8-bit sRGB of linear radiance, cut at 1."""
    x = np.clip(np.nan_to_num(linear), 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)


def png(pixels: np.ndarray) -> bytes:
    """Of 8-bit RGB, shape (height, width, 3)."""
    height, width, _ = pixels.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)  # filter 0 a row

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")
    )
