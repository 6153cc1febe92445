// A packet log of arbitrary bytes: read back, and played as a sensor. Promises: one error at most, memory is bounded by
// the file, and what is played is what was read.

#include <stdexcept>

#include "host_sim/twins/recorded_log.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

using namespace vbar;

void play(const std::filesystem::path& file, std::size_t records) {
  twins::RecordedLog log(file, {.spacecraft = 1, .apids = {fsw::packets::Apid::kIdealNavigation}});
  twins::TruthSnapshot truth;
  std::size_t played = 0;
  auto next = log.next_epoch(fsw::GpsTime{INT64_MIN});
  while (next) {
    truth.time = *next;
    played += log.measure(truth).packets.size();
    if (next->ns == INT64_MAX) break;
    next = log.next_epoch(fsw::GpsTime{next->ns + 1});
  }
  VBAR_FUZZ_EXPECT(played > 0 && played <= records);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::File file({data, size});
  try {
    const twins::PacketLog log = twins::read_packet_log(file.path());
    std::size_t bytes = 0;
    for (const twins::PacketRecord& record : log.records) bytes += record.packet.size();
    VBAR_FUZZ_EXPECT(bytes <= size);
    play(file.path(), log.records.size());
  } catch (const std::runtime_error&) {
  }
  return 0;
}
