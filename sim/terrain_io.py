# SPDX-License-Identifier: Apache-2.0
"""Terrain files: 16-bit PGM with a side-car, rock list, class map; rasters through GDAL.

This is the only place where elevation is up and row 0 is the northern one.
"""

import contextlib
import math
import os
import re
import tempfile
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from sim.config import ConfigModel, load_model, parse_model
from sim.errors import ConfigError, TerrainError
from sim.raster import NODES_MAX, MapGrid, check_size, open_raster
from sim.strict_yaml import write_tree
from sim.terrain import CLASS_NAMES, ROCK_DTYPE, Terrain, centred, no_rocks

COUNT_MAX = 65535
CLASS_MAXVAL = 255
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
    class_names: tuple[str, ...] | None = None
    origin: dict[str, Any] | None = None


def read_terrain(path: Path | str) -> Terrain:
    """Terrain from `.pgm` with its side-car, or from any raster that GDAL reads.

    The SITE origin is the middle of the grid. No-data becomes NaN: there is no ground.

    Raises:
        TerrainError: One line with the file, what is wrong, and what was expected.
    """
    path = _existing(path)
    return _read_pgm_terrain(path) if path.suffix.lower() == ".pgm" else _read_raster(path)


def _existing(path: Path | str) -> Path:
    path = Path(path)
    try:
        if not path.exists():
            raise TerrainError(f"{path}: no such file")
        if not path.is_file():
            raise TerrainError(f"{path}: not a file, expected a terrain")
    except (OSError, ValueError) as error:  # too long a name, a NUL in it
        raise TerrainError(f"{path!r}: cannot be read: {error}") from None
    return path


def write_terrain(terrain: Terrain, path: Path | str, origin: dict[str, Any] | None = None) -> None:
    """Write `T.pgm`, `T.yaml` (scale, offset, recipe) and `T.rocks.csv`, each atomically.

    Terrain classes go to `T.class.pgm`. `origin` says where on a planet the ground came from.
    """
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
        class_names=None if terrain.classes is None else CLASS_NAMES,
        origin=origin,
    )
    header = f"P5\n{counts.shape[1]} {counts.shape[0]}\n{COUNT_MAX}\n".encode()
    write_atomic(path, header + counts.tobytes())
    write_atomic(rocks_path(path), _rocks_text(terrain.rocks).encode())
    _write_classes(terrain.classes, classes_path(path))
    # last: a terrain is complete when its side-car is there
    content = side_car.model_dump(mode="json")
    for name in ("class_names", "origin"):
        if content[name] is None:
            del content[name]
    write_atomic(path.with_suffix(".yaml"), write_tree(content).encode())


def rocks_path(path: Path | str) -> Path:
    """The rock list beside a terrain file."""
    return Path(path).with_suffix(".rocks.csv")


def classes_path(path: Path | str) -> Path:
    """The terrain class map beside a terrain file."""
    return Path(path).with_suffix(".class.pgm")


# ------------------------------------------------------------------ PGM


def _read_pgm_terrain(path: Path) -> Terrain:
    side_car = _read_side_car(path)
    up_m = _values_of_pgm(path, side_car)
    rocks = _read_rocks(rocks_path(path))
    classes = _read_classes(classes_path(path), up_m.shape)
    return centred(
        (-up_m).astype(np.float32), side_car.cell_m, rocks, side_car.recipe, classes=classes
    )


def _values_of_pgm(path: Path, side_car: SideCar) -> npt.NDArray[np.float64]:
    """Heights (up) of a PGM, row 0 south."""
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
    return up_m


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


def _read_pgm(path: Path, maxval: int = COUNT_MAX) -> npt.NDArray[np.uint16]:
    """Counts [rows, cols], row 0 north, of a binary PGM of 16 bits, or 8 for a maxval of 255."""
    dtype = np.dtype(">u2" if maxval > CLASS_MAXVAL else "u1")
    try:
        with path.open("rb") as file:
            cols, rows, start = _parse_header(path, file.read(HEADER_MAX_BYTES), maxval)
            found = path.stat().st_size - start
            size = dtype.itemsize * rows * cols
            if found != size:
                kind = "short" if found < size else "long"
                raise TerrainError(
                    f"{path}: pixel data too {kind}: {found} bytes, expected {size}"
                    f" for {cols} x {rows} {8 * dtype.itemsize}-bit pixels"
                )
            file.seek(start)
            counts = np.frombuffer(file.read(size), dtype=dtype)
            return counts.reshape(rows, cols).astype(np.uint16)
    except (OSError, ValueError) as error:
        raise TerrainError(f"{path}: cannot be read: {error}") from None


def _parse_header(path: Path, head: bytes, maxval_wanted: int) -> tuple[int, int, int]:
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
    if maxval != maxval_wanted:
        what = "16-bit heights" if maxval_wanted == COUNT_MAX else "8-bit terrain classes"
        raise TerrainError(f"{path}: maxval is {maxval}, expected {maxval_wanted} ({what})")
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


# ------------------------------------------------------------------ classes


def _write_classes(classes: npt.NDArray[np.uint8] | None, path: Path) -> None:
    if classes is None:
        path.unlink(missing_ok=True)  # of a terrain that was here before
        return
    header = f"P5\n{classes.shape[1]} {classes.shape[0]}\n{CLASS_MAXVAL}\n".encode()
    write_atomic(path, header + classes[::-1].tobytes())


def _read_classes(path: Path, shape: tuple[int, ...]) -> npt.NDArray[np.uint8] | None:
    if not path.exists():
        return None
    classes = _read_pgm(path, CLASS_MAXVAL)
    if classes.shape != shape:
        raise TerrainError(
            f"{path}: {classes.shape[0]} rows x {classes.shape[1]} columns of classes, the terrain"
            f" has {shape[0]} x {shape[1]}"
        )
    if int(classes.max()) >= len(CLASS_NAMES):
        names = ", ".join(f"{number} {name}" for number, name in enumerate(CLASS_NAMES))
        raise TerrainError(f"{path}: class {int(classes.max())}, expected {names}")
    return classes[::-1].astype(np.uint8)


# ------------------------------------------------------------------ maps


def open_map(path: Path | str, band: int | None = None) -> MapGrid:
    """Open a map of heights, or of anything else, for reading by windows.

    A PGM is one too; it has no place on a planet.
    """
    path = _existing(path)
    if path.suffix.lower() != ".pgm":
        return open_raster(path, band)
    if band is not None and band != 1:
        raise TerrainError(f"{path}: no band {band}, a PGM has one")
    side_car = _read_side_car(path)
    values = _values_of_pgm(path, side_car)
    return MapGrid(
        path, (side_car.rows, side_car.cols), side_car.cell_m, None, lambda r, c: values[r, c]
    )


def _read_raster(path: Path) -> Terrain:
    """Whole raster as a terrain, its pixels as large as the file states."""
    source = open_raster(path)
    check_size(path, *source.shape)
    up_m = source.read(slice(0, source.shape[0]), slice(0, source.shape[1]))
    if not np.any(np.isfinite(up_m)):
        raise TerrainError(f"{path}: every pixel is no-data, expected heights in metres")
    return centred((-up_m).astype(np.float32), source.cell_m)


# ------------------------------------------------------------------ writing


def write_atomic(path: Path, content: bytes) -> None:
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
