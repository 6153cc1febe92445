#include "emulators/grand/receiver/logs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "emulators/grand/receiver/console.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {

namespace {

constexpr double kEpochsPerSecond = 100.0;
constexpr std::int64_t kMinPeriod = 5;  ///< 20 Hz

// Fields of the command LOG.
constexpr std::size_t kMessage = 1, kTrigger = 2, kPeriod = 3, kOffset = 4, kHold = 5;

bool accepts(const LogKind& kind, Trigger trigger) {
  switch (trigger) {
    case Trigger::kOnTime:
      return kind.log_class != LogClass::kEvent;
    case Trigger::kOnce:
    case Trigger::kOnNext:
      return true;
    case Trigger::kOnNew:
    case Trigger::kOnChanged:
      return kind.log_class == LogClass::kMessage || kind.log_class == LogClass::kEvent;
    case Trigger::kOnMark:
      return false;  // no mark input is emulated
  }
  return false;
}

Trigger default_trigger(const LogKind& kind) {
  const bool by_itself = kind.log_class == LogClass::kMessage || kind.log_class == LogClass::kEvent;
  return by_itself ? Trigger::kOnNew : Trigger::kOnce;
}

}  // namespace

Response LogList::add(const Command& command, int port) {
  LogRequest request;
  request.port = port;
  request.kind = find_log_kind(command.message_id(kMessage));
  if (request.kind == nullptr) return no_such_log();
  request.format = command.format(kMessage);
  if (request.format != LogFormat::kBinary && !request.kind->ascii) return no_such_log();
  request.trigger = command.whole(kTrigger) == kDefaultTrigger ? default_trigger(*request.kind)
                                                               : static_cast<Trigger>(command.whole(kTrigger));
  if (!accepts(*request.kind, request.trigger)) return invalid_trigger(kTrigger);
  if (request.trigger == Trigger::kOnTime) {
    const double period = command.values[kPeriod] * kEpochsPerSecond;
    const double offset = command.values[kOffset] * kEpochsPerSecond;
    request.period = std::llround(period);
    request.offset = std::llround(offset);
    // 20, 10, 5, 4, 2 Hz, or whole seconds.
    const bool whole_seconds = request.period % 100 == 0;
    if (std::abs(period - static_cast<double>(request.period)) > 1e-6 || request.period < kMinPeriod ||
        (!whole_seconds && 100 % request.period != 0) || request.period % kMinPeriod != 0)
      return invalid_rate();
    if (std::abs(offset - static_cast<double>(request.offset)) > 1e-6 || request.offset >= request.period ||
        request.offset % kMinPeriod != 0)
      return invalid_offset();
  }
  request.hold = command.whole(kHold) != 0;
  const auto same = std::ranges::find_if(requests_, [&request](const LogRequest& other) {
    return other.port == request.port && other.kind == request.kind && other.format == request.format;
  });
  if (same != requests_.end()) {
    *same = request;
    return {};
  }
  if (requests_.size() >= kMaxLogs) return not_enough_resources();
  requests_.push_back(request);
  return {};
}

void LogList::remove(int port, std::uint16_t id, LogFormat format) {
  std::erase_if(requests_, [&](const LogRequest& request) {
    return request.port == port && static_cast<std::uint16_t>(request.kind->id) == id && request.format == format;
  });
}

void LogList::remove_all(int port, bool held) {
  std::erase_if(requests_, [&](const LogRequest& request) {
    return (port < 0 || request.port == port) && (held || !request.hold);
  });
}

bool LogList::any_due_at(std::int64_t epoch) const {
  return std::ranges::any_of(requests_, [epoch](const LogRequest& request) { return request.due_at(epoch); });
}

