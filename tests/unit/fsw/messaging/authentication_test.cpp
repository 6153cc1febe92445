// Telecommands with a security trailer: what the flight software accepts, what it refuses and where it counts that.

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "fsw/messaging/inbox.h"
#include "fsw/messaging/vbar_gnc.h"
#include "tests/unit/fsw/messaging/configurations.h"
#include "tests/unit/fsw/messaging/hostile_telecommands.h"

namespace vbar::fsw::messaging {
namespace {

using gnc::test::kServicer;
using gnc::test::packet_of;
using test::Bytes;
using test::Hostility;
using test::TelecommandSender;

std::unique_ptr<Inbox> keyed_inbox(const TelecommandSender& sender) {
  auto inbox = std::make_unique<Inbox>(kServicer);
  inbox->authenticate(sender.security());
  return inbox;
}

std::int64_t refusals(const PacketCounters& counters) {
  return std::int64_t{0} + counters.rejected_checksum + counters.rejected_type + counters.rejected_length +
         counters.rejected_content + counters.rejected_time + counters.rejected_other + counters.dropped_full;
}

std::size_t waiting_telecommands(const Inbox& inbox) {
  std::size_t sum = 0;
  packets::for_each_telecommand([&]<class Message>() { sum += inbox.queue<Message>().size(); });
  return sum;
}

class HostileTelecommands : public ::testing::TestWithParam<std::size_t> {};

// A genuine one every hundred shows that the inbox does not refuse because it refuses everything.
TEST_P(HostileTelecommands, AreRefusedAndCounted) {
  constexpr int kRounds = 1000, kHostilePerRound = 100;
  TelecommandSender sender(static_cast<std::uint32_t>(GetParam()));
  const auto inbox = keyed_inbox(sender);
  for (int round = 0; round < kRounds; ++round) {
    ASSERT_EQ(inbox->receive(sender.genuine()), Status::kOk) << round;
    ASSERT_EQ(waiting_telecommands(*inbox), 1U);
    inbox->clear({});
    for (int k = 0; k < kHostilePerRound; ++k)
      ASSERT_NE(inbox->receive(sender.hostile(static_cast<Hostility>(GetParam()))), Status::kOk) << round;
    ASSERT_EQ(waiting_telecommands(*inbox), 0U) << round;
  }
  EXPECT_EQ(inbox->counters().accepted, kRounds);
  EXPECT_EQ(refusals(inbox->counters()), std::int64_t{kRounds} * kHostilePerRound);
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, HostileTelecommands, ::testing::Range(std::size_t{0}, test::kHostilities.size()));

/// A telecommand with a trailer, as the host makes it.
Bytes secured(const Bytes& packet, const packets::TelecommandSecurity& security, std::uint64_t sequence) {
  Bytes bytes(packets::kMaxPacketBytes);
  const packets::HmacSha256 hmac(security.key);
  const auto size = packets::write_secured(packet, hmac, security.index, sequence, bytes);
  EXPECT_TRUE(size.ok());
  bytes.resize(size.ok() ? size.value() : 0);
  return bytes;
}

// The sequence number is fresh, so that only the code can be the reason.
TEST(Authentication, RefusesEachAlteredBitOfATelecommand) {
  TelecommandSender sender(1);
  const auto inbox = keyed_inbox(sender);
  const Bytes good = secured(packet_of({10}, gnc::test::earth()), sender.security(), sender.security().sequence + 1);
  for (std::size_t bit = 0; bit < 8 * (good.size() - packets::kPacketCrcBytes); ++bit) {
    // A packet whose length field is wrong does not even parse, and sealed() would correct it.
    if (bit / 8 == 4 || bit / 8 == 5) continue;
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << bit % 8));
    ASSERT_NE(inbox->receive(TelecommandSender::sealed(bad)), Status::kOk) << bit;
  }
  EXPECT_EQ(waiting_telecommands(*inbox), 0U);
  EXPECT_EQ(inbox->receive(good), Status::kOk);
}

TEST(Authentication, CountsEachRefusalByItsCause) {
  TelecommandSender sender(2);
  const auto inbox = keyed_inbox(sender);
  ASSERT_EQ(inbox->receive(sender.genuine()), Status::kOk);
  EXPECT_EQ(inbox->receive(sender.hostile(Hostility::kReplayed)), Status::kBadSequence);
  EXPECT_EQ(inbox->receive(sender.hostile(Hostility::kDelayed)), Status::kBadSequence);
  EXPECT_EQ(inbox->counters().rejected_other, 2);
  EXPECT_EQ(inbox->receive(sender.hostile(Hostility::kOtherIndex)), Status::kBadChecksum);
  EXPECT_EQ(inbox->receive(sender.hostile(Hostility::kOtherKey)), Status::kBadChecksum);
  EXPECT_EQ(inbox->receive(sender.hostile(Hostility::kGuessed)), Status::kBadChecksum);
  EXPECT_EQ(inbox->counters().rejected_checksum, 3);
  packets::PacketHeader header;
  header.apid = packets::Apid::kFaultCommand;
  header.spacecraft = kServicer;
  Bytes empty(packets::kPacketHeaderBytes + packets::kPacketCrcBytes);
  ASSERT_TRUE(packets::write_packet(header, {}, empty).ok());
  EXPECT_EQ(inbox->receive(empty), Status::kTooShort);
  EXPECT_EQ(inbox->counters().rejected_length, 1);
  EXPECT_EQ(inbox->counters().accepted, 1);
}

