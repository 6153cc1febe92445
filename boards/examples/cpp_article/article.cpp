// A test article in C++17 that is not vbar's: a glideslope along the target's orbit, from true states. As flight code
// it needs neither heap, exceptions, run-time types nor a mathematics library.
//
// With the target at the relative position p and velocity v in the servicer's rotating RTN frame, and the hold point
// p_h, the velocity wanted is v_w = -(p - p_h) / tau, limited to kLargestSpeed: the approach slows down as it arrives.
// Each step commands dv = v - v_w, because a burn of the servicer changes the target's relative velocity by -dv.

#include <cstddef>
#include <cstdint>
#include <new>

#include "vbar_gnc.h"
#include "vbar_packets.h"

namespace {

constexpr double kTimeConstant_s = 300.0;
constexpr double kLargestSpeed = 0.2;      // m/s
constexpr double kLargestImpulse = 0.05;   // m/s
constexpr double kSmallestImpulse = 2e-3;  // m/s
constexpr std::int32_t kOk = 0, kInvalidArgument = 1, kWrongType = 9, kBadChecksum = 10;

struct Vector {
  double x = 0.0, y = 0.0, z = 0.0;
};
constexpr Vector kHold_rtn{0.0, 100.0, 0.0};  // m, of the target: the servicer stays behind it

constexpr Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vector operator*(double s, const Vector& a) {
  return {s * a.x, s * a.y, s * a.z};
}
constexpr double dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double norm(const Vector& a) {
  return __builtin_sqrt(dot(a, a));
}
Vector vector(const double (&a)[3]) {
  return {a[0], a[1], a[2]};
}
void put(const Vector& a, double (&to)[3]) {
  to[0] = a.x;
  to[1] = a.y;
  to[2] = a.z;
}
Vector limited(const Vector& a, double most) {
  const double size = norm(a);
  return size > most ? (most / size) * a : a;
}

struct Relative {
  Vector position_rtn;
  Vector velocity_rtn;  ///< in the rotating frame
};

class Article {
 public:
  Article(std::uint8_t spacecraft, vbar_packet_sink sink, void* context)
      : sink_(sink), context_(context), spacecraft_(spacecraft) {}

  void set_sink(vbar_packet_sink sink, void* context) {
    sink_ = sink;
    context_ = context;
  }

  std::int32_t receive(const std::uint8_t* bytes, std::size_t size) {
    vbar_packet packet;
    if (!vbar_read_packet(bytes, size, &packet)) return kBadChecksum;
    if (packet.header.spacecraft != spacecraft_) return kInvalidArgument;
    if (packet.header.apid == VBAR_APID_TICK) return vbar_read_tick(&packet, &tick_) ? kOk : kWrongType;
    if (packet.header.apid != VBAR_APID_IDEAL_NAVIGATION) return kOk;  // what this article has no use for
    if (!vbar_read_ideal_navigation(&packet, &states_)) return kWrongType;
    states_time_ns_ = packet.header.gps_time_ns;
    return kOk;
  }

  void step(std::int64_t now_ns) {
    const bool has_plane =
        norm(cross(vector(states_.servicer_position_eci), vector(states_.servicer_velocity_eci))) > 0.0;
    if (states_time_ns_ != now_ns || tick_.period_ns <= 0 || !has_plane) return;
    const Relative relative = relative_state();
    report(now_ns, relative);
    const Vector wanted = limited(-1.0 / kTimeConstant_s * (relative.position_rtn - kHold_rtn), kLargestSpeed);
    const Vector dv = relative.velocity_rtn - wanted;
    if (norm(dv) > kSmallestImpulse) command(now_ns + tick_.period_ns, limited(dv, kLargestImpulse));
  }

 private:
  [[nodiscard]] Relative relative_state() const {
    const Vector r = vector(states_.servicer_position_eci);
    const Vector v = vector(states_.servicer_velocity_eci);
    const Vector h = cross(r, v);
    const Vector axis_r = (1.0 / norm(r)) * r;
    const Vector axis_n = (1.0 / norm(h)) * h;
    const Vector axis_t = cross(axis_n, axis_r);
    const auto rotated = [&](const Vector& a) { return Vector{dot(axis_r, a), dot(axis_t, a), dot(axis_n, a)}; };
    const Vector position = rotated(vector(states_.target_position_eci) - r);
    const Vector velocity = rotated(vector(states_.target_velocity_eci) - v);
    const Vector rate{0.0, 0.0, norm(h) / dot(r, r)};  // rate of the frame
    return {position, velocity - cross(rate, position)};
  }

  void command(std::int64_t time_ns, const Vector& dv_rtn) {
    vbar_maneuver_command message{};
    message.maneuver_id = ++maneuvers_;
    message.waypoint_index = -1;
    message.solver = VBAR_WAYPOINT_SOLVER_NONE;
    put(dv_rtn, message.dv_rtn);
    const vbar_packet_header header = header_at(time_ns, static_cast<std::uint16_t>(maneuvers_ - 1));
    std::uint8_t packet[VBAR_MAX_PACKET_BYTES];
    sink_(context_, packet, vbar_write_maneuver_command(packet, &header, &message));
  }

  void report(std::int64_t now_ns, const Relative& relative) {
    vbar_telemetry_navigation message{};
    message.step = tick_.step;
    message.source = VBAR_TELEMETRY_NAVIGATION_SOURCE_IDEAL_NAVIGATION;
    message.valid = 1;
    put(vector(states_.servicer_position_eci), message.servicer_position_eci);
    put(vector(states_.servicer_velocity_eci), message.servicer_velocity_eci);
    put(relative.position_rtn, message.relative_position_rtn);
    put(relative.velocity_rtn, message.relative_velocity_rtn);
    const vbar_packet_header header = header_at(now_ns, reports_++);
    std::uint8_t packet[VBAR_MAX_PACKET_BYTES];
    sink_(context_, packet, vbar_write_telemetry_navigation(packet, &header, &message));
  }

  [[nodiscard]] vbar_packet_header header_at(std::int64_t time_ns, std::uint16_t sequence_count) const {
    vbar_packet_header header{};
    header.sequence_count = sequence_count;
    header.gps_time_ns = time_ns;
    header.spacecraft = spacecraft_;
    return header;
  }

  vbar_packet_sink sink_;
  void* context_;
  std::uint8_t spacecraft_;
  vbar_tick tick_{};
  vbar_ideal_navigation states_{};
  std::int64_t states_time_ns_ = -1;
  std::int32_t maneuvers_ = 0;
  std::uint16_t reports_ = 0;
};

Article& article(void* state) {
  return *static_cast<Article*>(state);
}

}  // namespace

std::int32_t vbar_gnc_abi_version() {
  return VBAR_GNC_ABI_VERSION;
}
const char* vbar_gnc_name() {
  return "example article in C++, version 1";
}
std::size_t vbar_gnc_state_size() {
  return sizeof(Article);
}
std::size_t vbar_gnc_state_alignment() {
  return alignof(Article);
}
vbar_status vbar_gnc_init(void* state, std::uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  if (state == nullptr || sink == nullptr) return kInvalidArgument;
  new (state) Article(spacecraft, sink, sink_context);
  return kOk;
}
void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  article(state).set_sink(sink, sink_context);
}
vbar_status vbar_gnc_receive(void* state, const std::uint8_t* packet, std::size_t size) {
  return article(state).receive(packet, size);
}
vbar_status vbar_gnc_step(void* state, std::int64_t gps_time_ns) {
  article(state).step(gps_time_ns);
  return kOk;
}
