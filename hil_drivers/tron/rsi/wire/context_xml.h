#pragma once
// What driver and emulator need of the values of an RSI context (hil_drivers/tron/robot/*.rsi.xml).

#include <filesystem>
#include <optional>

#include "hil_drivers/tron/rsi/wire/messages.h"

namespace vbar::tron::rsi {

struct CorrectionRange {
  double lower = -5.0, upper = 5.0;  ///< deg (mm of the track): a correction beyond is clamped silently. KUKA's default
};

struct ContextXml {
  int timeout_cycles = 10;  ///< consecutive cycles without a valid answer that end RSI. KUKA's default
  int precision = 1;        ///< decimals that the controller sends. KUKA's default
  std::array<CorrectionRange, kWireAxes> axes{};
  std::optional<CorrectionRange> track;
  SixValues monitor_deg{6.0, 6.0, 6.0, 6.0, 6.0, 6.0};  ///< a correction beyond ends RSI (KSS29000). KUKA's default
  double track_monitor_mm = 6.0;
};

/// Throws std::runtime_error: one sentence with file and line.
[[nodiscard]] ContextXml read_context_xml(const std::filesystem::path& file);

}  // namespace vbar::tron::rsi
