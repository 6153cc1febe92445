#include "host_sim/engine/event_queue.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::engine {
namespace {

using fsw::GpsTime;
using fsw::Status;

TEST(EventQueue, OrdersByTimeThenPriorityThenInsertion) {
  EventQueue<char> queue(GpsTime{0});
  ASSERT_TRUE(queue.schedule(GpsTime{20}, 0, 'e').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{10}, 1, 'c').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{10}, 1, 'd').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{10}, -1, 'b').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{5}, 9, 'a').ok());
  std::string order;
  while (const auto entry = queue.pop()) order += entry->event;
  EXPECT_EQ(order, "abcde");
}

// The order is that of a stable sort by (time, priority), whatever order the events were scheduled in.
TEST(EventQueue, AgreesWithAStableSortOfManyRandomEvents) {
  struct Event {
    std::int64_t time;
    std::int32_t priority;
    int number;
  };
  std::mt19937 generator(7);
  std::vector<Event> events;
  EventQueue<int> queue(GpsTime{0});
  for (int k = 0; k < 2000; ++k) {
    const Event event{static_cast<std::int64_t>(generator() % 50), static_cast<std::int32_t>(generator() % 5) - 2, k};
    events.push_back(event);
    ASSERT_TRUE(queue.schedule(GpsTime{event.time}, event.priority, event.number).ok());
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return a.time != b.time ? a.time < b.time : a.priority < b.priority;
  });
  for (const Event& expected : events) {
    const auto entry = queue.pop();
    ASSERT_TRUE(entry.has_value());
    EXPECT_EQ(entry->event, expected.number);
  }
  EXPECT_TRUE(queue.empty());
}

TEST(EventQueue, CancelledEventDoesNotHappenAndCancelsOnce) {
  EventQueue<int> queue(GpsTime{0});
  const auto first = queue.schedule(GpsTime{1}, 0, 1);
  const auto second = queue.schedule(GpsTime{2}, 0, 2);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_TRUE(queue.cancel(first.value()));
  EXPECT_FALSE(queue.cancel(first.value()));
  const auto entry = queue.pop();
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->event, 2);
  EXPECT_FALSE(queue.cancel(second.value())) << "it has happened";
}

TEST(EventQueue, PresentFollowsTheEventsAndThePastIsClosed) {
  EventQueue<int> queue(GpsTime{100});
  EXPECT_EQ(queue.schedule(GpsTime{99}, 0, 1).status(), Status::kOutOfRange);
  ASSERT_TRUE(queue.schedule(GpsTime{100}, 0, 2).ok()) << "the present is not the past";
  ASSERT_TRUE(queue.schedule(GpsTime{150}, 0, 3).ok());
  EXPECT_EQ(queue.next_time(), GpsTime{100});
  ASSERT_TRUE(queue.pop().has_value());
  ASSERT_TRUE(queue.pop().has_value());
  EXPECT_EQ(queue.now(), GpsTime{150});
  EXPECT_EQ(queue.schedule(GpsTime{149}, 0, 4).status(), Status::kOutOfRange);
  EXPECT_FALSE(queue.next_time().has_value());
  EXPECT_FALSE(queue.pop().has_value());
}

// An event scheduled while its own instant is being worked off still happens at that instant, in its place.
TEST(EventQueue, EventsScheduledForThePresentHappenInPriorityOrder) {
  EventQueue<char> queue(GpsTime{0});
  ASSERT_TRUE(queue.schedule(GpsTime{1}, 0, 'a').ok());
  ASSERT_TRUE(queue.schedule(GpsTime{1}, 2, 'c').ok());
  ASSERT_EQ(queue.pop()->event, 'a');
  ASSERT_TRUE(queue.schedule(GpsTime{1}, 1, 'b').ok());
  EXPECT_EQ(queue.pop()->event, 'b');
  EXPECT_EQ(queue.pop()->event, 'c');
}

}  // namespace
}  // namespace vbar::engine
