"""A run as MCAP: its tables, the frames of both spacecraft, paths and burns as a scene, pictures and events.

The schemas of frames, scene, pictures and events are those of Foxglove (MIT licence), by name and number of each field that is
used; each table has a message of its own, whose fields are its columns. Times are UTC.
"""
import calendar
import math
import re

from vbar import mcap_file, orbit_messages
from vbar.protobuf import Schema
from vbar.recorded_tables import is_number, number

POINT = [("x", 1, "double"), ("y", 2, "double"), ("z", 3, "double")]
TIME = [("seconds", 1, "int64"), ("nanos", 2, "int32")]
STAMP = ("timestamp", 1, "google.protobuf.Timestamp")
FOXGLOVE = {
    "google.protobuf.Timestamp": TIME,
    "google.protobuf.Duration": TIME,
    "foxglove.Vector3": POINT,
    "foxglove.Point3": POINT,
    "foxglove.Quaternion": [*POINT, ("w", 4, "double")],
    "foxglove.Color": [("r", 1, "double"), ("g", 2, "double"), ("b", 3, "double"), ("a", 4, "double")],
    "foxglove.Pose": [("position", 1, "foxglove.Vector3"), ("orientation", 2, "foxglove.Quaternion")],
    "foxglove.PoseInFrame": [STAMP, ("frame_id", 2, "string"), ("pose", 3, "foxglove.Pose")],
    "foxglove.FrameTransform": [STAMP, ("parent_frame_id", 2, "string"), ("child_frame_id", 3, "string"),
                                ("translation", 4, "foxglove.Vector3"), ("rotation", 5, "foxglove.Quaternion")],
    "foxglove.CompressedImage": [STAMP, ("data", 2, "bytes"), ("format", 3, "string"), ("frame_id", 4, "string")],
    "foxglove.Log": [STAMP, ("level", 2, {"UNKNOWN": 0, "DEBUG": 1, "INFO": 2, "WARNING": 3, "ERROR": 4, "FATAL": 5}),
                     ("message", 3, "string"), ("name", 4, "string")],
    "foxglove.ArrowPrimitive": [("pose", 1, "foxglove.Pose"), ("shaft_length", 2, "double"), ("shaft_diameter", 3, "double"),
                                ("head_length", 4, "double"), ("head_diameter", 5, "double"), ("color", 6, "foxglove.Color")],
    "foxglove.SpherePrimitive": [("pose", 1, "foxglove.Pose"), ("size", 2, "foxglove.Vector3"), ("color", 3, "foxglove.Color")],
    "foxglove.LinePrimitive": [("type", 1, {"LINE_STRIP": 0, "LINE_LOOP": 1, "LINE_LIST": 2}), ("pose", 2, "foxglove.Pose"),
                               ("thickness", 3, "double"), ("scale_invariant", 4, "bool"), ("points", 5, "repeated foxglove.Point3"),
                               ("color", 6, "foxglove.Color")],
    "foxglove.SceneEntity": [STAMP, ("frame_id", 2, "string"), ("id", 3, "string"), ("lifetime", 4, "google.protobuf.Duration"),
                             ("frame_locked", 5, "bool"), ("arrows", 7, "repeated foxglove.ArrowPrimitive"),
                             ("spheres", 9, "repeated foxglove.SpherePrimitive"), ("lines", 11, "repeated foxglove.LinePrimitive")],
    "foxglove.SceneUpdate": [("entities", 2, "repeated foxglove.SceneEntity")],
}
ROOT = "servicer_rtn"
IDENTITY = (1.0, 0.0, 0.0, 0.0)
TIMES = ("time_s", "execution_time_s", "begin_s")
LONGEST_PATH = 2000


def point(values):
    return dict(zip("xyz", values))


def rotation(q):
    return dict(zip("wxyz", q))


