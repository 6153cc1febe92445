/* A test article that is not vbar's: the interface of fsw/messaging/vbar_gnc.h in plain C, without a line of vbar's own
 * flight software. It shows all that another GNC stack needs to fly here, and no more: given the states of both
 * spacecraft, a proportional-derivative law closes in on a point behind the target and stays there.
 *
 * With x the relative position error and v the relative velocity (servicer's RTN), each step commands the impulse
 *   dv = T (w^2 x + 2 w v),   T the time between steps, w = 0.01 rad/s, |dv| <= 50 mm/s,
 * critically damped and, at ten times the orbital rate, stiff enough that orbital mechanics is a disturbance to it. */
#include <stdbool.h>
#include <string.h>

#include "vbar_gnc.h"
#include "vbar_packets.h"

enum { STATUS_OK = 0, STATUS_INVALID_ARGUMENT = 1, STATUS_BAD_CHECKSUM = 10, STATUS_WRONG_TYPE = 9 };

#define BANDWIDTH_RADPS 0.01
#define HOLD_DISTANCE_M 100.0 /* along the target's orbit, behind it */
#define LARGEST_DV_MPS 0.050
#define SMALLEST_DV_MPS 0.001

enum { R = 0, T = 1, N = 2 };

struct article {
  vbar_packet_sink sink;
  void* sink_context;
  uint8_t spacecraft;
  bool has_states;
  int64_t states_time_ns;
  struct vbar_ideal_navigation states;
  int64_t step, period_ns;
  unsigned maneuvers, reports; /* sequence counts */
};

/* Relative state of the target with respect to the servicer, in the servicer's rotating RTN frame. */
struct relative_state {
  double position_rtn[3];
  double velocity_rtn[3];
};

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Square root is exact by IEEE 754 and an instruction on every target; nothing else of a mathematics library is needed.
 */
static double length(const double a[3]) {
  return __builtin_sqrt(dot(a, a));
}

static bool relative_state_of(const struct article* self, struct relative_state* relative) {
  double h[3];
  cross(self->states.servicer_position_eci, self->states.servicer_velocity_eci, h);
  const double r = length(self->states.servicer_position_eci);
  const double h_length = length(h);
  if (!(r > 1.0) || !(h_length > 1.0)) {
    return false; /* no orbit, no frame */
  }
  double axes[3][3]; /* rows: R, T, N in ECI */
  for (int i = 0; i < 3; ++i) {
    axes[R][i] = self->states.servicer_position_eci[i] / r;
    axes[N][i] = h[i] / h_length;
  }
  cross(axes[N], axes[R], axes[T]);
  double position[3];
  double velocity[3];
  for (int i = 0; i < 3; ++i) {
    position[i] = self->states.target_position_eci[i] - self->states.servicer_position_eci[i];
    velocity[i] = self->states.target_velocity_eci[i] - self->states.servicer_velocity_eci[i];
  }
  for (int axis = 0; axis < 3; ++axis) {
    relative->position_rtn[axis] = dot(axes[axis], position);
    relative->velocity_rtn[axis] = dot(axes[axis], velocity);
  }
  const double rate = h_length / (r * r); /* of the frame, about N */
  relative->velocity_rtn[R] += rate * relative->position_rtn[T];
  relative->velocity_rtn[T] -= rate * relative->position_rtn[R];
  return true;
}

static void copy(double to[3], const double from[3]) {
  memcpy(to, from, 3 * sizeof from[0]);
}

static struct vbar_packet_header header_of(const struct article* self, unsigned sequence_count, int64_t gps_time_ns) {
  const struct vbar_packet_header header = {
      .sequence_count = (uint16_t)sequence_count, .gps_time_ns = gps_time_ns, .spacecraft = self->spacecraft};
  return header;
}

static void report(struct article* self, int64_t now_ns, const struct relative_state* relative) {
  struct vbar_telemetry_navigation message = {0}; /* sigmas and relative orbital elements: not used, 0 */
  message.step = self->step;
  message.source = VBAR_TELEMETRY_NAVIGATION_SOURCE_IDEAL_NAVIGATION;
  message.valid = 1;
  message.age_s = (double)(now_ns - self->states_time_ns) * 1e-9;
  copy(message.servicer_position_eci, self->states.servicer_position_eci);
  copy(message.servicer_velocity_eci, self->states.servicer_velocity_eci);
  copy(message.relative_position_rtn, relative->position_rtn);
  copy(message.relative_velocity_rtn, relative->velocity_rtn);
  uint8_t packet[VBAR_MAX_PACKET_BYTES];
  const struct vbar_packet_header header = header_of(self, self->reports++, now_ns);
  self->sink(self->sink_context, packet, vbar_write_telemetry_navigation(packet, &header, &message));
}

