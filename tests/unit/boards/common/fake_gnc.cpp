#include "tests/unit/boards/common/fake_gnc.h"

#include <cstring>
#include <new>

#include "fsw/packets/messages.h"

namespace vbar::testing {
namespace {

struct State {
  std::uint64_t digest;
  vbar_packet_sink sink;
  void* context;
};
static_assert(sizeof(State) <= 64);

int steps = 0;

/// FNV-1a, 64 bits.
std::uint64_t digested(std::uint64_t digest, const std::uint8_t* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) digest = (digest ^ bytes[i]) * 0x100000001B3U;
  return digest;
}

std::vector<Bytes> default_output(std::uint64_t digest) {
  std::vector<Bytes> packets;
  const int count = static_cast<int>(digest % 8 == 0 ? digest / 8 % 71 : digest / 8 % 6);
  for (int i = 0; i < count; ++i) packets.push_back(fake_output(digest, i));
  return packets;
}

void say(const State& state, const std::vector<Bytes>& packets) {
  for (const Bytes& packet : packets) state.sink(state.context, packet.data(), packet.size());
}

}  // namespace

FakeGncSettings& fake_gnc_settings() {
  static FakeGncSettings settings;
  return settings;
}

std::vector<FakeKey>& fake_gnc_keys() {
  static std::vector<FakeKey> keys;
  return keys;
}

void reset_fake_gnc() {
  fake_gnc_keys().clear();
  fake_gnc_settings() = FakeGncSettings{};
  fake_gnc_settings().step_output = default_output;
  steps = 0;
}

int fake_gnc_steps() {
  return steps;
}

Bytes fake_output(std::uint64_t digest, int number) {
  vbar::telemetry_health message{};
  message.step = static_cast<std::int64_t>(digest >> 1U);
  message.faults = number;
  Bytes packet(fsw::packets::kMaxPacketBytes);
  packet.resize(fsw::packets::encode({}, message, packet).value());
  return packet;
}

}  // namespace vbar::testing

using vbar::testing::State;

extern "C" {

int32_t vbar_gnc_abi_version(void) {
  return vbar::testing::fake_gnc_settings().abi_version;
}
const char* vbar_gnc_name(void) {
  return "fake";
}
size_t vbar_gnc_state_size(void) {
  return vbar::testing::fake_gnc_settings().state_size;
}
size_t vbar_gnc_state_alignment(void) {
  return vbar::testing::fake_gnc_settings().state_alignment;
}

vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  if (vbar::testing::fake_gnc_settings().init_status != 0) return vbar::testing::fake_gnc_settings().init_status;
  const auto* made = new (state) State{0xCBF29CE484222325U + spacecraft, sink, sink_context};
  say(*made, vbar::testing::fake_gnc_settings().init_output);
  return 0;
}

void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  static_cast<State*>(state)->sink = sink;
  static_cast<State*>(state)->context = sink_context;
}

vbar_status vbar_gnc_authenticate(void* /*state*/, const uint8_t* key, uint16_t index, uint64_t sequence) {
  vbar::testing::fake_gnc_keys().push_back({{key, key + VBAR_GNC_KEY_BYTES}, index, sequence});
  return vbar::testing::fake_gnc_settings().authenticate_status;
}

uint64_t vbar_gnc_telecommand_sequence(const void* /*state*/) {
  return vbar::testing::fake_gnc_settings().sequence_reached;
}

vbar_status vbar_gnc_receive(void* state, const uint8_t* packet, size_t size) {
  auto* const self = static_cast<State*>(state);
  self->digest = vbar::testing::digested(self->digest, packet, size);
  return 0;
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  auto* const self = static_cast<State*>(state);
  std::uint8_t time[sizeof gps_time_ns];
  std::memcpy(time, &gps_time_ns, sizeof time);
  self->digest = vbar::testing::digested(self->digest, time, sizeof time);
  ++vbar::testing::steps;
  say(*self, vbar::testing::fake_gnc_settings().step_output(self->digest));
  return 0;
}
}
