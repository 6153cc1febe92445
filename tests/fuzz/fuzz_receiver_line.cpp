// What the driver of the GNSS testbed reads of a receiver's line: answers, prompts, bursts, shifted weeks. Promises: no
// byte of the line is lost or added, and a shift of the weeks keeps its length.

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "hil_drivers/grand/bursts.h"
#include "hil_drivers/grand/receiver_port.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace grand = vbar::grand;
  const std::span<const std::uint8_t> bytes(data, size);
  if (const auto answer = grand::find_answer(bytes))
    VBAR_FUZZ_EXPECT(answer->is_accepted == (answer->text == "<OK") && answer->text.size() <= 200);
  if (const auto prompt = grand::find_prompt(bytes)) VBAR_FUZZ_EXPECT(prompt->size() >= 3 && prompt->size() <= 5);
  static_cast<void>(grand::printable(bytes));

  grand::BurstCutter cutter;
  std::vector<std::uint8_t> passed;
  for (const grand::Burst& burst : cutter.push(bytes))
    passed.insert(passed.end(), burst.bytes.begin(), burst.bytes.end());
  const std::vector<std::uint8_t> rest = cutter.take_rest();
  passed.insert(passed.end(), rest.begin(), rest.end());
  VBAR_FUZZ_EXPECT(std::ranges::equal(passed, bytes));

  grand::shift_weeks(passed, 1024);
  VBAR_FUZZ_EXPECT(passed.size() == size);
  return 0;
}
