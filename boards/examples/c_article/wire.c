#include "boards/examples/c_article/wire.h"

#include <string.h>

enum { HEADER_BYTES = 16, CRC_BYTES = 2, SECONDARY_HEADER = 0x0800, TELECOMMAND = 0x1000, UNSEGMENTED = 0xC000 };

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

static uint64_t read_big_endian(const uint8_t* bytes, size_t size) {
  uint64_t value = 0;
  for (size_t i = 0; i < size; ++i) {
    value = (value << 8) | bytes[i];
  }
  return value;
}

static void write_big_endian(uint8_t* bytes, size_t size, uint64_t value) {
  for (size_t i = size; i > 0; --i) {
    bytes[i - 1] = (uint8_t)(value & 0xFFU);
    value >>= 8;
  }
}

bool wire_open(struct wire_reader* reader, const uint8_t* packet, size_t size) {
  if (size < HEADER_BYTES + CRC_BYTES || size > WIRE_MAX_BYTES || read_big_endian(packet + 4, 2) + 7U != size ||
      crc16(packet, size - CRC_BYTES) != read_big_endian(packet + size - CRC_BYTES, CRC_BYTES)) {
    return false;
  }
  const unsigned identification = (unsigned)read_big_endian(packet, 2);
  if ((identification & 0xF800U) != (unsigned)(TELECOMMAND | SECONDARY_HEADER)) {
    return false;
  }
  reader->bytes = packet;
  reader->position = HEADER_BYTES;
  reader->end = size - CRC_BYTES;
  reader->apid = identification & 0x07FFU;
  reader->gps_time_ns = (int64_t)read_big_endian(packet + 6, 8);
  reader->spacecraft = packet[14];
  return true;
}

bool wire_begins_with(struct wire_reader* reader, uint64_t hash, size_t size) {
  if (reader->end - reader->position != size || (uint64_t)wire_read_int64(reader) != hash) {
    return false;
  }
  return true;
}

int64_t wire_read_int64(struct wire_reader* reader) {
  const uint64_t value = read_big_endian(reader->bytes + reader->position, 8);
  reader->position += 8;
  return (int64_t)value;
}

double wire_read_double(struct wire_reader* reader) {
  const int64_t bits = wire_read_int64(reader);
  double value = 0.0;
  memcpy(&value, &bits, sizeof value);
  return value;
}

void wire_begin(struct wire_writer* writer, unsigned apid, unsigned sequence_count, int64_t gps_time_ns,
                uint8_t spacecraft, uint64_t hash) {
  write_big_endian(writer->bytes, 2, (unsigned)SECONDARY_HEADER | apid);
  write_big_endian(writer->bytes + 2, 2, (unsigned)UNSEGMENTED | (sequence_count & 0x3FFFU));
  write_big_endian(writer->bytes + 6, 8, (uint64_t)gps_time_ns);
  writer->bytes[14] = spacecraft;
  writer->bytes[15] = 0; /* unit */
  writer->position = HEADER_BYTES;
  wire_write_int64(writer, (int64_t)hash);
}

void wire_write_int8(struct wire_writer* writer, int8_t value) {
  write_big_endian(writer->bytes + writer->position, 1, (uint64_t)value);
  writer->position += 1;
}

void wire_write_int32(struct wire_writer* writer, int32_t value) {
  write_big_endian(writer->bytes + writer->position, 4, (uint64_t)value);
  writer->position += 4;
}

void wire_write_int64(struct wire_writer* writer, int64_t value) {
  write_big_endian(writer->bytes + writer->position, 8, (uint64_t)value);
  writer->position += 8;
}

void wire_write_double(struct wire_writer* writer, double value) {
  int64_t bits = 0;
  memcpy(&bits, &value, sizeof bits);
  wire_write_int64(writer, bits);
}

size_t wire_finish(struct wire_writer* writer) {
  write_big_endian(writer->bytes + 4, 2, writer->position + CRC_BYTES - 7U);
  write_big_endian(writer->bytes + writer->position, CRC_BYTES, crc16(writer->bytes, writer->position));
  writer->position += CRC_BYTES;
  return writer->position;
}