def product(a, b):
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def quaternion_of(rows):
    """The unit quaternion that turns components as a rotation matrix of these rows does."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    candidates = ((1 + a + e + i, h - f, c - g, d - b), (h - f, 1 + a - e - i, b + d, c + g),
                  (c - g, b + d, 1 - a + e - i, f + h), (d - b, c + g, f + h, 1 - a - e + i))
    best = max(range(4), key=lambda k: candidates[k][k])
    length = math.hypot(*candidates[best])
    return tuple(x / length for x in candidates[best])


def along(direction):
    """The rotation that turns the x axis into a direction."""
    x, y, z = orbit_messages.unit(direction)
    if x < -0.999999:
        return (0.0, 0.0, 0.0, 1.0)
    length = math.sqrt(2.0 * (1.0 + x))
    return (0.5 * length, 0.0, -z / length, y / length)


class Exporter:
    def __init__(self, run):
        self.run = run
        self.schema = Schema(dict(FOXGLOVE))
        self.file = mcap_file.Writer("vbar")

    def time(self, time_s):
        utc = self.run.utc(time_s)
        return calendar.timegm(utc.timetuple()), 1000 * utc.microsecond

    def stamp(self, time_s):
        return dict(zip(("seconds", "nanos"), self.time(time_s)))

    def channel(self, topic, message):
        number = self.file.channel(topic, message, self.schema.descriptor_set(message))

        def add(time_s, values):
            seconds, nanos = self.time(time_s)
            self.file.add(number, seconds * 10**9 + nanos, self.schema.encode(message, values))
        return add

    def tables(self):
        for name, table in self.run.tables.items():
            time = next((table[column] for column in TIMES if column in table), None)
            if not time:
                continue
            fields = [("timestamp", 1, "google.protobuf.Timestamp")]
            for column, cells in table.items():
                kind = "double" if all(map(is_number, cells)) else "string"
                if kind == "double" and any(re.fullmatch(r"-?\d{16,}", cell) for cell in cells):
                    kind = "int64"
                fields.append((column, len(fields) + 1, kind))
            self.schema.messages[f"vbar.{name}"] = fields
            add = self.channel(f"/tables/{name}", f"vbar.{name}")
            reader = {"double": number, "string": str, "int64": lambda cell: int(cell or 0)}
            for k, cell in enumerate(time):
                if cell:
                    values = {column: reader[kind](table[column][k]) for column, _, kind in fields[1:]}
                    add(number(cell), values | {"timestamp": self.stamp(number(cell))})

    def attitudes(self):
        """{(spacecraft, time): q_body_eci}"""
        if "attitude" not in self.run.tables:
            return {}
        rows = self.run.numbers("attitude", "time_s", *(f"q_body_eci_{axis}" for axis in "wxyz"))
        return {(craft, row[0]): row[1:] for craft, row in zip(self.run.tables["attitude"]["spacecraft"], rows)}

    def frames(self):
        """The bodies of servicer and target in the servicer's RTN frame, and the estimated position of the target there."""
        add, attitudes, crafts = self.channel("/tf", "foxglove.FrameTransform"), self.attitudes(), {"servicer", self.run.summary.get("target") or "target"}
        rows = self.run.numbers("truth", "time_s", *orbit_messages.eci_columns("servicer"), *orbit_messages.relative_columns())
        for time, *state in rows:
            q_rtn_eci = quaternion_of(orbit_messages.rtn_axes(state[:3], state[3:6])[0])
            for craft in sorted(crafts):
                q = attitudes.get((craft, time))
                q_rtn_body = product(q_rtn_eci, (q[0], -q[1], -q[2], -q[3])) if q else IDENTITY
                add(time, {"timestamp": self.stamp(time), "parent_frame_id": ROOT, "child_frame_id": craft, "rotation": rotation(q_rtn_body),
                           "translation": point((0.0, 0.0, 0.0) if craft == "servicer" else state[6:9])})
        if "estimate" in self.run.tables:
            add = self.channel("/target/estimated", "foxglove.PoseInFrame")
            for time, *position in self.run.numbers("estimate", "time_s", *orbit_messages.relative_columns()[:3]):
                if not math.isnan(position[0]):
                    add(time, {"timestamp": self.stamp(time), "frame_id": ROOT,
                               "pose": {"position": point(position), "orientation": rotation(IDENTITY)}})

    def scene(self):
        add = self.channel("/scene", "foxglove.SceneUpdate")
        path = self.run.numbers("truth", "time_s", *orbit_messages.relative_columns()[:3])
        start = path[0][0]
        line = {"type": "LINE_STRIP", "pose": {"orientation": rotation(IDENTITY)}, "thickness": 2.0, "scale_invariant": True,
                "points": [point(row[1:]) for row in path[::1 + len(path) // LONGEST_PATH]], "color": {"r": 0.2, "g": 0.5, "b": 1.0, "a": 1.0}}
        add(start, {"entities": [{"timestamp": self.stamp(start), "frame_id": ROOT, "id": "path of the target", "lines": [line]}]})
        columns = [f"executed_dv_rtn_{axis}_mps" for axis in "rtn"]
        if "maneuvers" not in self.run.tables:
            return
        for k, (time, *dv) in enumerate(self.run.numbers("maneuvers", "execution_time_s", *columns)):
            size = math.hypot(*dv)
            if not size > 0.0:
                continue
            length = 1.0 + math.log10(1.0 + 1e4 * size)
            arrow = {"pose": {"position": point((0.0, 0.0, 0.0)), "orientation": rotation(along(dv))}, "shaft_length": length, "shaft_diameter": 0.1,
                     "head_length": 0.3, "head_diameter": 0.25, "color": {"r": 1.0, "g": 0.4, "b": 0.1, "a": 1.0}}
            add(time, {"entities": [{"timestamp": self.stamp(time), "frame_id": ROOT, "id": f"burn {k}", "lifetime": {"seconds": 600}, "arrows": [arrow]}]})

    def pictures(self):
        gallery = self.run.tables.get("gallery")
        if not gallery:
            return
        add = self.channel("/camera", "foxglove.CompressedImage")
        for cell, image in zip(gallery["time_s"], gallery["image"]):
            file = self.run.folder / "gallery" / f"{int(image):05}.png"
            if file.is_file():
                add(number(cell), {"timestamp": self.stamp(number(cell)), "data": file.read_bytes(), "format": "png", "frame_id": "camera"})

    def events(self):
        table = self.run.tables.get("telemetry_event")
        if not table:
            return
        add = self.channel("/events", "foxglove.Log")
        levels = {"information": "INFO", "warning": "WARNING", "fault": "ERROR"}
        for cell, event, severity, device, before, after, fault in zip(*(table[column] for column in (
                "time_s", "event", "severity", "device", "before", "after", "fault"))):
            what = f"{device}: {before} to {after}" if event == "aid" else f"{event}: {fault}"
            add(number(cell), {"timestamp": self.stamp(number(cell)), "level": levels.get(severity, "INFO"), "message": what, "name": self.run.name})


def mcap_of(run):
    """The bytes of an MCAP file with a run."""
    exporter = Exporter(run)
    for part in (exporter.tables, exporter.frames, exporter.scene, exporter.pictures, exporter.events):
        part()
    return exporter.file.finish()
