# SPDX-License-Identifier: Apache-2.0
"""Terrain files: 16-bit PGM with a side-car, rock list, and rasters through GDAL.

This is the only place where elevation is up and row 0 is the northern one.
"""

import contextlib
import math
import os
import re
import tempfile
import warnings
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from sim.config import ConfigModel, dump_model, load_model, parse_model
from sim.errors import ConfigError, TerrainError
from sim.terrain import ROCK_DTYPE, Terrain, centred, no_rocks

COUNT_MAX = 65535
NODES_MAX = 50_000_000
HEADER_MAX_BYTES = 4096
ELEVATION_MAX_M = 50_000.0
ROCKS_HEADER = "north_m,east_m,diameter_m,height_m"
ROCKS_MAX = 5_000_000

_TOKEN = re.compile(rb"(?:[ \t\r\n]|#[^\n]*\n)*([^ \t\r\n#]+)")
_SIZE = re.compile(rb"[1-9][0-9]{0,5}")


class SideCar(ConfigModel):
    """What a PGM cannot say: z_up = z_offset_m + z_scale_m_per_count * value, row 0 north."""

    z_offset_m: Annotated[float, Field(ge=-1e6, le=1e6)]
    z_scale_m_per_count: Annotated[float, Field(gt=0, le=100)]
    cell_m: Annotated[float, Field(gt=0, le=1000)]
    rows: Annotated[int, Field(ge=2, le=COUNT_MAX)]
    cols: Annotated[int, Field(ge=2, le=COUNT_MAX)]
    row0: Literal["north"] = "north"
    formula: str | None = None
    note: str | None = None
    recipe: dict[str, Any] | None = None


def read_terrain(path: Path | str) -> Terrain:
    """Terrain from `.pgm` with its side-car, or from any raster that GDAL reads.

    The SITE origin is the middle of the grid. No-data becomes NaN: there is no ground.

    Raises:
        TerrainError: One line with the file, what is wrong, and what was expected.
    """
    path = Path(path)
    if not path.exists():
        raise TerrainError(f"{path}: no such file")
    if not path.is_file():
        raise TerrainError(f"{path}: not a file, expected a terrain")
    return _read_pgm_terrain(path) if path.suffix.lower() == ".pgm" else _read_raster(path)


def write_terrain(terrain: Terrain, path: Path | str) -> None:
    """Write `T.pgm`, `T.yaml` (scale, offset, recipe) and `T.rocks.csv`, each atomically."""
    path = Path(path)
    if path.suffix.lower() != ".pgm":
        raise TerrainError(f"{path}: expected a name ending in .pgm")
    up_m = -terrain.z_site_m[::-1].astype(np.float64)
    if not np.all(np.isfinite(up_m)):
        raise TerrainError(f"{path}: the terrain has nodes without ground, a PGM cannot hold them")
    low_m, high_m = float(up_m.min()), float(up_m.max())
    scale = (high_m - low_m) / COUNT_MAX if high_m > low_m else 1e-3
    counts = np.rint((up_m - low_m) / scale).astype(">u2")
    side_car = SideCar(
        z_offset_m=low_m,
        z_scale_m_per_count=scale,
        cell_m=terrain.resolution_m,
        rows=counts.shape[0],
        cols=counts.shape[1],
        formula="z_up_m = z_offset_m + z_scale_m_per_count * value",
        recipe=terrain.recipe,
    )
    header = f"P5\n{counts.shape[1]} {counts.shape[0]}\n{COUNT_MAX}\n".encode()
    _write_atomic(path, header + counts.tobytes())
    _write_atomic(rocks_path(path), _rocks_text(terrain.rocks).encode())
    # last: a terrain is complete when its side-car is there
    _write_atomic(path.with_suffix(".yaml"), dump_model(side_car).encode())


def rocks_path(path: Path | str) -> Path:
    """The rock list beside a terrain file."""
    return Path(path).with_suffix(".rocks.csv")


# ------------------------------------------------------------------ PGM


