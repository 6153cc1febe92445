#!/usr/bin/env python3
"""Generates the packet library in C from the definitions: make_c_packets.py vbar.lcm message_list.h FOLDER

FOLDER receives vbar_packets.h and vbar_packets.c: for every message a struct, its APID, type hash and size, its constants,
a reader and a writer. The library needs neither heap nor LCM and is meant for flight software that is not this project's.
It also receives vbar_apids.py, the APIDs for programs in Python, whose messages lcm-gen makes.
"""
import re
import sys
from pathlib import Path

STRUCT = re.compile(r"((?:^//[^\n]*\n)*)^struct (\w+) \{\n(.*?)\n\}", re.S | re.M)
CONSTANT = re.compile(r"k([A-Z]\w*)\s*=\s*(-?\w+)")
FIELD = re.compile(r"  (\w+) (\w+)(?:\[(\d+)\])?;\s*(?://\s*(.*))?$")
MESSAGE = re.compile(r"X\(::vbar::(\w+), \w+, (0x[0-9A-F]+),")

# Type of vbar.lcm: type of C, bytes.
PRIMITIVES = {"int8_t": ("int8_t", 1), "int16_t": ("int16_t", 2), "int32_t": ("int32_t", 4), "int64_t": ("int64_t", 8),
              "float": ("float", 4), "double": ("double", 8), "byte": ("uint8_t", 1), "boolean": ("int8_t", 1)}
MOST_PAYLOAD_BYTES = 1358  # packet.h
MASK = (1 << 64) - 1


class Field:
    def __init__(self, kind, name, count, comment):
        self.kind, self.name, self.count, self.comment = kind, name, int(count) if count else None, comment or ""


class Struct:
    def __init__(self, comment, name, body):
        self.comment, self.name = comment, name
        self.fields, self.constants = [], []
        for line in body.split("\n"):
            if line.startswith("  const "):
                self.constants += CONSTANT.findall(line.split("//")[0])
            elif match := FIELD.match(line):
                self.fields.append(Field(*match.groups()))
            elif line.strip().startswith("//"):
                if self.fields:
                    self.fields[-1].comment += " " + line.strip()[2:].strip()
            elif line.strip():
                sys.exit(f"struct {name}: not understood: {line}")


def signed(value):
    value &= MASK
    return value - (1 << 64) if value >> 63 else value


def hash_with(value, byte):
    """LCM's fingerprint: the value is a signed number of 64 bits, whose right shift keeps the sign."""
    return signed(((value << 8) ^ (value >> 55)) + byte)


def hash_with_text(value, text):
    for byte in (len(text), *text.encode()):
        value = hash_with(value, byte)
    return value


def type_hash(struct, structs):
    """The first eight bytes of an encoded message."""
    value = 0x12345678
    for field in struct.fields:
        value = hash_with_text(value, field.name)
        if field.kind in PRIMITIVES:
            value = hash_with_text(value, field.kind)
        value = hash_with(value, 0 if field.count is None else 1)
        if field.count is not None:
            value = hash_with_text(hash_with(value, 0), str(field.count))  # 0: a constant dimension
    for field in struct.fields:
        if field.kind not in PRIMITIVES:
            value = signed(value + type_hash(structs[field.kind], structs))
    return ((value << 1) + ((value >> 63) & 1)) & MASK


def size_of(struct, structs):
    """Of the fields, without the hash."""
    return sum((field.count or 1) * (PRIMITIVES[field.kind][1] if field.kind in PRIMITIVES else size_of(structs[field.kind], structs))
               for field in struct.fields)


def upper(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).upper()


