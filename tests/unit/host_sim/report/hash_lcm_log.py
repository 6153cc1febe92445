"""Commands' and telemetry's SHA-256 from an LCM log alone: an independent reader of LCM's log format (LCM documentation,
"Log file format") and of the packet record (host_sim/twins/packet_record.lcm). Prints both, a line each."""

import hashlib
import struct
import sys

SYNC_WORD = 0xEDA1DA01
EVENT_HEAD = struct.Struct(">IQQII")  # sync word, event number, microseconds, channel size, data size
RECORD_HEAD = struct.Struct(">QqqbI")  # type hash, step, GPS time, direction, packet size


def events(data):
    at = 0
    while at < len(data):
        sync, number, _, channel_size, size = EVENT_HEAD.unpack_from(data, at)
        assert sync == SYNC_WORD, f"no sync word at byte {at}"
        at += EVENT_HEAD.size
        channel = data[at : at + channel_size].decode()
        yield channel, data[at + channel_size : at + channel_size + size]
        at += channel_size + size


commands, telemetry = hashlib.sha256(), hashlib.sha256()
with open(sys.argv[1], "rb") as log:
    for channel, record in events(log.read()):
        if channel != "VBAR_PACKET":
            continue
        *_, size = RECORD_HEAD.unpack_from(record)
        packet = record[RECORD_HEAD.size :]
        assert len(packet) == size
        apid = struct.unpack_from(">H", packet)[0] & 0x7FF
        if apid == 0x401:
            commands.update(packet)
        elif apid & 0x700 == 0x500:
            telemetry.update(packet)
print(commands.hexdigest())
print(telemetry.hexdigest())
