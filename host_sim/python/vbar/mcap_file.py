"""Writer of MCAP files, version 0: chunks without compression, with indices and statistics (mcap.dev/spec)."""
import struct
import zlib

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, SUMMARY_OFFSET, DATA_END = (
    1, 2, 3, 4, 5, 6, 7, 8, 11, 14, 15)
CHUNK_BYTES = 1 << 20


def text(value):
    data = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(data)) + data


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def pairs(form, values):
    data = b"".join(struct.pack(form, *pair) for pair in values)
    return struct.pack("<I", len(data)) + data


class Writer:
    def __init__(self, library):
        self.data = bytearray(MAGIC + record(HEADER, text("") + text(library)))
        self.schemas, self.channels, self.messages = {}, {}, []

    def channel(self, topic, schema_name, descriptor_set, metadata=()):
        """The number of a new channel of messages of a Protobuf schema."""
        if schema_name not in self.schemas:
            number = len(self.schemas) + 1
            self.schemas[schema_name] = number, record(SCHEMA, struct.pack("<H", number) + text(schema_name) + text("protobuf") + text(descriptor_set))
        number = len(self.channels)
        entries = b"".join(text(key) + text(value) for key, value in dict(metadata).items())
        self.channels[number] = record(CHANNEL, struct.pack("<HH", number, self.schemas[schema_name][0]) + text(topic) + text("protobuf") + text(entries))
        return number

    def add(self, channel, time_ns, data):
        self.messages.append((time_ns, len(self.messages), channel, data))

    def _definitions(self):
        return [data for _, data in self.schemas.values()], list(self.channels.values())

    def _chunks(self):
        """Messages in order of time, in parts of about CHUNK_BYTES."""
        chunk, size = [], 0
        for message in sorted(self.messages, key=lambda message: message[:2]):
            chunk.append(message)
            size += len(message[3])
            if size > CHUNK_BYTES:
                yield chunk
                chunk, size = [], 0
        if chunk:
            yield chunk

    def _write_chunk(self, messages, first):
        """Appends a chunk with its indices; the content of its record in the summary."""
        records = b"".join(b"".join(part) for part in self._definitions()) if first else b""
        records, places = bytearray(records), {}
        for time, _, channel, data in messages:
            places.setdefault(channel, []).append((time, len(records)))
            self.sequence[channel] = self.sequence.get(channel, 0) + 1
            records += record(MESSAGE, struct.pack("<HIQQ", channel, self.sequence[channel], time, time) + data)
        begin, end = messages[0][0], messages[-1][0]
        content = struct.pack("<QQQI", begin, end, len(records), zlib.crc32(records)) + text("") + struct.pack("<Q", len(records)) + records
        start = len(self.data)
        self.data += record(CHUNK, content)
        length, offsets = len(self.data) - start, []
        for channel, entries in places.items():
            offsets.append((channel, len(self.data)))
            self.data += record(MESSAGE_INDEX, struct.pack("<H", channel) + pairs("<QQ", entries))
        return (struct.pack("<QQQQ", begin, end, start, length) + pairs("<HQ", offsets) +
                struct.pack("<Q", len(self.data) - start - length) + text("") + struct.pack("<QQ", len(records), len(records)))

    def finish(self):
        """The bytes of the file."""
        self.sequence = {}
        indices = [self._write_chunk(chunk, first=k == 0) for k, chunk in enumerate(self._chunks())]
        self.data += record(DATA_END, struct.pack("<I", 0))
        times = [message[0] for message in self.messages] or [0]
        statistics = struct.pack("<QHIIIIQQ", len(self.messages), len(self.schemas), len(self.channels), 0, 0, len(indices), min(times), max(times)) + \
            pairs("<HQ", sorted(self.sequence.items()))
        summary_start, offsets = len(self.data), b""
        schemas, channels = self._definitions()
        for opcode, records in ((SCHEMA, schemas), (CHANNEL, channels), (STATISTICS, [record(STATISTICS, statistics)]),
                                (CHUNK_INDEX, [record(CHUNK_INDEX, index) for index in indices])):
            start = len(self.data)
            self.data += b"".join(records)
            offsets += record(SUMMARY_OFFSET, struct.pack("<BQQ", opcode, start, len(self.data) - start))
        offset_start = len(self.data)
        self.data += offsets + record(FOOTER, struct.pack("<QQI", summary_start, offset_start, 0)) + MAGIC
        return bytes(self.data)