// A telecommand that the content of is refused has used its sequence number: it cannot come again, nor one before it.
TEST(Authentication, SpendsTheSequenceNumberOfAGenuineTelecommandWithInvalidContent) {
  TelecommandSender sender(3);
  const auto inbox = keyed_inbox(sender);
  const std::uint64_t first = sender.security().sequence + 1;
  const Bytes late = packet_of(GpsTime{-1}, gnc::test::earth());
  EXPECT_EQ(inbox->receive(secured(late, sender.security(), first + 1)), Status::kOutOfRange);
  EXPECT_EQ(inbox->receive(secured(late, sender.security(), first + 1)), Status::kBadSequence);
  EXPECT_EQ(inbox->receive(secured(packet_of({10}, gnc::test::earth()), sender.security(), first)),
            Status::kBadSequence);
  EXPECT_EQ(inbox->receive(secured(packet_of({10}, gnc::test::earth()), sender.security(), first + 2)), Status::kOk);
}

TEST(Authentication, LeavesPacketsThatAreNotTelecommandsAsTheyAre) {
  TelecommandSender sender(4);
  const auto inbox = keyed_inbox(sender);
  EXPECT_EQ(inbox->receive(packet_of({10}, ideal_navigation{})), Status::kOk);
  tick next{};
  next.period_ns = 10;
  EXPECT_EQ(inbox->receive(packet_of({10}, next)), Status::kOk);
}

// Both ends must be configured: a trailer is a payload of wrong size to a flight software without a key.
TEST(Authentication, IsRefusedWithoutAKey) {
  TelecommandSender sender(5);
  Inbox inbox(kServicer);
  EXPECT_NE(inbox.receive(sender.genuine()), Status::kOk);
  EXPECT_EQ(inbox.receive(sender.hostile(Hostility::kUnauthenticated)), Status::kOk);
}

// The greatest packet that there can be with a trailer, and one byte more.
TEST(Authentication, LeavesRoomForTheTrailer) {
  TelecommandSender sender(6);
  packets::PacketHeader header;
  header.apid = packets::Apid::kTargetModel;
  header.spacecraft = kServicer;
  const packets::HmacSha256 hmac(sender.security().key);
  for (const std::size_t excess : {std::size_t{0}, std::size_t{1}}) {
    const Bytes payload(packets::kMaxSecuredPayloadBytes + excess, 0x5A);
    Bytes plain(packets::kMaxPacketBytes), out(packets::kMaxPacketBytes);
    plain.resize(packets::write_packet(header, payload, plain).value());
    const auto size = packets::write_secured(plain, hmac, 1, sender.security().sequence + 1, out);
    if (excess != 0) {
      EXPECT_EQ(size.status(), Status::kTooLong);
      continue;
    }
    ASSERT_EQ(size.value(), packets::kMaxPacketBytes);
    packets::TelecommandAuthentication authentication;
    authentication.require(sender.security());
    const auto verified = authentication.verify(out, packets::parse_packet(out).value());
    ASSERT_TRUE(verified.ok());
    EXPECT_TRUE(std::ranges::equal(verified.value().payload, payload));
  }
  packets::for_each_telecommand([]<class Message>() {
    EXPECT_LE(static_cast<std::size_t>(Message{}.getEncodedSize()), packets::kMaxSecuredPayloadBytes);
  });
}

TEST(Authentication, KeepsTheSequenceNumberThroughASnapshotAndNeverLowersIt) {
  TelecommandSender sender(7);
  const auto before = keyed_inbox(sender);
  const Bytes command = sender.genuine();
  ASSERT_EQ(before->receive(command), Status::kOk);
  const auto after = keyed_inbox(sender);  // cold: as if it had never seen the command
  after->restore(before->retained());
  EXPECT_EQ(after->receive(command), Status::kBadSequence);
  EXPECT_EQ(after->receive(sender.genuine()), Status::kOk);
  const std::uint64_t reached = after->authentication().sequence();
  after->restore(before->retained());
  EXPECT_EQ(after->authentication().sequence(), reached);
}

/// A flight software with a key, whose last step is before `now`.
gnc::test::Flight keyed_flight(const TelecommandSender& sender) {
  gnc::test::Flight flight = gnc::test::under_way();
  EXPECT_EQ(vbar_gnc_authenticate(flight.article.memory(), sender.security().key.data(), sender.security().index,
                                  sender.security().sequence),
            0);
  return flight;
}

vbar_status restored_by(const packets::TelecommandSecurity& security, const Bytes& snapshot, const Bytes& command) {
  gnc::test::Article article;
  EXPECT_EQ(vbar_gnc_authenticate(article.memory(), security.key.data(), security.index, security.sequence), 0);
  if (const vbar_status status = article.restore_snapshot(snapshot); status != 0) return status;
  return article.deliver(command);
}

