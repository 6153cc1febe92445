// Blocks of the object stream of motion capture on arbitrary bytes. Promises: std::invalid_argument or objects with
// finite numbers, which are the same when they are written and read again; averages are finite.

#include <stdexcept>

#include "hil_drivers/tron/protocols/vicon_receiver.h"
#include "hil_drivers/tron/protocols/vicon_stream.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::tron;

void check(const vicon::ObjectAverage& average) {
  if (average.state != vicon::ObjectState::kTracked) return;
  VBAR_FUZZ_EXPECT(average.frames > 0);
  VBAR_FUZZ_EXPECT(average.T_V_object.linear().allFinite());
}

void read_block(vicon::ByteSpan bytes) {
  const vicon::ObjectBlock block = vicon::decode_block(bytes);
  const auto again = vicon::decode_block(vicon::encode_frame(block, 0).at(0));
  VBAR_FUZZ_EXPECT(again.frame == block.frame && again.objects.size() == block.objects.size());
  for (std::size_t k = 0; k < block.objects.size(); ++k)
    VBAR_FUZZ_EXPECT(again.objects[k].name == block.objects[k].name &&
                     again.objects[k].has_same_numbers(block.objects[k]));
  vicon::FrameHistory history("camera", "target", "xyz");
  history.add(block);
  const auto average = history.average(1, {});
  check(average.camera);
  check(average.target);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    read_block(vicon::ByteSpan(data, size));
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
