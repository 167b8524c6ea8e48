# SPDX-License-Identifier: Apache-2.0
"""Maps read through GDAL (rasterio): GeoTIFF, PDS3, PDS4, ISIS3, JPEG 2000 and others.

A map is opened first and read by windows, so that a whole HiRISE strip need not fit in memory.
Elevation is up here, and row 0 the southern one.
"""

import math
import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sim.errors import TerrainError

NODES_MAX = 50_000_000
VALUE_MAX = 50_000.0
_ELLIPSOID = re.compile(r'(?:SPHEROID|ELLIPSOID)\["[^"]*",\s*([-+.0-9eE]+),\s*([-+.0-9eE]+)')

Grid = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class MapPlace:
    """Where a map lies on its planet.

    Attributes:
        crs_wkt: The projection.
        x_min: Map x of the middle of column 0.
        y_min: Map y of the middle of row 0, the southern one.
        step: Edge of a pixel in the projection's unit.
    """

    crs_wkt: str
    x_min: float
    y_min: float
    step: float

    def xy(self, row: float, col: float) -> tuple[float, float]:
        """Map coordinates of a row and column, fractions allowed."""
        return self.x_min + col * self.step, self.y_min + row * self.step

    def row_col(self, x: float, y: float) -> tuple[float, float]:
        """Row and column, with fractions, of map coordinates."""
        return (y - self.y_min) / self.step, (x - self.x_min) / self.step

    def lonlat_deg(self, row: float, col: float) -> tuple[float, float]:
        """East longitude and latitude of a row and column."""
        longitudes, latitudes = self._lonlat_deg([self.xy(row, col)])
        return longitudes[0], latitudes[0]

    def cell_true_m(self, row: float, col: float) -> tuple[float, float]:
        """North and east size on the ground of the pixel at a row and column.

        Every projection stretches somewhere: equidistant cylindrical with its standard parallel at
        the equator makes a "1 m" pixel in Jezero (18.4 N) 0.949 m wide.
        """
        corners = [self.xy(row + a, col + b) for a, b in ((-0.5, 0), (0.5, 0), (0, -0.5), (0, 0.5))]
        longitudes, latitudes = self._lonlat_deg(corners)
        radius_m, flatness = self._ellipsoid()
        latitude = math.radians(self.lonlat_deg(row, col)[1])
        eccentricity2 = flatness * (2.0 - flatness)
        root = math.sqrt(1.0 - eccentricity2 * math.sin(latitude) ** 2)
        across_m, along_m = radius_m / root, radius_m * (1.0 - eccentricity2) / root**3

        def length_m(first: int, second: int) -> float:
            turn_deg = (longitudes[second] - longitudes[first] + 180.0) % 360.0 - 180.0
            east_m = across_m * math.cos(latitude) * math.radians(turn_deg)
            north_m = along_m * math.radians(latitudes[second] - latitudes[first])
            return math.hypot(east_m, north_m)

        return length_m(0, 1), length_m(2, 3)

    def _ellipsoid(self) -> tuple[float, float]:
        """Equatorial radius in metres, and flattening."""
        found = _ELLIPSOID.search(self.crs_wkt)
        if found is None:
            raise TerrainError("the map's projection names no ellipsoid, expected one")
        inverse = float(found[2])
        return float(found[1]), 1.0 / inverse if inverse else 0.0

    def _lonlat_deg(self, points: list[tuple[float, float]]) -> tuple[list[float], list[float]]:
        from rasterio.crs import CRS
        from rasterio.warp import transform

        radius_m, flatness = self._ellipsoid()
        planet = f"+proj=longlat +a={radius_m!r} +b={radius_m * (1.0 - flatness)!r} +no_defs"
        longitudes, latitudes = transform(
            CRS.from_wkt(self.crs_wkt),
            CRS.from_string(planet),
            [x for x, _ in points],
            [y for _, y in points],
        )
        return longitudes, latitudes


@dataclass(frozen=True, slots=True, eq=False)
class MapGrid:
    """A map that was opened, not read.

    Attributes:
        path: Its file.
        shape: Rows and columns.
        cell_m: Edge of a pixel as the file states it, in metres.
        place: Where it lies; None when the file does not say.
        read: Values of a window [rows, columns], row 0 south, NaN where there is no data.
    """

    path: Path
    shape: tuple[int, int]
    cell_m: float
    place: MapPlace | None
    read: Callable[[slice, slice], Grid]

    def cell_true_m(self, row: float, col: float) -> tuple[float, float]:
        """North and east size of a pixel on the ground; as stated where the map has no place."""
        return (
            (self.cell_m, self.cell_m) if self.place is None else self.place.cell_true_m(row, col)
        )


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """A rasterio dataset; every fault of it is one clear TerrainError."""
    try:
        import rasterio
        from rasterio.errors import CRSError, NotGeoreferencedWarning, RasterioError
    except ImportError:
        raise TerrainError(
            f"{path}: reading {path.suffix or 'this format'} needs rasterio,"
            " install it with: pip install 'enav-sim[orbital]'"
        ) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                yield dataset
    except (RasterioError, CRSError) as error:
        reason = str(error).splitlines()[0]
        raise TerrainError(f"{path}: not a raster that can be read: {reason}") from None


