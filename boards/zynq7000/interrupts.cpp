#include "boards/zynq7000/interrupts.h"

#include <array>

#include "boards/zynq7000/cpu.h"
#include "boards/zynq7000/memory_map.h"

extern "C" void vbar_interrupt();

namespace vbar::boards::zynq7000 {
namespace {

constexpr unsigned kInterrupts = 96;
constexpr unsigned kFirstPrivate = 16;
constexpr unsigned kFirstShared = 32;
// Smaller is more urgent; taken if smaller than the mask (detail::kUrgentInterrupts).
constexpr std::uint32_t kUrgent = 0x20U;
constexpr std::uintptr_t kDistributorControl = kInterruptDistributor + 0x000U;
constexpr std::uintptr_t kDistributorGroup = kInterruptDistributor + 0x080U;
constexpr std::uintptr_t kDistributorEnable = kInterruptDistributor + 0x100U;
constexpr std::uintptr_t kDistributorDisable = kInterruptDistributor + 0x180U;
constexpr std::uintptr_t kDistributorClearPending = kInterruptDistributor + 0x280U;
constexpr std::uintptr_t kDistributorPriority = kInterruptDistributor + 0x400U;
constexpr std::uintptr_t kDistributorTarget = kInterruptDistributor + 0x800U;
constexpr std::uintptr_t kCpuControl = kInterruptCpuInterface + 0x00U;
constexpr std::uintptr_t kCpuPriorityMask = kInterruptCpuInterface + 0x04U;
constexpr std::uintptr_t kCpuBinaryPoint = kInterruptCpuInterface + 0x08U;
constexpr std::uintptr_t kCpuAcknowledge = kInterruptCpuInterface + 0x0CU;
constexpr std::uintptr_t kCpuEnd = kInterruptCpuInterface + 0x10U;

struct Entry {
  InterruptHandler handler = nullptr;
  void* context = nullptr;
};
std::array<Entry, kInterrupts> entries;

void enable(unsigned id, InterruptHandler handler, void* context) {
  entries[id] = {handler, context};
  reg(kDistributorEnable + 4U * (id / 32U)) = 1U << (id % 32U);
}

}  // namespace

void interrupts_initialize() {
  reg(kDistributorControl) = 0;
  reg(kCpuControl) = 0;
  for (unsigned word = 0; word < kInterrupts / 32U; ++word) {
    reg(kDistributorDisable + 4U * word) = 0xFFFFFFFFU;
    reg(kDistributorClearPending + 4U * word) = 0xFFFFFFFFU;
    reg(kDistributorGroup + 4U * word) = 0;  // secure: arrives as IRQ, whatever the boot loader has set
  }
  for (unsigned word = kFirstShared / 4U; word < kInterrupts / 4U; ++word) {
    reg(kDistributorPriority + 4U * word) = 0xA0A0A0A0U;  // equal: no handler interrupts another
    reg(kDistributorTarget + 4U * word) = 0x01010101U;    // first core
  }
  reg(kCpuPriorityMask) = detail::kAllInterrupts;
  reg(kCpuBinaryPoint) = 0;
  reg(kCpuControl) = 1;
  reg(kDistributorControl) = 1;
}

void interrupts_attach(unsigned id, InterruptHandler handler, void* context) {
  if (id < kFirstShared || id >= kInterrupts) {
    return;
  }
  enable(id, handler, context);
}

void interrupts_attach_urgent(unsigned id, InterruptHandler handler, void* context) {
  if (id < kFirstPrivate || id >= kFirstShared) {
    return;
  }
  const std::uintptr_t priorities = kDistributorPriority + 4U * (id / 4U);
  const unsigned shift = 8U * (id % 4U);
  reg(priorities) = (reg(priorities) & ~(0xFFU << shift)) | (kUrgent << shift);
  enable(id, handler, context);
}

void interrupts_end(unsigned id) {
  reg(kCpuEnd) = id;
}

std::uint32_t detail::exchange_priority_mask(std::uint32_t mask) {
  const std::uint32_t before = reg(kCpuPriorityMask);
  reg(kCpuPriorityMask) = mask;
  synchronize();
  return before;
}

}  // namespace vbar::boards::zynq7000

void vbar_interrupt() {
  using namespace vbar::boards::zynq7000;
  constexpr std::uint32_t kIdMask = 0x3FFU;
  const std::uint32_t acknowledge = reg(kCpuAcknowledge);
  const std::uint32_t id = acknowledge & kIdMask;
  if (id >= kInterrupts) {
    return;  // spurious: withdrawn before it was taken; needs no end
  }
  if (entries[id].handler != nullptr) {
    entries[id].handler(entries[id].context);
  }
  reg(kCpuEnd) = acknowledge;
}