def definition(struct):
    lines = [line.replace("//", " *", 1) for line in struct.comment.strip().split("\n") if line and not re.match(r"// -{20}", line)]
    text = "/*" + "\n".join(lines)[2:] + " */\n" if lines else ""
    text += f"struct vbar_{struct.name} {{\n"
    for field in struct.fields:
        kind = PRIMITIVES[field.kind][0] if field.kind in PRIMITIVES else f"struct vbar_{field.kind}"
        count = f"[{field.count}]" if field.count is not None else ""
        comment = f" /* {field.comment} */" if field.comment else ""
        text += f"  {kind} {field.name}{count};{comment}\n"
    text += "};\n"
    if struct.constants:
        rows = ",\n".join(f"  VBAR_{struct.name.upper()}_{upper(name)} = {value}" for name, value in struct.constants)
        text += f"enum {{\n{rows}\n}};\n"
    return text


def declarations(struct, apid, structs):
    capital = struct.name.upper()
    return (f"#define VBAR_APID_{capital} {apid}U\n"
            f"#define VBAR_HASH_{capital} UINT64_C(0x{type_hash(struct, structs):016x})\n"
            f"#define VBAR_BYTES_{capital} {8 + size_of(struct, structs)}U\n"
            f"bool vbar_read_{struct.name}(const struct vbar_packet* packet, struct vbar_{struct.name}* message);\n"
            f"size_t vbar_write_{struct.name}(uint8_t* packet, const struct vbar_packet_header* header,\n"
            f"                               const struct vbar_{struct.name}* message);\n")


def loop(field, body):
    """`body(element)` for each element of a field."""
    if field.count is None:
        return f"  {body(field.name)}\n"
    return f"  for (size_t i = 0; i < {field.count}; ++i) {{\n    {body(field.name + '[i]')}\n  }}\n"


def codec(struct):
    """get_ and put_ of the fields of a struct; get_ is false for a number that is not finite."""
    def get(field):
        if field.kind in ("float", "double"):
            return lambda e: f"are_finite = get_{field.kind}(at, &message->{e}) && are_finite;"
        if field.kind in PRIMITIVES:
            kind, size = PRIMITIVES[field.kind]
            return lambda e: f"message->{e} = ({kind})get(at, {size});"
        return lambda e: f"are_finite = get_{field.kind}(at, &message->{e}) && are_finite;"

    def put(field):
        if field.kind in ("float", "double"):
            return lambda e: f"put_{field.kind}(at, message->{e});"
        if field.kind in PRIMITIVES:
            return lambda e: f"put(at, {PRIMITIVES[field.kind][1]}, (uint64_t)message->{e});"
        return lambda e: f"put_{field.kind}(at, &message->{e});"

    readers = "".join(loop(field, get(field)) for field in struct.fields)
    writers = "".join(loop(field, put(field)) for field in struct.fields)
    return (f"static bool get_{struct.name}(const uint8_t** at, struct vbar_{struct.name}* message) {{\n"
            f"  bool are_finite = true;\n{readers}  return are_finite;\n}}\n\n"
            f"static void put_{struct.name}(uint8_t** at, const struct vbar_{struct.name}* message) {{\n{writers}}}\n\n")


def functions(struct):
    capital = struct.name.upper()
    return f"""bool vbar_read_{struct.name}(const struct vbar_packet* packet, struct vbar_{struct.name}* message) {{
  const uint8_t* at = payload_of(packet, VBAR_APID_{capital}, VBAR_HASH_{capital}, VBAR_BYTES_{capital});
  return at != NULL && get_{struct.name}(&at, message);
}}

size_t vbar_write_{struct.name}(uint8_t* packet, const struct vbar_packet_header* header,
                               const struct vbar_{struct.name}* message) {{
  uint8_t* at = begin(packet, header, VBAR_APID_{capital}, VBAR_HASH_{capital});
  put_{struct.name}(&at, message);
  return finish(packet, at);
}}

"""


def nested_first(structs):
    """A struct after those that it contains."""
    ordered = []

    def add(name):
        for field in structs[name].fields:
            if field.kind not in PRIMITIVES:
                add(field.kind)
        if name not in ordered:
            ordered.append(name)
    for name in structs:
        add(name)
    return [structs[name] for name in ordered]


