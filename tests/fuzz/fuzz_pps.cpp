// Datagrams of PPS edges with arbitrary contents, and the clock that follows them. Promises: what is decoded is what
// was encoded, and the clock never runs backwards, whatever the edges say.

#include <algorithm>
#include <deque>
#include <memory>
#include <stdexcept>

#include "hil_drivers/grand/pps/edge_clock.h"
#include "hil_drivers/grand/wire/pps_datagram.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar;
using Span = engine::WallClock::Span;

class Host final : public engine::WallClock {
 public:
  explicit Host(Span& time) : time_(time) {}
  Span now() override { return time_; }
  void sleep_until(Span wake) override {
    if (wake > now()) time_ = wake;
  }

 private:
  Span& time_;
};

class Edges final : public grand::EdgeSource {
 public:
  explicit Edges(std::deque<grand::Edge>& edges) : edges_(edges) {}
  std::optional<grand::Edge> next(std::chrono::steady_clock::time_point /*deadline*/) override {
    if (edges_.empty()) return std::nullopt;
    const grand::Edge edge = edges_.front();
    edges_.pop_front();
    return edge;
  }
  [[nodiscard]] std::string description() const override { return "fuzz"; }

 private:
  std::deque<grand::Edge>& edges_;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  (void)grand::wire::decode_pps_datagram(bytes);
  Span time{5'000'000'000'000};
  std::deque<grand::Edge> edges;
  grand::EdgeClock clock(std::make_unique<Edges>(edges), std::make_unique<Host>(time));
  Span previous{0};
  for (std::size_t at = 0; at + grand::wire::kPpsDatagramBytes <= size; at += grand::wire::kPpsDatagramBytes) {
    const auto one = bytes.subspan(at, grand::wire::kPpsDatagramBytes);
    const auto datagram = grand::wire::decode_pps_datagram(one);
    if (!datagram) continue;
    VBAR_FUZZ_EXPECT(std::ranges::equal(grand::wire::encode_pps_datagram(*datagram), one));
    // The time stamp as it is, and one near the present, so that the filter is reached.
    for (const Span stamp : {Span(datagram->monotonic_ns), time + Span(datagram->monotonic_ns % 1'000'000'000)})
      edges.push_back({datagram->gps, stamp, datagram->count});
    time += std::chrono::milliseconds(500);
    try {
      const Span now = clock.now();
      VBAR_FUZZ_EXPECT(now >= previous);
      previous = now;
    } catch (const std::runtime_error&) {
      return 0;
    }
  }
  return 0;
}
