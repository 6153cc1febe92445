// Snapshot, restart, and which steps are accepted.

#include <array>
#include <cstring>
#include <new>

#include "fsw/gnc/gnc.h"
#include "fsw/packets/crc.h"
#include "fsw/packets/security_trailer.h"

namespace vbar::fsw::gnc {
namespace {

constexpr std::uint32_t kMagic = 0x52414256;  // "VBAR" in the order of a little-endian computer
constexpr std::uint32_t kVersion = 5;
constexpr Duration kOldestWarm = duration_of_seconds(600);

/// Precedes a snapshot; without padding. The representation is that of the computer.
struct SnapshotHeader {
  std::uint32_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint64_t bytes = 0;  ///< size of the snapshot with this header
  std::int64_t step = 0;    ///< number of the next step
  std::int64_t time_ns = 0;
  std::uint32_t spacecraft = 0;
  std::uint32_t crc = 0;  ///< CRC-32 of all that precedes it and all that follows it
};
static_assert(sizeof(SnapshotHeader) == 40);

constexpr std::size_t kInboxAt = sizeof(SnapshotHeader);
constexpr std::size_t kOutboxAt = kInboxAt + sizeof(messaging::Inbox::Retained);
constexpr std::size_t kStateAt = kOutboxAt + sizeof(messaging::Outbox::Retained);
constexpr std::size_t kCodeAt = kStateAt + sizeof(GncState);
constexpr std::size_t kBytes = kCodeAt + packets::kSecurityCodeBytes;

/// Returns the code by which a snapshot is known as this computer's own; zeros without a key. Its first byte is that of
/// kMagic, 'V' or 'R', with which no telecommand begins.
std::array<std::uint8_t, packets::kSecurityCodeBytes> code_of(std::span<const std::uint8_t> snapshot,
                                                              const packets::TelecommandAuthentication& keys) {
  return keys.code_of(snapshot.first(offsetof(SnapshotHeader, crc)),
                      snapshot.subspan(sizeof(SnapshotHeader), kCodeAt - sizeof(SnapshotHeader)));
}

std::uint32_t checksum(std::span<const std::uint8_t> snapshot) {
  const std::uint32_t of_header = packets::crc32_ieee(snapshot.first(offsetof(SnapshotHeader, crc)));
  return of_header ^ packets::crc32_ieee(snapshot.subspan(sizeof(SnapshotHeader)));
}

/// Copies the state as bytes. All its types would be copied so, but Eigen's matrices declare a copy and are therefore
/// not trivially copyable by the language.
void copy_bytes(void* to, const void* from, std::size_t count) {
  std::memcpy(to, from, count);
}

}  // namespace

const std::size_t Gnc::kSnapshotBytes = kBytes;

Status Gnc::save(std::span<std::uint8_t> snapshot) const {
  if (snapshot.size() < kBytes) return Status::kTooShort;
  if (!stepped_) return Status::kNotReady;
  const std::span<std::uint8_t> bytes = snapshot.first(kBytes);
  SnapshotHeader header;
  header.bytes = kBytes;
  header.step = step_;
  header.time_ns = now_.ns;
  header.spacecraft = outbox_.spacecraft();
  const messaging::Inbox::Retained inbox = inbox_.retained();
  const messaging::Outbox::Retained outbox = outbox_.retained();
  copy_bytes(&bytes[0], &header, sizeof header);
  copy_bytes(&bytes[kInboxAt], &inbox, sizeof inbox);
  copy_bytes(&bytes[kOutboxAt], &outbox, sizeof outbox);
  copy_bytes(&bytes[kStateAt], static_cast<const GncState*>(this), sizeof(GncState));
  const auto code = code_of(bytes, inbox_.authentication());
  copy_bytes(&bytes[kCodeAt], code.data(), code.size());
  header.crc = checksum(bytes);
  copy_bytes(&bytes[0], &header, sizeof header);
  return Status::kOk;
}

Status Gnc::restore(std::span<const std::uint8_t> snapshot) {
  is_restored_ = true;
  restored_ = [&] {
    if (snapshot.size() < kBytes) return Status::kTooShort;
    SnapshotHeader header;
    copy_bytes(&header, &snapshot[0], sizeof header);
    const bool is_ours = header.magic == kMagic && header.version == kVersion && header.bytes == kBytes &&
                         header.spacecraft == outbox_.spacecraft();
    if (!is_ours) return Status::kWrongType;
    if (header.crc != checksum(snapshot.first(kBytes))) return Status::kBadChecksum;
    const bool is_known = !inbox_.authentication().is_required() ||
                          packets::are_same(code_of(snapshot, inbox_.authentication()),
                                            snapshot.subspan(kCodeAt, packets::kSecurityCodeBytes));
    return is_known ? Status::kOk : Status::kBadChecksum;
  }();
  if (restored_ != Status::kOk) return restored_;
  messaging::Inbox::Retained inbox;
  messaging::Outbox::Retained outbox;
  copy_bytes(&inbox, &snapshot[kInboxAt], sizeof inbox);
  copy_bytes(&outbox, &snapshot[kOutboxAt], sizeof outbox);
  copy_bytes(static_cast<GncState*>(this), &snapshot[kStateAt], sizeof(GncState));
  inbox_.restore(inbox);
  outbox_.restore(outbox);
  inbox_.clear(now_ + inbox_.step_period());
  return Status::kOk;
}

/// Returns whether a step at `now` is accepted. The first one after a restart of the computer is accepted at any usable
/// time: the age of the state decides what is kept.
bool Gnc::accepts(GpsTime now) {
  if (!messaging::is_usable(now)) return false;
  if (!stepped_ || is_restored_) return true;
  switch (clock_.judge(now_, now, inbox_.step_period())) {
    case fdir::StepClock::Verdict::kContinue:
      return true;
    case fdir::StepClock::Verdict::kRestart:
      restart(now);
      return true;
    case fdir::StepClock::Verdict::kRefuse:
      break;
  }
  return false;
}

/// Reports a rejected step. The health packet has the time of the last step and the number of the next one.
void Gnc::refuse(GpsTime now) {
  const double jump_s = (static_cast<double>(now.ns) - static_cast<double>(now_.ns)) / 1e9;
  faults_.check(now_, {.fault = telemetry_health::kFaultClock, .is_detected = true, .argument = jump_s});
  const auto& commands = inbox_.queue<fault_command>();
  for (std::size_t k = 0; k < commands.size(); ++k) {
    if ((commands[k].value.clear & telemetry_health::kFaultClock) != 0) clock_.accept_next();
  }
  report_health(outbox_);
  report_events(outbox_);
  faults_.forget_transitions();
  inbox_.clear(now_);
}

/// Continues after a restore: discards a state that is too old, and raises the faults that report the restart.
void Gnc::resume(GpsTime now) {
  if (!is_restored_) return;
  is_restored_ = false;
  if (restored_ != Status::kOk) {
    faults_.check(
        now,
        {.fault = telemetry_health::kFaultColdStart, .is_detected = true, .argument = static_cast<double>(restored_)});
    return;
  }
  const Duration age = now - now_;
  if (age.ns > 0 && age <= kOldestWarm) {
    faults_.check(now, {.fault = telemetry_health::kFaultRestart, .is_detected = true, .argument = seconds(age)});
    return;
  }
  restart(now);
  faults_.check(now, {.fault = telemetry_health::kFaultColdStart,
                      .is_detected = true,
                      .argument = static_cast<double>(Status::kOutOfRange)});
}

/// Re-initialises everything but the telecommands, the faults and the number of the step.
void Gnc::restart(GpsTime now) {
  telecommands_.renew(now);
  // Constructed in place: a second state would exceed the stack on board.
  const auto renew = []<class Member>(Member& member) {
    member.~Member();
    new (&member) Member();
  };
  renew(management_);
  renew(measurements_);
  renew(navigation_);
  renew(guidance_);
  renew(retreat_);
  renew(assessment_);
  renew(burns_);
  renew(safety_monitor_);
  renew(images_);
  attitude_.reset();
  unsafe_since_.reset();
  assessed_since_.reset();
  cautious_since_.reset();
  has_settled_ = false;
  is_cautious_ = false;
  has_navigated_ = false;
  promised_period_ = Duration{};
  stepped_ = false;
}

}  // namespace vbar::fsw::gnc
