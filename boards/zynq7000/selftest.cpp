// Properties of the processor on which flight software relies, tested on the processor itself. The semihosting command
// line (second word) names the case: without one, all checks run; with one, the fault of that name is provoked, and the
// exit code states whether it was caught.

#include <array>
#include <cstring>

#include "boards/zynq7000/clocks.h"
#include "boards/zynq7000/console.h"
#include "boards/zynq7000/cpu.h"
#include "boards/zynq7000/ethernet.h"
#include "boards/zynq7000/faults.h"
#include "boards/zynq7000/interrupts.h"
#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/stack_meter.h"
#include "boards/zynq7000/timer.h"
#include "fsw/packets/security_trailer.h"

namespace vbar::boards::zynq7000 {
namespace {

int failures = 0;

void check(bool holds, const char* what) {
  print(holds ? "ok    " : "FAILED ");
  print(what);
  print("\n");
  failures += holds ? 0 : 1;
}

std::uint32_t floating_point_status() {
  std::uint32_t fpscr = 0;
  asm volatile("vmrs %0, fpscr" : "=r"(fpscr));
  return fpscr;
}

// The expected bits are those of IEEE 754: each result is exact or correctly rounded, and therefore unique.
void check_floating_point() {
  constexpr std::uint32_t kModes = 0x07FF9F00U;  // all but the condition and exception flags
  check((floating_point_status() & kModes) == 0, "FPSCR: round to nearest, subnormals kept, no traps");
  volatile double smallest_normal = 0x1p-1022;
  check(smallest_normal / 2.0 == 0x1p-1023, "subnormal doubles are kept");
  volatile double one = 1.0;
  volatile double half_ulp = 0x1p-53;
  check(one + half_ulp == 1.0, "ties round to even");
  volatile double a = 1.0 + 0x1p-30;
  check(a * a - (1.0 + 0x1p-29) == 0.0, "products are rounded before they are added: no contraction");
  volatile double two = 2.0;
  check(__builtin_sqrt(two) == 0x1.6a09e667f3bcdp+0, "square root is correctly rounded");
}

void check_memory() {
  alignas(8) static std::array<volatile std::uint8_t, 16> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i);
  }
  std::uint32_t word = 0;
  asm volatile("ldr %0, [%1]" : "=r"(word) : "r"(&bytes[1]) : "memory");
  check(word == 0x04030201U, "unaligned words load");
  check(stack_high_water() > 0 && stack_high_water() < 16U * 1024U, "the stack meter reads a plausible depth");
}

void check_timers() {
  const std::uint64_t start = global_timer();
  std::uint64_t now = start;
  bool rises = true;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t next = global_timer();
    rises = rises && next >= now;
    now = next;
  }
  check(rises && now > start, "the global timer rises");
  const std::uint64_t cost = cost_counter();
  for (int i = 0; i < 100; ++i) {
    asm volatile("");
  }
  check(cost_counter() > cost, "the cost counter rises");
}

// A software-set shared interrupt runs its handler, and the interrupted code finds its registers as it left them.
void check_interrupts() {
  constexpr unsigned kUnusedInterrupt = 61;  // PL interrupt 0: not connected here
  constexpr std::uintptr_t kSetPending = kInterruptDistributor + 0x200U;
  static volatile int served = 0;
  interrupts_attach(
      kUnusedInterrupt,
      [](void*) {
        served = served + 1;
        asm volatile("vmov.i32 q0, #0\n\tvmov.i32 q1, #0\n\tvmov.i32 q8, #0\n\tvmov.i32 q15, #0" ::
                         : "q0", "q1", "q8", "q15");
      },
      nullptr);
  detail::unmask_interrupts();
  double d0 = 1.25;
  double d16 = 2.5;
  double d31 = 5.0;
  asm volatile(
      "vmov.f64 d0, %P0\n\tvmov.f64 d16, %P1\n\tvmov.f64 d31, %P2\n\t"
      "str %4, [%3]\n\tdsb\n\tisb\n\tnop\n\tnop\n\tnop\n\tnop\n\t"
      "vmov.f64 %P0, d0\n\tvmov.f64 %P1, d16\n\tvmov.f64 %P2, d31"
      : "+w"(d0), "+w"(d16), "+w"(d31)
      : "r"(kSetPending + 4U), "r"(1U << (kUnusedInterrupt - 32U))
      : "d0", "d16", "d31", "memory");
  detail::mask_interrupts();
  check(served == 1, "an interrupt reaches its handler, once");
  check(d0 == 1.25 && d16 == 2.5 && d31 == 5.0, "floating-point registers survive an interrupt");
}