def _read_pgm_terrain(path: Path) -> Terrain:
    side_car = _read_side_car(path)
    counts = _read_pgm(path)
    if counts.shape != (side_car.rows, side_car.cols):
        raise TerrainError(
            f"{path}: image of {counts.shape[0]} rows x {counts.shape[1]} columns, its side-car"
            f" says {side_car.rows} x {side_car.cols}"
        )
    up_m = side_car.z_offset_m + side_car.z_scale_m_per_count * counts[::-1].astype(np.float64)
    if float(np.abs(up_m).max()) > ELEVATION_MAX_M:
        raise TerrainError(
            f"{path}: heights beyond {ELEVATION_MAX_M:g} m, expected a smaller z_scale_m_per_count"
        )
    rocks = _read_rocks(rocks_path(path))
    return centred((-up_m).astype(np.float32), side_car.cell_m, rocks, side_car.recipe)


def _read_side_car(path: Path) -> SideCar:
    try:
        for suffix in (".yaml", ".json"):
            candidate = path.with_suffix(suffix)
            if candidate.exists() and suffix == ".yaml":
                return load_model(candidate, SideCar)
            if candidate.exists():
                # JSON is YAML but for tabs
                text = candidate.read_text("utf-8").replace("\t", " ")
                return parse_model(text, str(candidate), SideCar)
    except ConfigError as error:
        raise TerrainError("; ".join(error.problems)) from None
    except (OSError, UnicodeDecodeError) as error:
        raise TerrainError(f"{path.with_suffix('.json')}: cannot be read: {error}") from None
    raise TerrainError(
        f"{path}: no side-car {path.with_suffix('.yaml').name} (or .json) beside it,"
        " expected one with z_offset_m, z_scale_m_per_count, cell_m, rows, cols"
    )


def _read_pgm(path: Path) -> npt.NDArray[np.uint16]:
    """Counts [rows, cols], row 0 north, of a binary 16-bit PGM."""
    try:
        with path.open("rb") as file:
            cols, rows, start = _parse_header(path, file.read(HEADER_MAX_BYTES))
            found = path.stat().st_size - start
            if found != 2 * rows * cols:
                kind = "short" if found < 2 * rows * cols else "long"
                raise TerrainError(
                    f"{path}: pixel data too {kind}: {found} bytes, expected {2 * rows * cols}"
                    f" for {cols} x {rows} 16-bit pixels"
                )
            file.seek(start)
            counts = np.frombuffer(file.read(2 * rows * cols), dtype=">u2")
            return counts.reshape(rows, cols).astype(np.uint16)
    except (OSError, ValueError) as error:
        raise TerrainError(f"{path}: cannot be read: {error}") from None


def _parse_header(path: Path, head: bytes) -> tuple[int, int, int]:
    """Columns, rows and the offset of the first pixel."""
    if head[:2] != b"P5" or head[2:3] not in (b" ", b"\t", b"\r", b"\n", b"#"):
        raise TerrainError(f"{path}: starts with {head[:2]!r}, expected a binary PGM (P5)")
    position = 2
    values: list[int] = []
    for name in ("width", "height", "maxval"):
        token = _TOKEN.match(head, position)
        if token is None:
            raise TerrainError(f"{path}: header ends before the {name}")
        if not _SIZE.fullmatch(token[1]):
            shown = token[1][:20].decode("latin-1")
            raise TerrainError(f"{path}: {name} is {shown!r}, expected a positive number")
        values.append(int(token[1]))
        position = token.end()
    if head[position : position + 1] not in (b" ", b"\t", b"\r", b"\n"):
        raise TerrainError(f"{path}: expected one white space between maxval and the pixels")
    cols, rows, maxval = values
    if maxval != COUNT_MAX:
        raise TerrainError(f"{path}: maxval is {maxval}, expected {COUNT_MAX} (16-bit heights)")
    if not (2 <= cols <= COUNT_MAX and 2 <= rows <= COUNT_MAX) or rows * cols > NODES_MAX:
        raise TerrainError(
            f"{path}: image of {cols} x {rows} pixels, expected 2 to {COUNT_MAX} each way and"
            f" at most {NODES_MAX} in all"
        )
    return cols, rows, position + 1


# ------------------------------------------------------------------ rocks


def _rocks_text(rocks: npt.NDArray[np.void]) -> str:
    lines = [ROCKS_HEADER]
    lines += [f"{n:.4f},{e:.4f},{d:.4f},{h:.4f}" for n, e, d, h in rocks.tolist()]
    return "\n".join(lines) + "\n"


