"""Messages against LCM itself: the Python types that lcm-gen makes, and the type hash by its published rule.
Usage: check_lcm.py TOOL DEFINITION"""

import importlib
import json
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile

from crc import crc16_ccitt_false
from peer import ask, expect, skip

HEADER_BYTES = 16
CRC_BYTES = 2
SIZES = {"byte": 1, "int8_t": 1, "int16_t": 2, "int32_t": 4, "int64_t": 8, "float": 4, "double": 8}


def definitions(path):
    """{struct: [(type, name, length or None)]} in order of the file."""
    structs = {}
    for line in open(path, encoding="utf-8"):
        if opened := re.match(r"struct (\w+)", line):
            fields = structs[opened[1]] = []
        elif field := re.match(r"\s+(\w+) (\w+)(?:\[(\d+)\])?;", line):
            fields.append((field[1], field[2], int(field[3]) if field[3] else None))
    return structs


def signed(value):
    return (value + 2**63) % 2**64 - 2**63


def type_hash(structs, name):
    """LCM's fingerprint of a type (LCM type specification, "Fingerprint Computation")."""
    value = 0x12345678

    def update(byte):
        nonlocal value
        value = signed(((value << 8) ^ (value >> 55)) + byte)

    def update_string(text):
        update(len(text))
        for character in text:
            update(ord(character))

    nested = 0
    for kind, field, length in structs[name]:
        update_string(field)
        if kind in SIZES:
            update_string(kind)
        else:
            nested += type_hash(structs, kind)
        update(0 if length is None else 1)
        if length is not None:
            update(0)  # a constant dimension
            update_string(str(length))
    value = (value + nested) % 2**64
    return (value << 1 | value >> 63) % 2**64


def random_value(kind, source):
    if kind == "double":
        return source.choice([0.0, -0.0, 5e-324, 1.7e308, source.uniform(-1e7, 1e7), source.gauss(0, 1e-3)])
    if kind == "float":
        return source.choice([0.0, -0.0, 0.5, -1024.25, float(source.randrange(-(2**20), 2**20))])
    if kind == "byte":
        return source.randrange(256)
    bits = 8 * SIZES[kind] - 1
    return source.choice([-(2**bits), 2**bits - 1, 0, source.randrange(-(2**bits), 2**bits)])


def random_message(types, structs, name, source):
    message = getattr(types, name)()
    for kind, field, length in structs[name]:
        make = ((lambda: random_value(kind, source)) if kind in SIZES else
                (lambda: random_message(types, structs, kind, source)))
        value = make() if length is None else [make() for _ in range(length)]
        setattr(message, field, bytes(value) if kind == "byte" and length is not None else value)
    return message


def packet_of(apid, payload, count):
    """A space packet, put together here from the text of packet.h."""
    first = (0x1800 if apid < 0x400 else 0x0800) | apid
    head = struct.pack(">HHHqBB", first, 0xC000 | count, HEADER_BYTES + len(payload) + CRC_BYTES - 7, 123456789, 1, 2)
    return head + payload + struct.pack(">H", crc16_ccitt_false(head + payload))


def check_fields(message, fields, where):
    for name, expected in fields.items():
        found = getattr(message, name)
        if isinstance(expected, list) and expected and isinstance(expected[0], dict):
            for part, part_expected in zip(found, expected, strict=True):
                check_fields(part, part_expected, f"{where}.{name}")
            continue
        found = list(found) if isinstance(expected, list) else found
        expect(found == expected, f"{where}.{name}: {found} instead of {expected}")


def main():
    tool, definition = sys.argv[1:3]
    if not shutil.which("lcm-gen"):
        skip("lcm-gen is not installed")
    structs = definitions(definition)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["lcm-gen", "-p", "--ppath", folder, definition], check=True, capture_output=True)
        sys.path.insert(0, folder)
        types = importlib.import_module("vbar")
        source = random.Random(2)

        examples = json.loads(ask(tool, "packets")[0])
        for example in examples:
            packet = bytes.fromhex(example["packet"])
            payload = packet[HEADER_BYTES:-CRC_BYTES]
            name = example["message"]
            expect(struct.unpack(">qBB", packet[6:HEADER_BYTES]) ==
                   (example["time_ns"], example["spacecraft"], example["unit"]), f"secondary header of {packet.hex()}")
            check_fields(getattr(types, name).decode(payload), example["fields"], name)

        apids = json.loads(ask(tool, "apids")[0])
        expect(set(apids) | {"waypoint"} == set(structs), f"every struct is a packet or part of one: {apids.keys()}")
        packets = []
        for name, apid in apids.items():
            for count in range(20):
                payload = random_message(types, structs, name, source).encode()
                expect(int.from_bytes(payload[:8], "big") == type_hash(structs, name), f"type hash of {name}")
                packets.append(packet_of(apid, payload, count))
        again = ask(tool, "reencode", [p.hex() for p in packets])
        for packet, answer in zip(packets, again, strict=True):
            expect(answer == packet.hex(), f"{packet.hex()} came back as {answer}")
    print(f"{len(examples)} examples and {len(packets)} random messages of {len(apids)} types agree")


main()
