# SPDX-License-Identifier: Apache-2.0
"""A drive for Foxglove: poses, clouds, grids and events as MCAP messages in its schemas."""

import base64
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pyharness.dp import Kind, Message, Schema
from pyharness.errors import HarnessError
from pyharness.evr import evr_table, evr_text
from pyharness.export_tables import Written, leaves
from pyharness.records import KIND_END, Record

Json = dict[str, Any]
Messages = Iterator[tuple[str, str, Json]]
"""Topic, schema and content."""
WORLD, SITE = "world", "site"  # z up, as viewers want it; z down, as flight has it
UNKNOWN_Z_M = 1e8  # a surface cell above is unknown
LOG_LEVELS = {"DIAGNOSTIC": 1, "ACTIVITY_LOW": 2, "ACTIVITY_HIGH": 2, "FATAL": 5}
LOG_LEVEL_WARNING = 3
NUMERIC_TYPES = {"u1": 1, "i1": 2, "u2": 3, "i2": 4, "u4": 5, "i4": 6, "f4": 7, "f8": 8}


def write_mcap(schema: Schema, records: Iterable[Record], folder: Path) -> Written:
    """Write drive.mcap.

    Raises:
        HarnessError: mcap is not installed.
    """
    try:
        from mcap.writer import Writer
    except ImportError:
        raise HarnessError("--export mcap needs mcap: pip install 'enav-sim[export]'") from None
    path = folder / "drive.mcap"
    count = 0
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="enav-sim")
        channels: dict[str, int] = {}
        for topic, name, time_s, message in _messages(schema, records):
            if topic not in channels:
                text = json.dumps(SCHEMAS.get(name, {"type": "object"})).encode()
                number = writer.register_schema(name, "jsonschema", text)
                channels[topic] = writer.register_channel(topic, "json", number)
            time_ns = _nanoseconds(time_s)
            data = json.dumps(message, separators=(",", ":"), allow_nan=False).encode()
            writer.add_message(channels[topic], time_ns, data, time_ns)
            count += 1
        writer.finish()  # type: ignore[no-untyped-call]
    return [(path, count)]


def _messages(layout: Schema, records: Iterable[Record]) -> Iterator[tuple[str, str, float, Json]]:
    """Yield topic, schema, time and message: the standard ones, and the numbers of every record."""
    up = {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0}  # half a turn about north
    yield "/tf", "foxglove.FrameTransform", 0.0, _transform(0.0, WORLD, SITE, (0.0, 0.0, 0.0), up)
    for record in records:
        if record.kind == KIND_END:
            continue
        message = layout.decode(record.kind, record.payload)
        standard = _STANDARD.get(record.kind, _nothing)
        for topic, schema, data in standard(message, record.time_s):
            yield topic, schema, record.time_s, data
        name = layout.kinds[record.kind].name.lower()
        yield f"/records/{name}", f"enav.{name}", record.time_s, _numbers(message)


def _nothing(_: Message, __: float) -> Messages:
    yield from ()


def _numbers(message: Message) -> Json:
    """Return the fields that are single numbers."""
    columns = leaves(message.reshape(1))
    return {name: _finite(column[0].item()) for name, column in columns if column.ndim == 1}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


# ------------------------------------------------------------------ messages of each kind


def _truth(message: Message, time_s: float) -> Messages:
    yield from _pose_messages("truth", time_s, message["pose"])


def _estimate(message: Message, time_s: float) -> Messages:
    yield from _pose_messages("rover", time_s, message["pose"])


def _pose_messages(frame: str, time_s: float, pose: Message) -> Messages:
    place, turn = _place(pose), _quaternion(pose)
    transform = _transform(time_s, SITE, frame, place, turn)
    yield "/tf", "foxglove.FrameTransform", transform
    data = {"timestamp": _stamp(time_s), "frame_id": SITE, "pose": _pose(place, turn)}
    yield f"/{frame}", "foxglove.PoseInFrame", data


def _cloud(message: Message, time_s: float) -> Messages:
    points = message["points"][: int(message["point_count"])]
    data = {
        "timestamp": _stamp(time_s),
        "frame_id": SITE,
        "pose": _pose(_place(message["pose"]), _quaternion(message["pose"])),
        **_packed(points, {"x_m": "x", "y_m": "y", "z_m": "z"}, "point_stride"),
    }
    yield "/cloud", "foxglove.PointCloud", data


def _surface(message: Message, time_s: float) -> Messages:
    z = message["z_site_m"]
    cells = np.zeros(z.shape, [("elevation_m", "<f4")])
    cells["elevation_m"] = np.where(z < UNKNOWN_Z_M, -z, np.nan)
    yield "/surface", "foxglove.Grid", _grid(message, time_s, cells)


def _costmap(message: Message, time_s: float) -> Messages:
    yield "/costmap", "foxglove.Grid", _grid(message, time_s, message["cells"])


def _grid(message: Message, time_s: float, cells: npt.NDArray[Any]) -> Json:
    size = math.isqrt(len(cells))
    cell_m = float(message["cell_m"])
    place = (float(message["origin_row"]) * cell_m, float(message["origin_col"]) * cell_m, 0.0)
    # rows run east and columns north: a grid's columns lie along its x axis, which is north
    turned = cells.reshape(size, size).T.ravel()
    names = {name: name for name in cells.dtype.names or () if not name.startswith("pad_")}
    packed = _packed(turned, names, "cell_stride")
    return {
        "timestamp": _stamp(time_s),
        "frame_id": SITE,
        "pose": _pose(place, {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}),
        "column_count": size,
        "cell_size": {"x": cell_m, "y": cell_m},
        "row_stride": size * packed["cell_stride"],
        **packed,
    }


