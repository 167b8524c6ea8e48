# SPDX-License-Identifier: Apache-2.0
"""Writes the same ground as a map in every format that is read."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

RADIUS_M = 3396190.0
MISSING = np.array(0xFF7FFFFB, dtype=">u4").view(">f4").astype(np.float32)[()]


def eqc(standard_latitude_deg: float = 0.0) -> str:
    return f"+proj=eqc +lat_ts={standard_latitude_deg} +R={RADIUS_M} +units=m +no_defs"


def write_map(path: Path, up_m: npt.ArrayLike, **changes: Any) -> Path:
    """Write heights [row, column], row 0 north, or several bands [band, row, column]."""
    rasterio = pytest.importorskip("rasterio")
    values = np.asarray(up_m)
    values = values[None] if values.ndim == 2 else values
    drivers = {".tif": "GTiff", ".xml": "PDS4", ".cub": "ISIS3", ".jp2": "JP2OpenJPEG"}
    settings = {
        "driver": drivers[path.suffix],
        "dtype": values.dtype.name,
        "count": values.shape[0],
        "height": values.shape[1],
        "width": values.shape[2],
        "crs": eqc(),
        "transform": rasterio.Affine(1, 0, 500, 0, -1, 900),
        **changes,
    }
    with rasterio.open(path, "w", **settings) as dataset:
        dataset.write(values)
    return path


def write_pds3(
    path: Path, up_m: npt.ArrayLike, west: float, north: float, detached: bool = False
) -> Path:
    """HiRISE-like product: IMAGE of 32-bit floats with its label in front, or beside it."""
    values = np.asarray(up_m, dtype="<f4")
    lines, samples = values.shape
    record = 4 * samples
    label_records = -(-4096 // record)
    pointer = f'("{path.with_suffix(".IMG").name}", 1)' if detached else str(label_records + 1)
    rows = f"""PDS_VERSION_ID = PDS3
RECORD_TYPE = FIXED_LENGTH
RECORD_BYTES = {record}
FILE_RECORDS = {lines + label_records}
LABEL_RECORDS = {label_records}
^IMAGE = {pointer}
OBJECT = IMAGE
  LINES = {lines}
  LINE_SAMPLES = {samples}
  BANDS = 1
  SAMPLE_TYPE = PC_REAL
  SAMPLE_BITS = 32
  MISSING_CONSTANT = 16#FF7FFFFB#
END_OBJECT = IMAGE
OBJECT = IMAGE_MAP_PROJECTION
  MAP_PROJECTION_TYPE = "EQUIRECTANGULAR"
  A_AXIS_RADIUS = 3396.19 <KM>
  B_AXIS_RADIUS = 3396.19 <KM>
  C_AXIS_RADIUS = 3396.19 <KM>
  POSITIVE_LONGITUDE_DIRECTION = "EAST"
  CENTER_LATITUDE = 0.0 <DEG>
  CENTER_LONGITUDE = 0.0 <DEG>
  MAP_SCALE = 1.0 <METERS/PIXEL>
  LINE_PROJECTION_OFFSET = {north - 0.5} <PIXEL>
  SAMPLE_PROJECTION_OFFSET = {-west - 0.5} <PIXEL>
END_OBJECT = IMAGE_MAP_PROJECTION
END
""".replace("\n", "\r\n").encode()
    assert len(rows) <= record * label_records
    if detached:
        path.write_bytes(rows)
        path.with_suffix(".IMG").write_bytes(values.tobytes())
    else:
        path.write_bytes(rows.ljust(record * label_records) + values.tobytes())
    return path
