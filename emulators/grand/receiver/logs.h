#pragma once
// Logs that the receiver can give.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "emulators/grand/receiver/commands.h"
#include "emulators/grand/receiver/measurements.h"
#include "emulators/grand/receiver/serial_line.h"
#include "host_sim/twins/gnss/oem_encoder.h"

namespace vbar::grand::bench {

/// Event that produces a log: an epoch of the clock, the completion of a satellite's message, a request, or a change of
/// the receiver status.
enum class LogClass : std::uint8_t { kEpoch, kMessage, kPolled, kEvent };

struct LogKind {
  std::string_view name;
  twins::gnss::oem::MessageId id;
  LogClass log_class;
  bool ascii;  ///< also given as ASCII
};

inline constexpr std::array<LogKind, 11> kLogKinds{{
    {"GPSEPHEM", twins::gnss::oem::MessageId::kGpsEphem, LogClass::kMessage, false},
    {"IONUTC", twins::gnss::oem::MessageId::kIonUtc, LogClass::kMessage, false},
    {"VERSION", twins::gnss::oem::MessageId::kVersion, LogClass::kPolled, true},
    {"RAWEPHEM", twins::gnss::oem::MessageId::kRawEphem, LogClass::kMessage, false},
    {"BESTPOS", twins::gnss::oem::MessageId::kBestPos, LogClass::kEpoch, false},
    {"RANGE", twins::gnss::oem::MessageId::kRange, LogClass::kEpoch, false},
    {"RXSTATUSEVENT", twins::gnss::oem::MessageId::kRxStatusEvent, LogClass::kEvent, true},
    {"TIME", twins::gnss::oem::MessageId::kTime, LogClass::kEpoch, false},
    {"BESTXYZ", twins::gnss::oem::MessageId::kBestXyz, LogClass::kEpoch, false},
    {"GALEPHEMERIS", twins::gnss::oem::MessageId::kGalEphemeris, LogClass::kMessage, false},
    {"BDSEPHEMERIS", twins::gnss::oem::MessageId::kBdsEphemeris, LogClass::kMessage, false},
}};

constexpr const LogKind* find_log_kind(std::uint16_t id) {
  for (const LogKind& kind : kLogKinds)
    if (static_cast<std::uint16_t>(kind.id) == id) return &kind;
  return nullptr;
}

// Logs that have been requested: at most 30 over all ports.

struct LogRequest {
  int port = 0;  ///< port to which the log goes
  const LogKind* kind = nullptr;
  LogFormat format = LogFormat::kBinary;
  Trigger trigger = Trigger::kOnce;
  std::int64_t period = 0;  ///< in multiples of 10 ms
  std::int64_t offset = 0;
  bool hold = false;

  /// Returns true if an ONTIME log is due at the epoch of this number (10 ms each).
  [[nodiscard]] bool due_at(std::int64_t epoch) const {
    return trigger == Trigger::kOnTime && (epoch - offset) % period == 0;
  }
};

class LogList {
 public:
  static constexpr std::size_t kMaxLogs = 30;

  /// Adds a request; it replaces the request for the same log on the same port. `port` is the number of the port,
  /// resolved.
  Response add(const Command& command, int port);
  /// Removes the log, held or not.
  void remove(int port, std::uint16_t id, LogFormat format);
  /// Removes all logs of the port (-1: of all ports); held ones only with `held`.
  void remove_all(int port, bool held);
  void remove(const LogRequest& request) {
    remove(request.port, static_cast<std::uint16_t>(request.kind->id), request.format);
  }

  [[nodiscard]] bool any_due_at(std::int64_t epoch) const;
  [[nodiscard]] const std::vector<LogRequest>& requests() const { return requests_; }

 private:
  std::vector<LogRequest> requests_;
};

// Content of each log at an instant.

class LogWriter {
 public:
  /// Faults: `week_shift` is added to every week that the receiver reports, `tag_shift` to the time of every header.
  /// All references must outlive the writer.
  LogWriter(const Measurements& engine, const twins::gnss::Constellation& constellation, fsw::Duration week_shift,
            fsw::Duration tag_shift)
      : engine_(engine), constellation_(constellation), week_shift_(week_shift), tag_shift_(tag_shift) {}

  /// Returns the header of a message at this reading.
  [[nodiscard]] twins::gnss::oem::Header header(int port, fsw::GpsTime reading, bool position_valid,
                                                std::uint32_t more_status_bits) const;

  /// Appends the log of an epoch.
  void append_epoch(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header,
                    const EpochData& epoch) const;
  /// Appends every message of the kind that has been received; with `satellite` that of this one only. Nothing for a
  /// satellite of another system.
  void append_messages(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header,
                       std::optional<std::size_t> satellite) const;
  void append_version(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header) const;
  void append_event(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header, unsigned bit,
                    bool set) const;

 private:
  void append_ephemeris(Bytes& bytes, const LogRequest& request, const twins::gnss::oem::Header& header,
                        std::size_t satellite) const;

  const Measurements& engine_;
  const twins::gnss::Constellation& constellation_;
  fsw::Duration week_shift_;
  fsw::Duration tag_shift_;
};

}  // namespace vbar::grand::bench
