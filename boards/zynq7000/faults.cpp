#include "boards/zynq7000/faults.h"

#include "boards/zynq7000/console.h"
#include "boards/zynq7000/cpu.h"

extern "C" [[noreturn]] void vbar_fault(std::uint32_t kind, std::uint32_t return_address, std::uint32_t status,
                                        const std::uint32_t* stack_and_link);

namespace vbar::boards::zynq7000 {
namespace {

bool halting = false;

[[noreturn]] void sleep_forever() {
  detail::mask_interrupts();
  for (;;) {
    wait_for_interrupt();
  }
}

const char* name_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::kUndefined:
      return "undefined instruction";
    case FaultKind::kPrefetchAbort:
      return "prefetch abort";
    case FaultKind::kDataAbort:
      return "data abort";
    case FaultKind::kFastInterrupt:
      return "fast interrupt";
  }
  return "unknown";
}

// The return address of an exception lies past the instruction that caused it, by kind (DDI 0406, table B1-7; ARM
// state).
std::uint32_t offset_of(FaultKind kind) {
  return kind == FaultKind::kDataAbort ? 8U : 4U;
}

void print_register(const char* name, std::uint32_t value) {
  print(name);
  print_hex(value);
}

}  // namespace

void halt(const char* reason, ExitCode code) {
  detail::mask_interrupts();
  if (!halting) {  // a fault while halting must not recur endlessly
    halting = true;
    print("\nHALT ");
    print(reason);
    print("\n");
    semihosting_exit(static_cast<std::uint32_t>(code));
  }
  sleep_forever();
}

}  // namespace vbar::boards::zynq7000

void vbar_fault(std::uint32_t kind, std::uint32_t return_address, std::uint32_t status,
                const std::uint32_t* stack_and_link) {
  using namespace vbar::boards::zynq7000;
  if (halting) {
    sleep_forever();
  }
  halting = true;
  const auto fault = static_cast<FaultKind>(kind);
  std::uint32_t data_status = 0;
  std::uint32_t data_address = 0;
  std::uint32_t fetch_status = 0;
  std::uint32_t fetch_address = 0;
  asm volatile("mrc p15, 0, %0, c5, c0, 0" : "=r"(data_status));
  asm volatile("mrc p15, 0, %0, c6, c0, 0" : "=r"(data_address));
  asm volatile("mrc p15, 0, %0, c5, c0, 1" : "=r"(fetch_status));
  asm volatile("mrc p15, 0, %0, c6, c0, 2" : "=r"(fetch_address));
  print("\nFAULT ");
  print(name_of(fault));
  print_register(" pc=", return_address - offset_of(fault));
  print_register(" lr=", stack_and_link[1]);
  print_register(" sp=", stack_and_link[0]);
  print_register(" cpsr=", status);
  if (fault == FaultKind::kDataAbort) {
    print_register(" dfsr=", data_status);
    print_register(" dfar=", data_address);
  } else if (fault == FaultKind::kPrefetchAbort) {
    print_register(" ifsr=", fetch_status);
    print_register(" ifar=", fetch_address);
  }
  print("\n");
  semihosting_exit(static_cast<std::uint32_t>(ExitCode::kFault) + kind);
  sleep_forever();
}
