// A test article that exercises links: at every step it sends telemetry packets whose number, sizes and bytes depend on
// every byte received so far and on every step time. Any packet lost, corrupted, repeated or moved to another step
// on the way in either direction changes all later packets, and answers range from one packet to more than a window of
// link.

#include <algorithm>
#include <array>
#include <new>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/big_endian.h"
#include "fsw/packets/packet.h"

namespace {

using vbar::fsw::Status;
namespace packets = vbar::fsw::packets;

/// FNV-1a, 64 bits (Fowler, Noll, Vo): short, and every byte changes it.
struct Hash {
  std::uint64_t value = 0xCBF29CE484222325U;
  void add(std::uint8_t byte) { value = (value ^ byte) * 0x100000001B3U; }
  void add_number(std::uint64_t number) {
    for (unsigned shift = 0; shift < 64; shift += 8) add(static_cast<std::uint8_t>(number >> shift));
  }
};

/// Marsaglia's xorshift generator, 64 bits: the payloads.
std::uint64_t next(std::uint64_t& state) {
  state ^= state << 13U;
  state ^= state >> 7U;
  state ^= state << 17U;
  return state;
}

/// One step in kLongAnswerEvery answers with up to kLongAnswer packets, the others with up to kShortAnswer.
constexpr std::uint64_t kLongAnswerEvery = 16;
constexpr std::uint64_t kLongAnswer = 80;
constexpr std::uint64_t kShortAnswer = 4;

struct EchoArticle {
  Hash hash;
  std::uint8_t spacecraft = 0;
  std::uint16_t sequence_count = 0;
  vbar_packet_sink sink = nullptr;
  void* sink_context = nullptr;

  void send(std::int64_t gps_time_ns, std::uint64_t& random) {
    std::array<std::uint8_t, packets::kMaxPayloadBytes> payload{};
    const std::size_t size = 1 + static_cast<std::size_t>(next(random) % payload.size());
    for (std::uint8_t& byte : std::span(payload).first(size)) byte = static_cast<std::uint8_t>(next(random) >> 56U);
    // Runs of zeros and of other bytes, the critical cases of byte stuffing.
    if (next(random) % 2 == 0) std::fill_n(payload.begin(), size / 2, std::uint8_t{0});

    packets::PacketHeader header;
    header.apid = packets::Apid::kTelemetryHealth;
    header.sequence_count = static_cast<std::uint16_t>(sequence_count++ & 0x3FFFU);
    header.time.ns = gps_time_ns;
    header.spacecraft = spacecraft;
    std::array<std::uint8_t, packets::kMaxPacketBytes> packet{};
    const auto written = packets::write_packet(header, std::span(payload).first(size), packet);
    if (written.ok()) sink(sink_context, packet.data(), written.value());
  }
};

/// A snapshot is the hash, the sequence count, and bytes that depend on both, so that it takes several frames of the
/// link and a piece in the wrong place is noticed.
constexpr std::size_t kSnapshotBytes = 5000;

void write_snapshot(std::uint64_t hash, std::uint16_t sequence_count, std::span<std::uint8_t> snapshot) {
  packets::write_big_endian(hash, snapshot, 0);
  packets::write_big_endian(sequence_count, snapshot, 8);
  std::uint64_t random = (hash ^ sequence_count) | 1U;
  for (std::uint8_t& byte : snapshot.subspan(10)) byte = static_cast<std::uint8_t>(next(random) >> 56U);
}

vbar_status as_c(Status status) {
  return static_cast<vbar_status>(status);
}

}  // namespace

extern "C" {

int32_t vbar_gnc_abi_version(void) {
  return VBAR_GNC_ABI_VERSION;
}
const char* vbar_gnc_name(void) {
  return "vbar link exerciser";
}
size_t vbar_gnc_state_size(void) {
  return sizeof(EchoArticle);
}
size_t vbar_gnc_state_alignment(void) {
  return alignof(EchoArticle);
}

vbar_status vbar_gnc_init(void* state, uint8_t spacecraft, vbar_packet_sink sink, void* sink_context) {
  auto* const article = ::new (state) EchoArticle;
  article->spacecraft = spacecraft;
  article->hash.add(spacecraft);
  vbar_gnc_set_sink(state, sink, sink_context);
  return as_c(Status::kOk);
}

void vbar_gnc_set_sink(void* state, vbar_packet_sink sink, void* sink_context) {
  auto* const article = static_cast<EchoArticle*>(state);
  article->sink = sink;
  article->sink_context = sink_context;
}

vbar_status vbar_gnc_receive(void* state, const uint8_t* packet, size_t size) {
  auto* const article = static_cast<EchoArticle*>(state);
  for (const std::uint8_t byte : std::span(packet, size)) article->hash.add(byte);
  return as_c(Status::kOk);
}

vbar_status vbar_gnc_step(void* state, int64_t gps_time_ns) {
  auto* const article = static_cast<EchoArticle*>(state);
  article->hash.add_number(static_cast<std::uint64_t>(gps_time_ns));
  std::uint64_t random = article->hash.value | 1U;  // xorshift must not start from zero
  const std::uint64_t most = next(random) % kLongAnswerEvery == 0 ? kLongAnswer : kShortAnswer;
  const std::uint64_t count = 1 + next(random) % most;
  for (std::uint64_t i = 0; i < count; ++i) article->send(gps_time_ns, random);
  return as_c(Status::kOk);
}

size_t vbar_gnc_snapshot_size(void) {
  return kSnapshotBytes;
}

vbar_status vbar_gnc_save(const void* state, uint8_t* snapshot, size_t size) {
  if (size < kSnapshotBytes) return as_c(Status::kTooShort);
  const auto* const article = static_cast<const EchoArticle*>(state);
  write_snapshot(article->hash.value, article->sequence_count, std::span(snapshot, kSnapshotBytes));
  return as_c(Status::kOk);
}

vbar_status vbar_gnc_restore(void* state, const uint8_t* snapshot, size_t size) {
  if (size != kSnapshotBytes) return as_c(Status::kTooShort);
  const std::span<const std::uint8_t> given(snapshot, size);
  const auto hash = packets::read_big_endian<std::uint64_t>(given, 0);
  const auto sequence_count = packets::read_big_endian<std::uint16_t>(given, 8);
  std::array<std::uint8_t, kSnapshotBytes> expected{};
  write_snapshot(hash, sequence_count, expected);
  if (!std::equal(given.begin(), given.end(), expected.begin())) return as_c(Status::kBadChecksum);
  auto* const article = static_cast<EchoArticle*>(state);
  article->hash.value = hash;
  article->sequence_count = sequence_count;
  return as_c(Status::kOk);
}

}  // extern "C"
