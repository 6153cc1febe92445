#include "tests/unit/fsw/gnc/bit_flips.h"

#include <random>

#include <gtest/gtest.h>

#include "fsw/navigation/state_integrity.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

Answer step_with(Article& article, GpsTime now, Duration period, const std::vector<Bytes>& packets) {
  for (const Bytes& packet : packets) EXPECT_EQ(article.deliver(packet), 0);
  return article.step(now, period);
}

}  // namespace

const GncState& state_of(Article& article) {
  return *static_cast<const GncState*>(static_cast<const void*>(article.memory()));
}

void flip(unsigned char& byte, int bit) {
  byte = static_cast<unsigned char>(byte ^ (1U << static_cast<unsigned>(bit)));
}

void expect_flips_corrected(const std::vector<std::byte>& memory, std::span<unsigned char> (*part)(Article&),
                            GpsTime now, Duration period, const std::vector<Bytes>& packets) {
  Article article;
  article.restore(memory);
  const Answer reference = step_with(article, now, period, packets);
  ASSERT_EQ(reference.health.faults_present & telemetry_health::kFaultState, 0);
  const std::span<unsigned char> bytes = part(article);
  std::mt19937 random(20260101);
  std::uniform_int_distribution<std::size_t> place(0, bytes.size() - 1);
  std::uniform_int_distribution<int> bit(0, 7);
  for (int k = 0; k < kFlips; ++k) {
    article.restore(memory);
    const std::size_t at_byte = place(random);
    flip(bytes[at_byte], bit(random));
    const Answer answer = step_with(article, now, period, packets);
    ASSERT_NE(answer.health.faults_present & telemetry_health::kFaultState, 0) << "byte " << at_byte;
    ASSERT_EQ(answer.events.size(), reference.events.size() + 1) << "byte " << at_byte;
    const auto is_restored = [](const telemetry_event& event) {
      return event.fault == telemetry_health::kFaultState &&
             event.argument == static_cast<double>(navigation::Integrity::kRestored);
    };
    ASSERT_TRUE(std::ranges::any_of(answer.events, is_restored)) << "byte " << at_byte;
    ASSERT_EQ(without_health(answer.packets), without_health(reference.packets)) << "byte " << at_byte;
  }
}

}  // namespace vbar::fsw::gnc::test
