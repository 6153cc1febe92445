// Data packets of E1.31 on arbitrary bytes. Promises: std::invalid_argument or a packet which is the same when it is
// written and read again; a number of packets leaves the lights with slots of one of them.

#include <algorithm>
#include <stdexcept>

#include "emulators/tron/lights.h"
#include "hil_drivers/tron/protocols/sacn.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::tron;

void read_packet(sacn::ByteSpan bytes, bench::SourceArbiter& arbiter, double bench_s) {
  const sacn::DataPacket packet = sacn::decode_data_packet(bytes);
  sacn::Bytes written;
  sacn::encode_data_packet(packet, written);
  VBAR_FUZZ_EXPECT(sacn::decode_data_packet(written) == packet);
  arbiter.accept(packet, bench_s);
  VBAR_FUZZ_EXPECT(arbiter.slots().size() <= sacn::kMaxSlots);
}

}  // namespace

/// Packets one after the other, each behind two bytes with its length.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bench::SourceArbiter arbiter(1);
  sacn::ByteSpan rest(data, size);
  for (int count = 0; rest.size() >= 2; ++count) {
    const std::size_t length = std::min<std::size_t>(rest.size() - 2, 256U * rest[0] + rest[1]);
    try {
      read_packet(rest.subspan(2, length), arbiter, count);
    } catch (const std::invalid_argument&) {
      arbiter.count_unreadable();
    }
    arbiter.advance(count);
    rest = rest.subspan(2 + length);
  }
  return 0;
}