static void control(struct article* self, int64_t now_ns, const struct relative_state* relative) {
  const double period_s = (double)self->period_ns * 1e-9;
  double dv[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double error = relative->position_rtn[axis] - (axis == T ? HOLD_DISTANCE_M : 0.0);
    dv[axis] =
        period_s * (BANDWIDTH_RADPS * BANDWIDTH_RADPS * error + 2.0 * BANDWIDTH_RADPS * relative->velocity_rtn[axis]);
  }
  const double size = length(dv);
  if (!(size > SMALLEST_DV_MPS)) {
    return;
  }
  const double scale = size > LARGEST_DV_MPS ? LARGEST_DV_MPS / size : 1.0;
  const struct vbar_packet_header header = header_of(self, self->maneuvers, now_ns + self->period_ns);
  struct vbar_maneuver_command message = {0};
  message.maneuver_id = (int32_t)(++self->maneuvers & 0x7FFFFFFFU);
  message.waypoint_index = -1; /* no waypoint */
  message.solver = VBAR_WAYPOINT_SOLVER_NONE;
  for (int axis = 0; axis < 3; ++axis) {
    message.dv_rtn[axis] = scale * dv[axis];
  }
  uint8_t packet[VBAR_MAX_PACKET_BYTES];
  self->sink(self->sink_context, packet, vbar_write_maneuver_command(packet, &header, &message));
}

static vbar_status take_tick(struct article* self, const struct vbar_packet* packet) {
  struct vbar_tick tick;
  if (!vbar_read_tick(packet, &tick)) {
    return STATUS_WRONG_TYPE;
  }
  if (tick.period_ns <= 0) {
    return STATUS_INVALID_ARGUMENT;
  }
  self->step = tick.step;
  self->period_ns = tick.period_ns;
  return STATUS_OK;
}

static vbar_status take_states(struct article* self, const struct vbar_packet* packet) {
  struct vbar_ideal_navigation states;
  if (!vbar_read_ideal_navigation(packet, &states)) {
    return STATUS_WRONG_TYPE;
  }
  if (self->has_states && packet->header.gps_time_ns <= self->states_time_ns) {
    return STATUS_OK; /* the newest counts, in whatever order they came */
  }
  self->states = states;
  self->states_time_ns = packet->header.gps_time_ns;
  self->has_states = true;
  return STATUS_OK;
}

/* ------------------------------------------------------------------------------------------ the test article's
 * interface */

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}

const char* vbar_gnc_name(void) {
  return "example article in C, version 1";
}

size_t vbar_gnc_state_size(void) {
  return sizeof(struct article);
}

size_t vbar_gnc_state_alignment(void) {
  return _Alignof(struct article);
}

vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  struct article* self = state;
  if (self == NULL || sink == NULL) {
    return STATUS_INVALID_ARGUMENT;
  }
  memset(self, 0, sizeof *self);
  self->spacecraft = spacecraft;
  vbar_gnc_set_sink(state, sink, sink_context);
  return STATUS_OK;
}

void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  struct article* self = state;
  self->sink = sink;
  self->sink_context = sink_context;
}

vbar_status vbar_gnc_receive(void* state, const uint8_t* packet, size_t size) {
  struct article* self = state;
  struct vbar_packet received;
  if (!vbar_read_packet(packet, size, &received)) {
    return STATUS_BAD_CHECKSUM;
  }
  if (received.header.spacecraft != self->spacecraft) {
    return STATUS_INVALID_ARGUMENT;
  }
  switch (received.header.apid) {
    case VBAR_APID_TICK:
      return take_tick(self, &received);
    case VBAR_APID_IDEAL_NAVIGATION:
      return take_states(self, &received);
    default:
      return STATUS_OK; /* telecommands that this article has no use for */
  }
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  struct article* self = state;
  struct relative_state relative;
  if (!self->has_states || self->period_ns <= 0 || !relative_state_of(self, &relative)) {
    return STATUS_OK;
  }
  report(self, gps_time_ns, &relative);
  if (self->states_time_ns == gps_time_ns) { /* old states are reported, but not acted upon */
    control(self, gps_time_ns, &relative);
  }
  return STATUS_OK;
}
