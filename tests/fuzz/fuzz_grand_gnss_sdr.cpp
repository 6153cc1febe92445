// Datagrams of gnss-sdr's monitors: whatever arrives, an observable that is taken is finite and plausible, and epochs
// come in order.

#include <cmath>

#include "emulators/grand/samples/gnss_sdr_observables.h"
#include "tests/fuzz/fuzz_target.h"

using namespace vbar::grand::bench;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  if (const auto subframe = read_subframe(bytes)) {
    VBAR_FUZZ_EXPECT(subframe->prn >= 1 && subframe->prn <= 32);
    for (const std::uint32_t word : subframe->words) VBAR_FUZZ_EXPECT(word < 1U << 30U);
  }
  const auto observables = read_observables(bytes);
  if (!observables) return 0;
  ObservableEpochs epochs(2, 100);
  std::int64_t last_ms = 0;
  for (const Observable& observable : *observables) {
    VBAR_FUZZ_EXPECT(std::isfinite(observable.rx_time_s));
    VBAR_FUZZ_EXPECT(!observable.valid ||
                     (observable.pseudorange_m > 0.0 && std::isfinite(observable.carrier_phase_cycles) &&
                      std::isfinite(observable.doppler_hz)));
    epochs.take(observable);
    while (const auto epoch = epochs.next()) {
      constexpr std::int64_t kHalfWeek_ms = 302'400'000;
      VBAR_FUZZ_EXPECT(epoch->rx_time_ms > last_ms || last_ms - epoch->rx_time_ms > kHalfWeek_ms);
      last_ms = epoch->rx_time_ms;
    }
  }
  return 0;
}
