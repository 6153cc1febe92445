// A receiver's line on arbitrary bytes. The first byte chooses: the bytes as they come, or as messages with a right CRC
// (which a fuzzer does not guess), so that the contents are reached:
//
//   byte 0  even: raw bytes. Odd: records of  kind, time status, body length (2 bytes, little-endian), body
//
// Promises: memory and time are bounded, what is reported keeps its promises, and the counters add up.

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/receiver_promises.h"
#include "tests/unit/fsw/gnss/oem_messages.h"

namespace {

using vbar::fsw::gnss::ReceiverDecoder;
namespace oem = vbar::fsw::gnss::test;

constexpr std::array<unsigned, 12> kKinds{7, 8, 41, 42, 43, 101, 140, 241, 1122, 1696, 83, 1};

void feed(ReceiverDecoder& decoder, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    VBAR_FUZZ_EXPECT(vbar::test::keeps_promises(decoder, decoder.push(byte)));
  }
}

void feed_records(ReceiverDecoder& decoder, std::span<const std::uint8_t> rest) {
  constexpr std::size_t kRecordHeader = 4;
  while (rest.size() >= kRecordHeader) {
    const unsigned id = kKinds[rest[0] % kKinds.size()];
    const unsigned time_status = rest[1];
    const std::size_t announced = rest[2] + 256U * (rest[3] % 8U);
    rest = rest.subspan(kRecordHeader);
    const auto body = rest.first(std::min(announced, rest.size()));
    rest = rest.subspan(body.size());
    const auto before = decoder.stream().counters();
    feed(decoder, oem::message(id, {body.begin(), body.end()}, {.time_status = time_status}));
    // More than one where the body itself holds whole messages; none only where it holds more false starts than are
    // followed.
    const auto& after = decoder.stream().counters();
    VBAR_FUZZ_EXPECT(after.messages > before.messages || after.given_up > before.given_up);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  const std::span<const std::uint8_t> input(data, size);
  if (input.empty()) return 0;
  if (input[0] % 2 == 0) {
    feed(*decoder, input.subspan(1));
  } else {
    feed_records(*decoder, input.subspan(1));
  }
  const auto& stream = decoder->stream();
  VBAR_FUZZ_EXPECT(stream.skipped_bytes() + stream.counters().message_bytes <= stream.counters().bytes);
  const auto& counters = decoder->counters();
  VBAR_FUZZ_EXPECT(counters.unknown + counters.refused + counters.not_ready <= stream.counters().messages);
  return 0;
}
