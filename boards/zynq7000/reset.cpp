#include <tuple>

#include "boards/zynq7000/cpu.h"
#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/watchdog.h"

namespace vbar::boards::zynq7000 {
namespace {

// Registers of the SLCR (UG585, appendix B).
constexpr std::uintptr_t kUnlock = kSlcr + 0x008U;
constexpr std::uintptr_t kSystemReset = kSlcr + 0x200U;   // PSS_RST_CTRL
constexpr std::uintptr_t kRebootStatus = kSlcr + 0x258U;  // REBOOT_STATUS: causes of the resets since power-on
constexpr std::uint32_t kUnlockKey = 0xDF0DU;
constexpr std::uint32_t kFirstCoreWatchdog = 1U << 17;

struct Retained {
  std::uint32_t words[std::tuple_size_v<RecordWords>];  // an array of the language: the object is volatile
  std::uint32_t checksum;
};
// Memory that is neither cleared at start-up nor cached: a value written is in memory at the time of the reset.
[[gnu::section(".retained")]] volatile Retained retained;

bool read_retained(FlightRecord& record) {
  RecordWords words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = retained.words[i];
  }
  record = std::bit_cast<FlightRecord>(words);
  return retained.checksum == checksum_of(record);
}

}  // namespace

Restart find_restart() {
  Restart restart;
  const std::uint32_t causes = reg(kRebootStatus);
  reg(kUnlock) = kUnlockKey;
  reg(kRebootStatus) = causes & ~kFirstCoreWatchdog;
  const bool is_intact = read_retained(restart.record);
  const bool was_requested = is_intact && restart.record.expired == 1U;
  restart.by_watchdog = was_requested || (causes & kFirstCoreWatchdog) != 0U;
  restart.has_record = restart.by_watchdog && is_intact;
  retain({});  // the next reset may have another cause
  return restart;
}

void retain(const FlightRecord& record) {
  const RecordWords words = words_of(record);
  for (std::size_t i = 0; i < words.size(); ++i) {
    retained.words[i] = words[i];
  }
  retained.checksum = checksum_of(record);
  synchronize();
}

void reset_by_watchdog() {
  detail::mask_interrupts();
  FlightRecord record;
  static_cast<void>(read_retained(record));
  record.expired = 1;
  retain(record);
  reg(kUnlock) = kUnlockKey;
  reg(kSystemReset) = 1;
  for (;;) {
    wait_for_interrupt();
  }
}

}  // namespace vbar::boards::zynq7000