def _path(message: Message, time_s: float) -> Messages:
    points = message["path_points"][: int(message["path_point_count"])]
    level = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    poses = [_pose((float(p["x_m"]), float(p["y_m"]), float(p["z_m"])), level) for p in points]
    data = {"timestamp": _stamp(time_s), "frame_id": SITE, "poses": poses}
    yield "/path", "foxglove.PosesInFrame", data


def _evr(message: Message, time_s: float) -> Messages:
    number = int(message["id"])
    row = evr_table().get(number)
    data = {
        "timestamp": _stamp(time_s),
        "level": LOG_LEVELS.get(row.severity if row else "", LOG_LEVEL_WARNING),
        "message": evr_text(number, message["args"].tolist()),
        "name": row.name if row else str(number),
        "file": "",
        "line": 0,
    }
    yield "/evr", "foxglove.Log", data


_STANDARD: Mapping[int, Callable[[Message, float], Messages]] = {
    Kind.TRUTH: _truth,
    Kind.ESTIMATE: _estimate,
    Kind.PROCESS_DISPARITY_IN: _cloud,
    Kind.SURFACE: _surface,
    Kind.COSTMAP: _costmap,
    Kind.SELECT_ARC_OUT: _path,
    Kind.EVR: _evr,
    Kind.HOST_EVR: _evr,
}


# ------------------------------------------------------------------ parts of messages


def _nanoseconds(time_s: float) -> int:
    return round(max(0.0, time_s) * 1e9)


def _stamp(time_s: float) -> Json:
    seconds, nanoseconds = divmod(_nanoseconds(time_s), 1_000_000_000)
    return {"sec": seconds, "nsec": nanoseconds}


def _place(pose: Message) -> tuple[float, float, float]:
    x_m, y_m, z_m = (float(pose[name]) for name in ("x_site_m", "y_site_m", "z_site_m"))
    return x_m, y_m, z_m


def _quaternion(pose: Message) -> Json:
    """Return the turn from ROVER to SITE: Rz(yaw) Ry(pitch) Rx(roll)."""
    halves = [0.5 * float(pose[name]) for name in ("roll_rad", "pitch_rad", "yaw_rad")]
    (cr, cp, cy), (sr, sp, sy) = map(math.cos, halves), map(math.sin, halves)
    return {
        "x": sr * cp * cy - cr * sp * sy,
        "y": cr * sp * cy + sr * cp * sy,
        "z": cr * cp * sy - sr * sp * cy,
        "w": cr * cp * cy + sr * sp * sy,
    }


def _vector(place: tuple[float, float, float]) -> Json:
    return dict(zip("xyz", place, strict=True))


def _pose(place: tuple[float, float, float], turn: Json) -> Json:
    return {"position": _vector(place), "orientation": turn}


def _transform(
    time_s: float, parent: str, child: str, place: tuple[float, float, float], turn: Json
) -> Json:
    return {
        "timestamp": _stamp(time_s),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": _vector(place),
        "rotation": turn,
    }


def _packed(values: npt.NDArray[Any], names: Mapping[str, str], stride: str) -> Json:
    """Return records as bytes in little-endian order, with the description of their fields."""
    dtype = values.dtype.newbyteorder("<")
    places: Any = dtype.fields
    fields = [
        {"name": shown, "offset": places[name][1], "type": NUMERIC_TYPES[places[name][0].str[1:]]}
        for name, shown in names.items()
    ]
    data = base64.b64encode(values.astype(dtype).tobytes()).decode()
    return {stride: dtype.itemsize, "fields": fields, "data": data}


# ------------------------------------------------------------------ schemas


def _object(**properties: Json) -> Json:
    return {"type": "object", "properties": properties}


def _list(items: Json) -> Json:
    return {"type": "array", "items": items}


_NUMBER: Json = {"type": "number"}
_INTEGER: Json = {"type": "integer", "minimum": 0}
_TEXT: Json = {"type": "string"}
_BYTES: Json = {"type": "string", "contentEncoding": "base64"}
_TIME = _object(sec=_INTEGER, nsec=_INTEGER)
_VECTOR3 = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_POSE = _object(position=_VECTOR3, orientation=_QUATERNION)
_FIELDS = _list(_object(name=_TEXT, offset=_INTEGER, type=_INTEGER))
_IN_FRAME = {"timestamp": _TIME, "frame_id": _TEXT}

SCHEMAS: Mapping[str, Json] = {
    "foxglove.FrameTransform": _object(
        timestamp=_TIME,
        parent_frame_id=_TEXT,
        child_frame_id=_TEXT,
        translation=_VECTOR3,
        rotation=_QUATERNION,
    ),
    "foxglove.PoseInFrame": _object(**_IN_FRAME, pose=_POSE),
    "foxglove.PosesInFrame": _object(**_IN_FRAME, poses=_list(_POSE)),
    "foxglove.PointCloud": _object(
        **_IN_FRAME, pose=_POSE, point_stride=_INTEGER, fields=_FIELDS, data=_BYTES
    ),
    "foxglove.Grid": _object(
        **_IN_FRAME,
        pose=_POSE,
        column_count=_INTEGER,
        cell_size=_object(x=_NUMBER, y=_NUMBER),
        row_stride=_INTEGER,
        cell_stride=_INTEGER,
        fields=_FIELDS,
        data=_BYTES,
    ),
    "foxglove.Log": _object(
        timestamp=_TIME, level=_INTEGER, message=_TEXT, name=_TEXT, file=_TEXT, line=_INTEGER
    ),
}
"""What Foxglove's own schemas of these names ask for."""
