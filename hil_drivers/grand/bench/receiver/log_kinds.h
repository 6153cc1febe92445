#pragma once
// Logs that the receiver can give.

#include <array>
#include <string_view>

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

}  // namespace vbar::grand::bench
