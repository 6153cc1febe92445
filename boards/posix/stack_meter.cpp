#include "boards/posix/stack_meter.h"

#include <algorithm>
#include <array>

#include <pthread.h>
#include <sys/mman.h>

namespace vbar::boards::posix {
namespace {

constexpr std::size_t kGuardBytes = std::size_t{64} * 1024;  // a multiple of every page size in use on these processors
constexpr std::uint64_t kPaint = 0x5AFEC0DE5AFEC0DEU;
/// This length of contiguous paint ends the search. Larger than any array that a flight-code frame may leave untouched;
/// a search of the whole stack would cost more than many steps.
constexpr std::size_t kCleanWords = std::size_t{64} * 1024 / sizeof(std::uint64_t);

struct FlightStack {
  alignas(kGuardBytes) std::array<std::byte, kGuardBytes> guard;
  std::array<std::uint64_t, kFlightStackBytes / sizeof(std::uint64_t)> words;
};

FlightStack flight_stack;
const std::uint64_t* top = nullptr;     ///< where `function` began
const std::uint64_t* lowest = nullptr;  ///< deepest word found used so far

struct Call {
  void (*function)(void*);
  void* context;
};

void* enter(void* argument) {
  const auto* const call = static_cast<const Call*>(argument);
  const volatile std::uint64_t here = 0;
  // What lies above belongs to the C library's start of a thread.
  const auto depth = reinterpret_cast<std::uintptr_t>(&here) - reinterpret_cast<std::uintptr_t>(&flight_stack.words);
  top = flight_stack.words.data() + std::min(depth / sizeof(std::uint64_t), flight_stack.words.size());
  lowest = top;
  call->function(call->context);
  return nullptr;
}

}  // namespace

bool run_on_measured_stack(void (*function)(void*), void* context) {
  flight_stack.words.fill(kPaint);
  if (::mprotect(flight_stack.guard.data(), kGuardBytes, PROT_NONE) != 0) return false;
  Call call{function, context};
  pthread_attr_t attributes;
  if (::pthread_attr_init(&attributes) != 0) return false;
  pthread_t thread{};
  const bool started = ::pthread_attr_setstack(&attributes, flight_stack.words.data(), kFlightStackBytes) == 0 &&
                       ::pthread_create(&thread, &attributes, &enter, &call) == 0;
  ::pthread_attr_destroy(&attributes);
  if (started) ::pthread_join(thread, nullptr);
  // It must be readable for programs that scan static memory later (a leak checker).
  return ::mprotect(flight_stack.guard.data(), kGuardBytes, PROT_READ | PROT_WRITE) == 0 && started;
}

// It reads frames that have been left, which an address sanitizer would report as an error.
__attribute__((no_sanitize("address"))) std::uint32_t stack_high_water() {
  const volatile std::uint64_t* const bottom =
      flight_stack.words.data();  // volatile: written as a stack, read as words
  std::size_t clean = 0;
  const volatile std::uint64_t* word = lowest;
  while (word > bottom && clean < kCleanWords) {
    --word;
    if (*word == kPaint) {
      ++clean;
    } else {
      clean = 0;
      lowest = flight_stack.words.data() + (word - bottom);
    }
  }
  return static_cast<std::uint32_t>(static_cast<std::size_t>(top - lowest) * sizeof(std::uint64_t));
}

}  // namespace vbar::boards::posix
