/* A range finder of the user's own in C: the distance to the target once a second, without errors. The interface is
 * that of flight software (fsw/messaging/vbar_gnc.h), whose program for a host brings the exchange with a run: the
 * inputs of a step are the truth in place of measurements, and its outputs are measurements in place of commands. */
#include <stdbool.h>
#include <string.h>

#include "vbar_gnc.h"
#include "vbar_packets.h"

enum { STATUS_OK = 0, STATUS_INVALID_ARGUMENT = 1, STATUS_WRONG_TYPE = 9, STATUS_BAD_CHECKSUM = 10 };
enum { SERVICER = 1, TARGET = 2, SPACECRAFT = 3 }; /* numbers, in the order of the mission file */

#define PERIOD_NS INT64_C(1000000000)

struct range_finder {
  vbar_packet_sink sink;
  void* sink_context;
  struct vbar_packet_header header; /* of its packets */
  bool has_started;
  bool is_known[SPACECRAFT]; /* in this step */
  struct vbar_true_state states[SPACECRAFT];
};

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}

const char* vbar_gnc_name(void) {
  return "range finder in C";
}

size_t vbar_gnc_state_size(void) {
  return sizeof(struct range_finder);
}

size_t vbar_gnc_state_alignment(void) {
  return _Alignof(struct range_finder);
}

void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  struct range_finder* self = state;
  self->sink = sink;
  self->sink_context = sink_context;
}

vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  struct range_finder* self = state;
  if (self == NULL || sink == NULL) {
    return STATUS_INVALID_ARGUMENT;
  }
  memset(self, 0, sizeof *self);
  self->header.spacecraft = spacecraft;
  vbar_gnc_set_sink(state, sink, sink_context);
  return STATUS_OK;
}

vbar_status vbar_gnc_receive(void* state, const uint8_t* bytes, size_t size) {
  struct range_finder* self = state;
  struct vbar_packet packet;
  if (self == NULL || bytes == NULL) {
    return STATUS_INVALID_ARGUMENT;
  }
  if (!vbar_read_packet(bytes, size, &packet)) {
    return STATUS_BAD_CHECKSUM;
  }
  switch (packet.header.apid) {
    case VBAR_APID_SOURCE_START:
      self->header.unit = packet.header.unit;
      return STATUS_OK;
    case VBAR_APID_TRUE_STATE:
      if (packet.header.spacecraft >= SPACECRAFT ||
          !vbar_read_true_state(&packet, &self->states[packet.header.spacecraft])) {
        return STATUS_WRONG_TYPE;
      }
      self->is_known[packet.header.spacecraft] = true;
      return STATUS_OK;
    default:
      return STATUS_OK; /* the Earth's orientation, commands, the tick: not needed */
  }
}

static double distance(const double a[3], const double b[3]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  }
  return __builtin_sqrt(sum);
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  struct range_finder* self = state;
  uint8_t packet[VBAR_MAX_PACKET_BYTES];
  if (self == NULL) {
    return STATUS_INVALID_ARGUMENT;
  }
  struct vbar_source_answer answer = {.available_ns = gps_time_ns};
  self->header.gps_time_ns = gps_time_ns;
  if (self->is_known[SERVICER] && self->is_known[TARGET]) {
    const struct vbar_range_measurement range = {
        .range_m = distance(self->states[SERVICER].position_eci, self->states[TARGET].position_eci)};
    self->sink(self->sink_context, packet, vbar_write_range_measurement(packet, &self->header, &range));
    ++self->header.sequence_count;
  }
  answer.next_epoch_ns = gps_time_ns + (self->has_started ? PERIOD_NS : 0); /* the first step has no truth */
  self->has_started = true;
  memset(self->is_known, 0, sizeof self->is_known);
  self->sink(self->sink_context, packet, vbar_write_source_answer(packet, &self->header, &answer));
  return STATUS_OK;
}
