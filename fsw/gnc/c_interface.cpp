// The C interface of the flight software (vbar_gnc.h).

#include <algorithm>
#include <cstring>
#include <new>

#include "fsw/gnc/gnc.h"
#include "fsw/messaging/vbar_gnc.h"

namespace {

using vbar::fsw::Status;
using vbar::fsw::gnc::Gnc;

vbar_status as_c(Status status) {
  return static_cast<vbar_status>(status);
}

bool is_aligned(const void* state) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the address itself is required
  return reinterpret_cast<std::uintptr_t>(state) % alignof(Gnc) == 0;
}

}  // namespace

extern "C" {

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}

const char* vbar_gnc_name(void) {
  return "vbar GNC 0.3.0";
}

size_t vbar_gnc_state_size(void) {
  return sizeof(Gnc);
}

size_t vbar_gnc_state_alignment(void) {
  return alignof(Gnc);
}

vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  if (state == nullptr || sink == nullptr || !is_aligned(state)) return as_c(Status::kInvalidArgument);
  // Padding included, the state is a function of what the flight software received.
  std::memset(state, 0, sizeof(Gnc));
  new (state) Gnc(spacecraft, sink, sink_context);
  return as_c(Status::kOk);
}

void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  static_cast<Gnc*>(state)->set_sink(sink, sink_context);
}

vbar_status vbar_gnc_receive(void* state, const uint8_t* packet, size_t size) {
  if (state == nullptr || packet == nullptr) return as_c(Status::kInvalidArgument);
  return as_c(static_cast<Gnc*>(state)->receive({packet, size}));
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  if (state == nullptr) return as_c(Status::kInvalidArgument);
  return as_c(static_cast<Gnc*>(state)->step({gps_time_ns}));
}

vbar_status vbar_gnc_authenticate(void* state, const uint8_t* key, uint16_t index, uint64_t sequence) {
  if (state == nullptr || key == nullptr) return as_c(Status::kInvalidArgument);
  vbar::fsw::packets::TelecommandSecurity security{.index = index, .sequence = sequence};
  static_assert(VBAR_GNC_KEY_BYTES == vbar::fsw::packets::kTelecommandKeyBytes);
  std::copy_n(key, security.key.size(), security.key.begin());
  static_cast<Gnc*>(state)->authenticate(security);
  return as_c(Status::kOk);
}

uint64_t vbar_gnc_telecommand_sequence(const void* state) {
  return state == nullptr ? 0 : static_cast<const Gnc*>(state)->telecommand_sequence();
}

size_t vbar_gnc_snapshot_size(void) {
  return Gnc::kSnapshotBytes;
}

vbar_status vbar_gnc_save(const void* state, uint8_t* snapshot, size_t size) {
  if (state == nullptr || snapshot == nullptr) return as_c(Status::kInvalidArgument);
  return as_c(static_cast<const Gnc*>(state)->save({snapshot, size}));
}

vbar_status vbar_gnc_restore(void* state, const uint8_t* snapshot, size_t size) {
  if (state == nullptr || snapshot == nullptr) return as_c(Status::kInvalidArgument);
  return as_c(static_cast<Gnc*>(state)->restore({snapshot, size}));
}

}  // extern "C"