def _read_rocks(path: Path) -> npt.NDArray[np.void]:
    if not path.exists():
        return no_rocks()
    try:
        lines = path.read_text("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise TerrainError(f"{path}: cannot be read: {error}") from None
    if not lines or lines[0].strip() != ROCKS_HEADER:
        raise TerrainError(f"{path}:1: expected the header {ROCKS_HEADER}")
    if len(lines) > ROCKS_MAX:
        raise TerrainError(f"{path}: more than {ROCKS_MAX} rocks")
    rows: list[tuple[float, ...]] = []
    for number, line in enumerate(lines[1:], start=2):
        try:
            row = tuple(float(part) for part in line.split(","))
        except ValueError:
            row = ()
        if len(row) != 4 or not all(map(math.isfinite, row)) or row[2] <= 0 or row[3] < 0:
            raise TerrainError(
                f"{path}:{number}: expected four numbers {ROCKS_HEADER} with a positive diameter,"
                f" got {line[:60]!r}"
            )
        rows.append(row)
    return np.array(rows, dtype=ROCK_DTYPE)


# ------------------------------------------------------------------ rasters


def _read_raster(path: Path) -> Terrain:
    """A single-band elevation raster in metres, any format GDAL knows."""
    try:
        import rasterio
        from rasterio.errors import NotGeoreferencedWarning, RasterioError
    except ImportError:
        raise TerrainError(
            f"{path}: reading {path.suffix or 'this format'} needs rasterio,"
            " install it with: pip install 'enav-sim[orbital]'"
        ) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                return _terrain_of_dataset(path, dataset)
    except RasterioError as error:
        reason = str(error).splitlines()[0]
        raise TerrainError(f"{path}: not a raster that can be read: {reason}") from None


def _terrain_of_dataset(path: Path, dataset: Any) -> Terrain:
    cell_m = _cell_of_dataset(path, dataset)
    raw = dataset.read(1, masked=True)
    up_m = raw.astype(np.float64).filled(np.nan) * dataset.scales[0] + dataset.offsets[0]
    # products without a no-data tag still mark holes with huge values
    up_m[~(np.abs(up_m) <= ELEVATION_MAX_M)] = np.nan
    if not np.any(np.isfinite(up_m)):
        raise TerrainError(f"{path}: every pixel is no-data, expected heights in metres")
    if dataset.transform.e < 0:
        up_m = up_m[::-1]
    if dataset.transform.a < 0:
        up_m = up_m[:, ::-1]
    return centred((-up_m).astype(np.float32), cell_m)


def _cell_of_dataset(path: Path, dataset: Any) -> float:
    """Pixel size in metres of an upright, square, projected raster."""
    transform = dataset.transform
    if dataset.count != 1:
        raise TerrainError(f"{path}: {dataset.count} bands, expected one of elevation")
    if transform.is_identity and dataset.crs is None:
        raise TerrainError(f"{path}: no georeference, expected a map in metres")
    if dataset.crs is not None and dataset.crs.is_geographic:
        raise TerrainError(
            f"{path}: coordinates in degrees, expected metres (reproject it, e.g. with gdalwarp)"
        )
    if abs(transform.b) > 1e-9 or abs(transform.d) > 1e-9:
        raise TerrainError(f"{path}: the map is rotated, expected north up")
    unit_m = 1.0
    if dataset.crs is not None and dataset.crs.is_projected:
        unit_m = float(dataset.crs.linear_units_factor[1])
    cell_x, cell_y = float(abs(transform.a) * unit_m), float(abs(transform.e) * unit_m)
    if not math.isclose(cell_x, cell_y, rel_tol=1e-3):
        raise TerrainError(
            f"{path}: pixels of {cell_x:g} x {cell_y:g} m, expected square ones (resample it)"
        )
    if min(dataset.shape) < 2 or dataset.shape[0] * dataset.shape[1] > NODES_MAX:
        raise TerrainError(
            f"{path}: {dataset.shape[1]} x {dataset.shape[0]} pixels, expected at least 2 x 2 and"
            f" at most {NODES_MAX} in all (cut a window out, e.g. with gdal_translate -projwin)"
        )
    return cell_x


# ------------------------------------------------------------------ writing


def _write_atomic(path: Path, content: bytes) -> None:
    """Write through a temporary file beside the target: the target is old or new, never torn."""
    temporary: Path | None = None
    try:
        with tempfile.NamedTemporaryFile(
            dir=path.parent, prefix=f".{path.name}.", delete=False
        ) as file:
            temporary = Path(file.name)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()
        raise TerrainError(f"{path}: cannot be written: {error.strerror or error}") from None