HEADER_BEGIN = """/* Packets of a flight computer in C, generated from vbar.lcm by make_c_packets.py: CCSDS space packets that carry one
 * message each. No heap, no input or output. A packet or message that is damaged, of another type or size, or that holds
 * a number that is not finite, is refused. */
#ifndef VBAR_PACKETS_H
#define VBAR_PACKETS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VBAR_MAX_PACKET_BYTES 1376U

/* What a packet says of its message; `apid` is set by the writer of a message. */
struct vbar_packet_header {
  uint16_t apid;
  uint16_t sequence_count; /* counts the packets of an APID, 14 bits */
  int64_t gps_time_ns;     /* since 1980-01-06 */
  uint8_t spacecraft;
  uint8_t unit; /* index of the sensor or actuator of its kind */
};

/* A checked packet; `payload` points into the bytes that it was read from. */
struct vbar_packet {
  struct vbar_packet_header header;
  const uint8_t* payload;
  size_t payload_bytes;
};

/* Checks length, header and CRC-16. False leaves `packet` undefined. */
bool vbar_read_packet(const uint8_t* bytes, size_t size, struct vbar_packet* packet);

/* vbar_read_X: whether the packet holds a message X, which it then writes; false leaves the message undefined.
 * vbar_write_X: writes a packet of at most VBAR_MAX_PACKET_BYTES bytes and returns its size. */

"""

HEADER_END = """
#ifdef __cplusplus
}
#endif

#endif
"""

