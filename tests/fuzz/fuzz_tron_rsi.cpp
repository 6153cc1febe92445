// Datagrams of RSI with arbitrary contents, in both directions. Promise: the decoder never throws; it states a problem,
// or delivers finite values that are the same to the decimals of the wire after encoding and decoding them again.

#include <cmath>
#include <string>

#include "hil_drivers/tron/protocols/rsi_messages.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::tron::rsi;

EthernetXml configuration() {
  EthernetXml ethernet;
  ethernet.sen_type = "VBAR";
  ethernet.sent = {"RIst", "AIPos", "EIPos", "Delay"};
  for (std::size_t k = 0; k < kWireAxes; ++k)
    ethernet.axes[k] = {"A" + std::to_string(k + 1), static_cast<int>(k) + 2, true};
  ethernet.track_element = "EK";
  ethernet.track = {"E1", 8, true};
  ethernet.stop_element = "Stop";
  ethernet.stop = {"", 1, true};
  return ethernet;
}

bool same(double a, double b) {
  return std::isfinite(a) && std::abs(a - b) <= 0.51e-4 + 1e-15 * std::abs(a);
}

bool same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}

void check_rob(Decoder& decoder, const EthernetXml& ethernet, std::string_view text) {
  Rob rob, again;
  if (!decoder.decode(text, rob)) {
    VBAR_FUZZ_EXPECT(!decoder.problem().empty());
    return;
  }
  std::string encoded;
  if (!encode(rob, ethernet, 4, encoded)) return;  // beyond 1e9
  VBAR_FUZZ_EXPECT(decoder.decode(encoded, again));
  VBAR_FUZZ_EXPECT(again.ipoc.text == rob.ipoc.text && again.ipoc.value == rob.ipoc.value && again.delay == rob.delay);
  for (std::size_t k = 0; k < kWireAxes; ++k)
    VBAR_FUZZ_EXPECT(same(rob.cartesian[k], again.cartesian[k]) && same(rob.axes_deg[k], again.axes_deg[k]) &&
                     same(rob.external_mm[k], again.external_mm[k]));
}

void check_sen(Decoder& decoder, const EthernetXml& ethernet, std::string_view text) {
  Sen sen, again;
  if (!decoder.decode(text, sen)) {
    VBAR_FUZZ_EXPECT(!decoder.problem().empty());
    return;
  }
  std::string encoded;
  sen.type = ethernet.sen_type;  // the answers' type is this program's
  if (!encode(sen, ethernet, encoded)) return;
  VBAR_FUZZ_EXPECT(decoder.decode(encoded, again));
  VBAR_FUZZ_EXPECT(again.ipoc == sen.ipoc && again.stop == sen.stop && same(sen.track_mm, again.track_mm));
  for (std::size_t k = 0; k < kWireAxes; ++k) VBAR_FUZZ_EXPECT(same(sen.axes_deg[k], again.axes_deg[k]));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const EthernetXml ethernet = configuration();
  static Decoder decoder(ethernet);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check_rob(decoder, ethernet, text);
  check_sen(decoder, ethernet, text);
  return 0;
}
