/* The packets this article reads and writes, by hand: CCSDS space packets as fsw/packets/packet.h lays them out, with
 * LCM-encoded messages of fsw/packets/vbar.lcm inside. All fields are big-endian. */
#ifndef VBAR_BOARDS_EXAMPLES_C_ARTICLE_WIRE_H
#define VBAR_BOARDS_EXAMPLES_C_ARTICLE_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
  WIRE_APID_TICK = 0x001,
  WIRE_APID_IDEAL_NAVIGATION = 0x010,
  WIRE_APID_MANEUVER_COMMAND = 0x401,
  WIRE_APID_TELEMETRY_NAVIGATION = 0x501,
  WIRE_MAX_BYTES = 1376
};

/* Type hashes, as lcm-gen makes them of vbar.lcm: the first eight bytes of a payload. */
#define WIRE_HASH_TICK UINT64_C(0x864dd63edf53b0e7)
#define WIRE_HASH_IDEAL_NAVIGATION UINT64_C(0xc7135961c1142a68)
#define WIRE_HASH_MANEUVER_COMMAND UINT64_C(0x251b4eea31927344)
#define WIRE_HASH_TELEMETRY_NAVIGATION UINT64_C(0x1c935749ce107812)

/* A packet being read, or written; `position` walks through its payload. A reader checks before it reads
 * (wire_open, wire_begins_with), a writer never exceeds WIRE_MAX_BYTES because its messages are of fixed size. */
struct wire_reader {
  const uint8_t* bytes;
  size_t position;
  size_t end; /* of the payload */
  unsigned apid;
  int64_t gps_time_ns;
  uint8_t spacecraft;
};

struct wire_writer {
  uint8_t bytes[WIRE_MAX_BYTES];
  size_t position;
};

/* Checks length, header and CRC-16 of a packet; false leaves `reader` undefined. */
bool wire_open(struct wire_reader* reader, const uint8_t* packet, size_t size);
/* True if the payload is one message of that hash and of `size` bytes, hash included; the hash has been read then. */
bool wire_begins_with(struct wire_reader* reader, uint64_t hash, size_t size);
int64_t wire_read_int64(struct wire_reader* reader);
double wire_read_double(struct wire_reader* reader);

void wire_begin(struct wire_writer* writer, unsigned apid, unsigned sequence_count, int64_t gps_time_ns,
                uint8_t spacecraft, uint64_t hash);
void wire_write_int8(struct wire_writer* writer, int8_t value);
void wire_write_int32(struct wire_writer* writer, int32_t value);
void wire_write_int64(struct wire_writer* writer, int64_t value);
void wire_write_double(struct wire_writer* writer, double value);
/* Writes length and CRC; returns the packet's size. */
size_t wire_finish(struct wire_writer* writer);

#endif