SOURCE_BEGIN = """/* Generated from vbar.lcm by make_c_packets.py. All numbers on the wire are big-endian. */
#include "vbar_packets.h"

#include <string.h>

enum { HEADER_BYTES = 16, CRC_BYTES = 2, SECONDARY_HEADER = 0x0800, TO_FLIGHT = 0x1000, UNSEGMENTED = 0xC000, FROM_FLIGHT_APID = 0x400 };

/* CRC-16/CCITT-FALSE: polynomial 0x1021, all ones at first, most significant bit first. */
static uint16_t crc16(const uint8_t* bytes, size_t size) {
  unsigned crc = 0xFFFFU;
  for (size_t i = 0; i < size; ++i) {
    crc ^= (unsigned)bytes[i] << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0U ? ((crc << 1) ^ 0x1021U) & 0xFFFFU : crc << 1;
    }
  }
  return (uint16_t)crc;
}

static uint64_t get(const uint8_t** at, size_t size) {
  uint64_t value = 0;
  for (size_t i = 0; i < size; ++i) {
    value = (value << 8) | *(*at)++;
  }
  return value;
}

static void put(uint8_t** at, size_t size, uint64_t value) {
  for (size_t i = size; i > 0; --i) {
    (*at)[i - 1] = (uint8_t)(value & 0xFFU);
    value >>= 8;
  }
  *at += size;
}

static bool get_double(const uint8_t** at, double* value) {
  const uint64_t bits = get(at, 8);
  memcpy(value, &bits, sizeof *value);
  return (bits >> 52 & 0x7FFU) != 0x7FFU;
}

static void put_double(uint8_t** at, double value) {
  uint64_t bits = 0;
  memcpy(&bits, &value, sizeof bits);
  put(at, 8, bits);
}

static inline bool get_float(const uint8_t** at, float* value) {
  const uint32_t bits = (uint32_t)get(at, 4);
  memcpy(value, &bits, sizeof *value);
  return (bits >> 23 & 0xFFU) != 0xFFU;
}

static inline void put_float(uint8_t** at, float value) {
  uint32_t bits = 0;
  memcpy(&bits, &value, sizeof bits);
  put(at, 4, bits);
}

bool vbar_read_packet(const uint8_t* bytes, size_t size, struct vbar_packet* packet) {
  if (size < HEADER_BYTES + CRC_BYTES || size > VBAR_MAX_PACKET_BYTES) {
    return false;
  }
  const uint8_t* at = bytes;
  const unsigned identification = (unsigned)get(&at, 2);
  const unsigned sequence = (unsigned)get(&at, 2);
  const size_t length = (size_t)get(&at, 2);
  const uint8_t* end = bytes + size - CRC_BYTES;
  const unsigned apid = identification & 0x07FFU;
  const unsigned type = apid < FROM_FLIGHT_APID ? TO_FLIGHT : 0U;
  if (length + 7U != size || (identification & 0xF800U) != (type | SECONDARY_HEADER) ||
      (sequence & UNSEGMENTED) != UNSEGMENTED || crc16(bytes, size - CRC_BYTES) != get(&end, CRC_BYTES)) {
    return false;
  }
  packet->header.apid = (uint16_t)apid;
  packet->header.sequence_count = (uint16_t)(sequence & 0x3FFFU);
  packet->header.gps_time_ns = (int64_t)get(&at, 8);
  packet->header.spacecraft = (uint8_t)get(&at, 1);
  packet->header.unit = (uint8_t)get(&at, 1);
  packet->payload = at;
  packet->payload_bytes = size - HEADER_BYTES - CRC_BYTES;
  return true;
}

/* The fields of the one message that a packet is expected to hold, or null. */
static const uint8_t* payload_of(const struct vbar_packet* packet, unsigned apid, uint64_t hash, size_t size) {
  const uint8_t* at = packet->payload;
  if (packet->header.apid != apid || packet->payload_bytes != size || get(&at, 8) != hash) {
    return NULL;
  }
  return at;
}

static uint8_t* begin(uint8_t* packet, const struct vbar_packet_header* header, unsigned apid, uint64_t hash) {
  uint8_t* at = packet;
  put(&at, 2, SECONDARY_HEADER | apid | (apid < FROM_FLIGHT_APID ? TO_FLIGHT : 0U));
  put(&at, 2, UNSEGMENTED | (header->sequence_count & 0x3FFFU));
  put(&at, 2, 0); /* the length, by finish() */
  put(&at, 8, (uint64_t)header->gps_time_ns);
  put(&at, 1, header->spacecraft);
  put(&at, 1, header->unit);
  put(&at, 8, hash);
  return at;
}

static size_t finish(uint8_t* packet, uint8_t* at) {
  const size_t before_crc = (size_t)(at - packet);
  uint8_t* length = packet + 4;
  put(&length, 2, before_crc + CRC_BYTES - 7U);
  put(&at, CRC_BYTES, crc16(packet, before_crc));
  return before_crc + CRC_BYTES;
}

"""


def main(definitions, message_list, folder):
    structs = {name: Struct(comment, name, body) for comment, name, body in STRUCT.findall(Path(definitions).read_text())}
    apids = dict(MESSAGE.findall(Path(message_list).read_text()))
    header, source = HEADER_BEGIN, SOURCE_BEGIN
    ordered = nested_first(structs)
    for struct in ordered:
        header += definition(struct)
        source += codec(struct)
        if struct.name in apids:
            if 8 + size_of(struct, structs) > MOST_PAYLOAD_BYTES:
                sys.exit(f"{struct.name} is longer than the payload of a packet")
            header += declarations(struct, apids[struct.name], structs)
            source += functions(struct)
        header += "\n"
    unknown = set(apids) - set(structs)
    if unknown or not apids:
        sys.exit(f"{message_list}: no structs {', '.join(sorted(unknown))} in {definitions}" if unknown else f"{message_list}: no message")
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    (target / "vbar_packets.h").write_text(header.rstrip("\n") + "\n" + HEADER_END)
    (target / "vbar_packets.c").write_text(source.rstrip("\n") + "\n")
    rows = "".join(f'    "{name}": {apid},\n' for name, apid in apids.items())
    (target / "vbar_apids.py").write_text(f'"""APID of each message of vbar.lcm."""\n\nAPIDS = {{\n{rows}}}\n')


if __name__ == "__main__":
    main(*sys.argv[1:])