/// Corrects the checksum of a snapshot, as an adversary would: CRC-32 of what precedes it and of what follows it.
Bytes resealed(Bytes snapshot) {
  constexpr std::size_t kCrcAt = 36, kHeaderBytes = 40;
  const std::span<const std::uint8_t> all(snapshot);
  const std::uint32_t crc = packets::crc32_ieee(all.first(kCrcAt)) ^ packets::crc32_ieee(all.subspan(kHeaderBytes));
  std::memcpy(&snapshot[kCrcAt], &crc, sizeof crc);
  return snapshot;
}

TEST(AuthenticatedRestart, ContinuesFromItsOwnSnapshotAloneAndRefusesWhatWasAcceptedBefore) {
  TelecommandSender sender(8);
  const gnc::test::Flight without = gnc::test::under_way();
  gnc::test::Flight flight = keyed_flight(sender);
  const Bytes command = sender.genuine();
  ASSERT_EQ(flight.article.deliver(command), 0);
  const Bytes snapshot = flight.article.snapshot();
  EXPECT_EQ(vbar_gnc_telecommand_sequence(flight.article.memory()), sender.reached());
  EXPECT_EQ(restored_by(sender.security(), snapshot, command), static_cast<int>(Status::kBadSequence));
  EXPECT_EQ(restored_by(sender.security(), snapshot, sender.genuine()), 0);

  const auto damaged = static_cast<int>(Status::kBadChecksum);
  ASSERT_EQ(resealed(snapshot), snapshot);
  for (const std::size_t at : {std::size_t{24}, std::size_t{50}, snapshot.size() / 2, snapshot.size() - 1}) {
    Bytes altered = snapshot;
    altered[at] ^= 1U;
    EXPECT_EQ(restored_by(sender.security(), resealed(altered), command), damaged) << at;
  }
  packets::TelecommandSecurity other = sender.security();
  other.key[0] ^= 1U;
  EXPECT_EQ(restored_by(other, snapshot, command), damaged);
  EXPECT_EQ(restored_by(sender.security(), without.article.snapshot(), command), damaged);
}

bool contains(const Bytes& bytes, std::span<const std::uint8_t> part) {
  return std::search(bytes.begin(), bytes.end(), part.begin(), part.end()) != bytes.end();
}

TEST(AuthenticatedRestart, TheSnapshotHasNoKey) {
  TelecommandSender sender(9);
  const gnc::test::Flight flight = keyed_flight(sender);
  const Bytes snapshot = flight.article.snapshot();
  const packets::TelecommandKey& key = sender.security().key;
  // Nor any part of what the key was made into.
  const packets::HmacSha256 hmac(key);
  Bytes made(sizeof hmac);
  std::memcpy(made.data(), &hmac, sizeof hmac);
  EXPECT_FALSE(contains(snapshot, std::span(key).first(8)));
  for (const std::size_t at : {std::size_t{0}, sizeof(packets::Sha256)})
    EXPECT_FALSE(contains(snapshot, std::span(made).subspan(at, 8)));
}

TEST(AuthenticationByTheInterfaceInC, ChecksItsArguments) {
  TelecommandSender sender(10);
  gnc::test::Article article;
  const auto invalid = static_cast<vbar_status>(Status::kInvalidArgument);
  EXPECT_EQ(vbar_gnc_authenticate(nullptr, sender.security().key.data(), 1, 0), invalid);
  EXPECT_EQ(vbar_gnc_authenticate(article.memory(), nullptr, 1, 0), invalid);
  EXPECT_EQ(vbar_gnc_telecommand_sequence(nullptr), 0U);
  EXPECT_EQ(vbar_gnc_telecommand_sequence(article.memory()), 0U);
}

TEST(Key, IsReadFrom64HexadecimalDigits) {
  const auto parsed = [](std::string_view text) { return packets::parse_telecommand_key(text); };
  const std::string digits = "000102030405060708090a0b0c0d0e0f101112131415161718191A1B1C1D1E1F";
  for (const std::string& text : {digits, digits + "\n", digits + " \r\n"}) {
    const auto key = parsed(text);
    ASSERT_TRUE(key.ok());
    for (std::size_t k = 0; k < key.value().size(); ++k) EXPECT_EQ(key.value()[k], k);
  }
  EXPECT_EQ(parsed("").status(), Status::kTooShort);
  EXPECT_EQ(parsed(digits.substr(1)).status(), Status::kTooShort);
  EXPECT_EQ(parsed(digits + "0").status(), Status::kTooLong);
  EXPECT_EQ(parsed("g" + digits.substr(1)).status(), Status::kInvalidArgument);
  EXPECT_EQ(parsed(" " + digits).status(), Status::kInvalidArgument);
}

// Unix time of the GPS epoch, and the clock of 2026-01-01 UTC by Python's datetime.
TEST(Sequence, IsNanosecondsSince1980) {
  EXPECT_EQ(packets::sequence_at(315'964'800, 0), 0U);
  EXPECT_EQ(packets::sequence_at(1'767'225'600, 5), 1'451'260'800'000'000'005U);
}

}  // namespace
}  // namespace vbar::fsw::messaging
