"""A run as channels of Protobuf messages: its tables, the frames of both spacecraft, paths and burns as a scene, pictures and events.
A file (MCAP) or a connection (foxglove.py) takes them.

The schemas of frames, scene, pictures and events are those of Foxglove (MIT licence), by name and number of each field that is
used; each table has a message of its own, whose fields are its columns. Times are UTC.
"""
import calendar
import math
import re

from vbar import orbit_messages
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


class RunChannels:
    """`sink` has channel(topic, schema, descriptors), which returns a number, add(number, time_ns, message) and drop(number). Rows that the run has got
    since the last call of add_new() are added by the next one."""

    def __init__(self, run, sink):
        self.run, self.sink, self.schema = run, sink, Schema(dict(FOXGLOVE))
        self.channels, self.done, self.attitudes, self.path = {}, {}, {}, []

    def add_new(self, is_whole=True):
        """`is_whole`: no table has rows of a step that others still lack."""
        self.tables()
        self.frames(is_whole)
        for part in (self.estimates, self.burns, self.pictures, self.events):
            part()

    def new_rows(self, part, count):
        """The numbers of the rows of a part behind those of the last call."""
        first, self.done[part] = self.done.get(part, 0), count
        return range(first, count)

    def time(self, time_s):
        utc = self.run.utc(time_s)
        return calendar.timegm(utc.timetuple()), 1000 * utc.microsecond

    def stamp(self, time_s):
        return dict(zip(("seconds", "nanos"), self.time(time_s)))

    def add(self, topic, message, time_s, values):
        if topic not in self.channels:
            self.channels[topic] = self.sink.channel(topic, message, self.schema.descriptor_set(message))
        seconds, nanos = self.time(time_s)
        self.sink.add(self.channels[topic], seconds * 10**9 + nanos, self.schema.encode(message, values))

    def tables(self):
        for name, table in self.run.tables.items():
            time = next((table[column] for column in TIMES if column in table), None)
            if not time:
                continue
            rows = self.new_rows(name, len(time))
            if rows and self._describe(name, table, rows):
                rows = range(len(time))
            topic, message = f"/tables/{name}", f"vbar.{name}"
            fields, reader = self.schema.messages.get(message), {"double": number, "string": str, "int64": lambda cell: int(cell or 0)}
            for k in rows:
                if time[k]:
                    values = {column: reader[kind](table[column][k]) for column, _, kind in fields[1:]}
                    self.add(topic, message, number(time[k]), values | {"timestamp": self.stamp(number(time[k]))})

    def _describe(self, name, table, rows):
        """Describes the message of a table by its cells. True if new rows have cells that the message so far cannot hold: the table has another channel then."""
        message = f"vbar.{name}"
        known = {column: kind for column, _, kind in self.schema.messages.get(message, ())}
        fields = [("timestamp", 1, "google.protobuf.Timestamp")]
        for column, cells in table.items():
            kind = known.get(column)
            new = cells if kind is None else cells[rows.start:]
            if kind != "string" and not all(map(is_number, new)):
                kind = "string"
            elif kind != "string" and any(re.fullmatch(r"-?\d{16,}", cell) for cell in new):
                kind = "int64"
            fields.append((column, len(fields) + 1, kind or "double"))
        is_other = bool(known) and fields != self.schema.messages[message]
        self.schema.messages[message] = fields
        if is_other and (channel := self.channels.pop(f"/tables/{name}", None)) is not None:
            self.sink.drop(channel)
        return is_other

    def frames(self, is_whole):
        """The bodies of servicer and target in the servicer's RTN frame, and the path so far."""
        truth, attitude = self.run.tables["truth"], self.run.tables.get("attitude", {"time_s": []})
        for k in self.new_rows("attitude of frames", len(attitude["time_s"])):
            self.attitudes[attitude["spacecraft"][k], number(attitude["time_s"][k])] = [number(attitude[f"q_body_eci_{axis}"][k]) for axis in "wxyz"]
        times = [number(cell) for cell in truth["time_s"][self.done.get("frames", 0):]]
        if not is_whole and attitude["time_s"]:
            times = [time for time in times if time <= number(attitude["time_s"][-1])]
        columns = (*orbit_messages.eci_columns("servicer"), *orbit_messages.relative_columns())
        crafts, first = sorted({"servicer", self.run.summary.get("target") or "target"}), len(self.path)
        for k, time in zip(self.new_rows("frames", self.done.get("frames", 0) + len(times)), times):
            state = [number(truth[column][k]) for column in columns]
            q_rtn_eci = quaternion_of(orbit_messages.rtn_axes(state[:3], state[3:6])[0])
            self.path.append(state[6:9])
            for craft in crafts:
                q = self.attitudes.get((craft, time))
                q_rtn_body = product(q_rtn_eci, (q[0], -q[1], -q[2], -q[3])) if q else IDENTITY
                self.add("/tf", "foxglove.FrameTransform", time, {
                    "timestamp": self.stamp(time), "parent_frame_id": ROOT, "child_frame_id": craft, "rotation": rotation(q_rtn_body),
                    "translation": point((0.0, 0.0, 0.0) if craft == "servicer" else state[6:9])})
        if len(self.path) > first:
            line = {"type": "LINE_STRIP", "pose": {"orientation": rotation(IDENTITY)}, "thickness": 2.0, "scale_invariant": True,
                    "points": [point(r) for r in self.path[::1 + len(self.path) // LONGEST_PATH]], "color": {"r": 0.2, "g": 0.5, "b": 1.0, "a": 1.0}}
            self.add_entity(times[0], "path of the target", lines=[line])

    def add_entity(self, time, name, **content):
        self.add("/scene", "foxglove.SceneUpdate", time, {"entities": [{"timestamp": self.stamp(time), "frame_id": ROOT, "id": name, **content}]})

    def estimates(self):
        table = self.run.tables.get("estimate", {"time_s": []})
        for k in self.new_rows("estimates", len(table["time_s"])):
            time, position = number(table["time_s"][k]), [number(table[column][k]) for column in orbit_messages.relative_columns()[:3]]
            if not math.isnan(position[0]):
                self.add("/target/estimated", "foxglove.PoseInFrame", time, {
                    "timestamp": self.stamp(time), "frame_id": ROOT, "pose": {"position": point(position), "orientation": rotation(IDENTITY)}})

    def burns(self):
        table = self.run.tables.get("maneuvers", {"execution_time_s": []})
        for k in self.new_rows("burns", len(table["execution_time_s"])):
            time, dv = number(table["execution_time_s"][k]), [number(table[f"executed_dv_rtn_{axis}_mps"][k]) for axis in "rtn"]
            size = math.hypot(*dv)
            if not size > 0.0:
                continue
            length = 1.0 + math.log10(1.0 + 1e4 * size)
            arrow = {"pose": {"position": point((0.0, 0.0, 0.0)), "orientation": rotation(along(dv))}, "shaft_length": length, "shaft_diameter": 0.1,
                     "head_length": 0.3, "head_diameter": 0.25, "color": {"r": 1.0, "g": 0.4, "b": 0.1, "a": 1.0}}
            self.add_entity(time, f"burn {k}", lifetime={"seconds": 600}, arrows=[arrow])

    def pictures(self):
        gallery = self.run.tables.get("gallery", {"time_s": []})
        for k in self.new_rows("pictures", len(gallery["time_s"])):
            time, file = number(gallery["time_s"][k]), self.run.folder / "gallery" / f"{int(gallery['image'][k]):05}.png"
            if file.is_file():
                self.add("/camera", "foxglove.CompressedImage", time, {"timestamp": self.stamp(time), "data": file.read_bytes(), "format": "png", "frame_id": "camera"})

    def events(self):
        table, levels = self.run.tables.get("telemetry_event", {"time_s": []}), {"information": "INFO", "warning": "WARNING", "fault": "ERROR"}
        for k in self.new_rows("events", len(table["time_s"])):
            time, event, severity, device, before, after, fault = (table[column][k] for column in (
                "time_s", "event", "severity", "device", "before", "after", "fault"))
            what = f"{device}: {before} to {after}" if event == "aid" else f"{event}: {fault}"
            self.add("/events", "foxglove.Log", number(time), {"timestamp": self.stamp(number(time)), "level": levels.get(severity, "INFO"), "message": what, "name": self.run.name})