namespace {

using twins::gnss::System;
namespace oem = twins::gnss::oem;
using oem::MessageId;

constexpr oem::VersionRecord kVersion{.model = "VBAR-EMULATED",
                                      .serial = "EMULATED00001",
                                      .hardware = "OEM628-EMU",
                                      .software = "EMU060600RN0000",
                                      .boot = "EMU060200RB0000",
                                      .date = "2015/Jan/28",
                                      .time = "15:27:29"};

oem::PositionRecord position_record(const EpochData& epoch) {
  oem::PositionRecord record;
  record.satellites_tracked = epoch.satellites_tracked;
  if (!epoch.solution) return record;
  record.solved = true;
  record.position_ecef = epoch.solution->position_ecef;
  record.velocity_ecef = epoch.solution->velocity_ecef;
  record.position_sigma_m = epoch.solution->position_sigma_m;
  record.velocity_sigma_mps = epoch.solution->velocity_sigma_mps;
  record.satellites_used = epoch.solution->satellites;
  return record;
}

oem::ClockRecord clock_record(const EpochData& epoch) {
  if (!epoch.solution) return {};
  return {true, epoch.solution->clock_offset_s, epoch.solution->clock_sigma_s};
}

std::string_view text_of_bit(unsigned bit, bool set) {
  switch (bit) {
    case oem::kPositionInvalidBit:
      return set ? "No Valid Position Calculated" : "Valid Position Calculated";
    case oem::kTransmitOverrunBit:
      return set ? "COM1 Transmit Buffer Overrun" : "COM1 Transmit Buffer OK";
    case oem::kTransmitOverrunBit + 1:
      return set ? "COM2 Transmit Buffer Overrun" : "COM2 Transmit Buffer OK";
    default:
      return "Status";
  }
}

void append_text(Bytes& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

/// The abbreviated form of a log leaves out '#' and CRC.
std::string in_format(const LogRequest& request, const oem::Header& header, const std::string& fields) {
  std::string text = ascii_message(fmt::format("{}A", request.kind->name), request.port, header, fields);
  if (request.format == LogFormat::kAscii) return text;
  text = "<" + text.substr(1, text.rfind('*') - 1);
  return text + "\r\n";
}

}  // namespace

oem::Header LogWriter::header(int port, fsw::GpsTime reading, bool position_valid,
                              std::uint32_t more_status_bits) const {
  oem::Header header;
  header.time = reading + week_shift_ + tag_shift_;
  header.status = engine_.time_status();
  header.position_valid = position_valid;
  header.port = static_cast<std::uint8_t>(static_cast<std::uint32_t>(PortId::kCom1) * static_cast<unsigned>(port + 1));
  header.more_status_bits = more_status_bits;
  return header;
}

void LogWriter::append_epoch(Bytes& bytes, const LogRequest& request, const oem::Header& header,
                             const EpochData& epoch) const {
  switch (request.kind->id) {
    case MessageId::kRange:
      oem::append_range(bytes, header, epoch.ranges);
      return;
    case MessageId::kBestXyz:
      oem::append_bestxyz(bytes, header, position_record(epoch));
      return;
    case MessageId::kBestPos:
      oem::append_bestpos(bytes, header, position_record(epoch));
      return;
    case MessageId::kTime:
      oem::append_time(bytes, header, clock_record(epoch), twins::gnss::utc_offset_at(header.time));
      return;
    default:
      return;
  }
}

void LogWriter::append_ephemeris(Bytes& bytes, const LogRequest& request, const oem::Header& header,
                                 std::size_t satellite) const {
  const MessageReception& reception = engine_.reception(satellite);
  if (!reception.set()) return;
  twins::gnss::BroadcastSet set = *reception.set();
  set.ephemeris.toe = set.ephemeris.toe + week_shift_;
  const fsw::GpsTime transmitted = reception.set_transmitted() + week_shift_;
  const System system = set.ephemeris.satellite.system;
  switch (request.kind->id) {
    case MessageId::kRawEphem:
      if (system == System::kGps) oem::append_rawephem(bytes, header, set, transmitted);
      return;
    case MessageId::kGpsEphem:
      if (system == System::kGps) oem::append_gpsephem(bytes, header, set, transmitted);
      return;
    case MessageId::kGalEphemeris:
      if (system == System::kGalileo) oem::append_galephemeris(bytes, header, set);
      return;
    case MessageId::kBdsEphemeris:
      if (system == System::kBeidou) oem::append_bdsephemeris(bytes, header, set);
      return;
    default:
      return;
  }
}

void LogWriter::append_messages(Bytes& bytes, const LogRequest& request, const oem::Header& header,
                                std::optional<std::size_t> satellite) const {
  if (request.kind->id == MessageId::kIonUtc) {
    if (engine_.corrections_known() && !satellite)
      oem::append_ionutc(bytes, header, constellation_.corrections(), twins::gnss::utc_offset_at(header.time));
    return;
  }
  if (satellite) {
    append_ephemeris(bytes, request, header, *satellite);
    return;
  }
  for (std::size_t k = 0; k < engine_.satellites(); ++k) append_ephemeris(bytes, request, header, k);
}

void LogWriter::append_version(Bytes& bytes, const LogRequest& request, const oem::Header& header) const {
  if (request.format == LogFormat::kBinary) {
    oem::append_version(bytes, header, kVersion);
    return;
  }
  append_text(bytes, in_format(request, header,
                               fmt::format("1,GPSCARD,\"{}\",\"{}\",\"{}\",\"{}\",\"{}\",\"{}\",\"{}\"", kVersion.model,
                                           kVersion.serial, kVersion.hardware, kVersion.software, kVersion.boot,
                                           kVersion.date, kVersion.time)));
}

void LogWriter::append_event(Bytes& bytes, const LogRequest& request, const oem::Header& header, unsigned bit,
                             bool set) const {
  const std::string_view text = text_of_bit(bit, set);
  if (request.format == LogFormat::kBinary) {
    oem::append_status_event(bytes, header, {bit, set, text});
    return;
  }
  append_text(bytes, in_format(request, header, fmt::format("STATUS,{},{},\"{}\"", bit, set ? "SET" : "CLEAR", text)));
}

}  // namespace vbar::grand::bench
