// The flight software flies the whole mission without asking the heap for anything. A program of its own, because it
// puts itself between all code and the allocator.

#include <cstdlib>
#include <new>

#include "tests/unit/fsw/gnc/small_world.h"

namespace {

// Allocations while the flight software runs. The counter is armed around each call of the C interface only: the world
// and the test may allocate as they like.
bool armed = false;
long allocations = 0;

void count_allocation() {
  if (armed) ++allocations;
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
#define VBAR_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define VBAR_ADDRESS_SANITIZER 1
#endif
#endif

#if defined(VBAR_ADDRESS_SANITIZER)

// The sanitizer is the allocator and has a hook for this.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*, std::size_t),
                                                         void (*free_hook)(const volatile void*));
namespace {
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { count_allocation(); }, [](const volatile void*) {});
}

#else

// glibc's own names for its allocator, of which these take the place in this program; operator new and the C++
// library's containers come here too.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) noexcept {
  count_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  count_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  count_allocation();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count_allocation();
  return __libc_memalign(alignment, size);
}
}

#endif

namespace vbar::fsw::gnc::test {
namespace {

TEST(Allocation, TheCounterCounts) {
  allocations = 0;
  armed = true;
  ::operator delete(::operator new(100));
  void* volatile memory = std::malloc(100);
  armed = false;
  std::free(memory);
  EXPECT_EQ(allocations, 2);
}

TEST(Allocation, NoneInAWholeMission) {
  Flight flight((Vector6() << -2000, -75000, 0, 0, 0, 0).finished());
  allocations = 0;
  flight.article.around_flight_code = [](bool entering) { armed = entering; };
  flight.send(configuration());
  flight.send(paper_waypoints());
  flight.send(mode(1));
  const GpsTime last = at(41 * 3600 + 900);
  Answer answer;
  while (flight.now <= last + duration_of_seconds(3600)) answer = flight.step();  // an hour of station keeping besides
  EXPECT_EQ(allocations, 0);
  // It was the mission that was flown: all waypoints passed, with the burns of every leg, and no hold.
  EXPECT_EQ(answer.control.mode, 2);
  EXPECT_GT(flight.executed, 30);
  EXPECT_GT(flight.executed_dv, 3.5);
  EXPECT_EQ(answer.health.holds, 0);
}

// On the paths that a good flight does not take: refused packets, full queues, holds, lost navigation.
TEST(Allocation, NoneWhenThingsGoWrong) {
  Flight flight((Vector6() << 0, -100, 0, 3, 0, 3).finished());
  const Vector6 near = (Vector6() << -0.5, -10, 0, 2, 0, 1).finished();
  gnc_configuration c = configuration();
  c.keep_out_radius_m = 20.0;
  flight.send(c);
  flight.send(table_of({waypoint_at(8, 3 * 3600, 0, near)}));
  flight.send(mode(1));
  allocations = 0;
  flight.article.around_flight_code = [](bool entering) { armed = entering; };
  flight.step();
  const Bytes good = packet_of(flight.now, flight.world.measurement());
  Bytes broken = good;
  broken[40] ^= 1U;
  for (std::uint16_t k = 0; k < 100; ++k) {
    flight.article.deliver(broken);
    flight.article.deliver({flight.now.ns - k}, flight.world.measurement(), k);
  }
  flight.measures = false;
  const Answer answer = flight.fly_until(at(4000));
  EXPECT_EQ(allocations, 0);
  EXPECT_GT(answer.health.inbox_dropped, 0);
  EXPECT_EQ(answer.health.rejected_checksum, 100);
  EXPECT_GT(answer.health.holds, 0);
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