def open_raster(path: Path, band: int | None = None) -> MapGrid:
    """Open a projected raster in metres.

    Args:
        path: Any format that GDAL knows.
        band: Counted from 1; None expects a raster of one band.
    """
    with opened(path) as dataset:
        cell_m = _cell_m(path, dataset)
        chosen = _band(path, dataset, band)
        transform, shape = dataset.transform, dataset.shape
        place = None
        if dataset.crs is not None and dataset.crs.is_projected:
            # the corners of the raster, whichever way its rows and columns run
            x_west = min(transform.c, transform.c + transform.a * shape[1])
            y_south = min(transform.f, transform.f + transform.e * shape[0])
            step = float(abs(transform.a))
            place = MapPlace(dataset.crs.to_wkt(), x_west + 0.5 * step, y_south + 0.5 * step, step)
        south_up, east_left = transform.e > 0, transform.a < 0

    def read(rows: slice, cols: slice) -> Grid:
        return _read_window(path, chosen, shape, (rows, cols), (south_up, east_left))

    return MapGrid(path, (int(shape[0]), int(shape[1])), cell_m, place, read)


def _read_window(
    path: Path,
    band: int,
    shape: tuple[int, int],
    window: tuple[slice, slice],
    flips: tuple[bool, bool],
) -> Grid:
    from rasterio.windows import Window

    (rows, cols), (south_up, east_left) = window, flips
    height, width = rows.stop - rows.start, cols.stop - cols.start
    check_size(path, height, width)
    top = rows.start if south_up else shape[0] - rows.stop
    left = shape[1] - cols.stop if east_left else cols.start
    with opened(path) as dataset:
        raw = dataset.read(band, masked=True, window=Window(left, top, width, height))
        scale, offset = dataset.scales[band - 1], dataset.offsets[band - 1]
    values: Grid = raw.astype(np.float64).filled(np.nan) * scale + offset
    # products without a no-data tag still mark holes with huge values
    values[~(np.abs(values) <= VALUE_MAX)] = np.nan
    values = values if south_up else values[::-1]
    return values[:, ::-1] if east_left else values


def check_size(path: Path, rows: int, cols: int) -> None:
    """Refuse what is too small to be ground, or too large for memory."""
    if min(rows, cols) < 2 or rows * cols > NODES_MAX:
        raise TerrainError(
            f"{path}: {cols} x {rows} pixels, expected at least 2 x 2 and"
            f" at most {NODES_MAX} in all (cut a window out, e.g. with gdal_translate -projwin)"
        )


def _band(path: Path, dataset: Any, band: int | None) -> int:
    if band is None:
        if dataset.count != 1:
            raise TerrainError(f"{path}: {dataset.count} bands, expected one, or the wanted band")
        return 1
    if not 1 <= band <= dataset.count:
        raise TerrainError(f"{path}: no band {band}, expected 1 to {dataset.count}")
    return band


def _cell_m(path: Path, dataset: Any) -> float:
    """Pixel size in metres of an upright, square, projected raster."""
    transform = dataset.transform
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
    if not (math.isfinite(cell_x) and cell_x > 0):
        raise TerrainError(f"{path}: pixels of {cell_x:g} m, expected a positive size")
    return cell_x


def geotiff(values: npt.NDArray[np.float32], place: MapPlace | None, names: list[str]) -> bytes:
    """GeoTIFF of bands [band, row, column], row 0 south; NaN is no data.

    Without a place the coordinates are metres from the middle (`place.step` metres a pixel).
    """
    try:
        import rasterio
    except ImportError:
        raise TerrainError(
            "writing a GeoTIFF needs rasterio, install it with: pip install 'enav-sim[orbital]'"
        ) from None
    count, rows, cols = values.shape
    step = 1.0 if place is None else place.step
    west = -0.5 * cols if place is None else place.x_min - 0.5 * step
    north = 0.5 * rows if place is None else place.y_min + (rows - 0.5) * step
    profile = {
        "driver": "GTiff",
        "dtype": "float32",
        "count": count,
        "height": rows,
        "width": cols,
        "nodata": math.nan,
        "crs": place.crs_wkt if place is not None and place.crs_wkt else None,
        "transform": rasterio.Affine(step, 0.0, west, 0.0, -step, north),
        "compress": "deflate",
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        with rasterio.MemoryFile() as memory:
            with memory.open(**profile) as dataset:
                dataset.write(values[:, ::-1])
                for band, name in enumerate(names, start=1):
                    dataset.set_band_description(band, name)
            content: bytes = memory.read()
    return content