// While flight software runs, peripherals wait and the core's own timers do not. The timer also ends a wait.
void check_deferral() {
  constexpr unsigned kUnusedInterrupt = 62;  // PL interrupt 1: not connected here
  constexpr std::uintptr_t kSetPending = kInterruptDistributor + 0x200U;
  constexpr std::uint32_t kTicks = 10'000;
  constexpr std::uint32_t kEnableWithInterrupt = 0x5U;
  constexpr std::uintptr_t kLoad = kPrivateTimer + 0x0U;
  constexpr std::uintptr_t kControl = kPrivateTimer + 0x8U;
  constexpr std::uintptr_t kStatus = kPrivateTimer + 0xCU;
  static volatile bool peripheral_served = false;
  static volatile bool timer_served = false;
  interrupts_attach(
      kUnusedInterrupt, [](void*) { peripheral_served = true; }, nullptr);
  interrupts_attach_urgent(
      kInterruptPrivateTimer,
      [](void*) {
        reg(kStatus) = 1;
        timer_served = true;
      },
      nullptr);
  detail::unmask_interrupts();
  {
    const PeripheralsDeferred deferred;
    reg(kSetPending + 4U) = 1U << (kUnusedInterrupt - 32U);
    reg(kLoad) = kTicks;
    reg(kControl) = kEnableWithInterrupt;
    const std::uint64_t start = global_timer();
    while (!timer_served && global_timer() - start < 10U * kTicks) {
    }
    check(timer_served, "an urgent interrupt is taken while peripherals are deferred");
    check(!peripheral_served, "that of a peripheral is not");
    {
      const PeripheralsServed served;
      check(peripheral_served, "it is taken when peripherals are served again");
    }
  }
  timer_served = false;
  reg(kLoad) = kTicks;
  reg(kControl) = kEnableWithInterrupt;
  wait_for_interrupt();
  check(timer_served, "the timer ends a wait");
  reg(kControl) = 0;
  detail::mask_interrupts();
}

void check_ethernet() {
  static Ethernet ethernet;
  ethernet.open({0x02, 0, 0, 0, 0, 1});
  check(!ethernet.waits_for_link(), "the PHY answers and has a link");
}

// The largest telecommand with a trailer; the cost of its verification is printed, for the host to judge.
void check_authentication() {
  namespace packets = fsw::packets;
  static std::array<std::uint8_t, packets::kMaxSecuredPayloadBytes> payload{};
  static std::array<std::uint8_t, packets::kMaxPacketBytes> plain{};
  static std::array<std::uint8_t, packets::kMaxPacketBytes> secured{};
  packets::TelecommandSecurity security{.index = packets::kHostKeyIndex, .sequence = 1};
  for (std::size_t k = 0; k < security.key.size(); ++k) {
    security.key[k] = static_cast<std::uint8_t>(k);
  }
  packets::PacketHeader header;
  header.apid = packets::Apid::kTargetModel;
  const auto plain_size = packets::write_packet(header, payload, plain);
  const auto size = packets::write_secured(std::span(plain).first(plain_size.value()),
                                           packets::HmacSha256(security.key), security.index, 2, secured);
  check(size.ok() && size.value() == secured.size(), "a telecommand of the largest size has room for its trailer");
  packets::TelecommandAuthentication authentication;
  authentication.require(security);
  const auto parsed = packets::parse_packet(secured);
  const std::uint64_t start = cost_counter();
  const auto verified = authentication.verify(secured, parsed.value());
  const std::uint64_t cost = cost_counter() - start;
  check(verified.ok(), "an authentic telecommand is accepted");
  check(authentication.verify(secured, parsed.value()).status() == fsw::Status::kBadSequence,
        "and refused a second time");
  print("verification of a telecommand: ");
  print_decimal(static_cast<std::uint32_t>(cost));
  print(" counts\n");
}

[[gnu::noinline]] int recurse(int depth) {
  std::array<volatile int, 64> frame{};
  frame[static_cast<std::size_t>(depth) % frame.size()] = depth;
  return depth < 0 ? 0 : recurse(depth + 1) + frame[3];
}

void provoke(const char* name) {
  volatile std::uint32_t zero = 0;
  if (std::strcmp(name, "heap") == 0) {
    static volatile char* volatile taken = new char[16];
    static_cast<void>(taken);
  } else if (std::strcmp(name, "null") == 0) {
    reg(zero) = 1;
  } else if (std::strcmp(name, "code") == 0) {
    reg(kImageStart + zero) = 1;
  } else if (std::strcmp(name, "jump") == 0) {
    reinterpret_cast<void (*)()>(kStackSection + zero)();
  } else if (std::strcmp(name, "undefined") == 0) {
    asm volatile("udf #0");
  } else if (std::strcmp(name, "stack") == 0) {
    failures += recurse(1);
  }
  print("nothing caught ");
  print(name);
  print("\n");
  semihosting_exit(static_cast<std::uint32_t>(ExitCode::kSelfTestFailed));
}

}  // namespace
}  // namespace vbar::boards::zynq7000

int main() {
  using namespace vbar::boards::zynq7000;
  clocks_enable_peripherals();
  timers_initialize();
  console_open();
  interrupts_initialize();

  std::array<char, 256> command_line{};
  if (semihosting_command_line(command_line)) {
    const char* const space = std::strchr(command_line.data(), ' ');
    if (space != nullptr && space[1] != '\0') {
      provoke(space + 1);
    }
  }
  check_floating_point();
  check_memory();
  check_timers();
  check_interrupts();
  check_deferral();
  check_ethernet();
  check_authentication();
  print(failures == 0 ? "self-test passed\n" : "self-test FAILED\n");
  semihosting_exit(static_cast<std::uint32_t>(failures == 0 ? ExitCode::kDone : ExitCode::kSelfTestFailed));
  for (;;) {
    wait_for_interrupt();
  }
}
