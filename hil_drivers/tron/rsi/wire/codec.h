#pragma once
// Codec of RSI documents. Encoding is strict: values in the order of the configuration, IPOC last, no blank before
// "/>", four decimals. Decoding accepts any order, both forms of an empty element, Type and TYPE, additional flat
// elements and any decimal notation; it rejects document types, entities, nested or repeated elements, numbers that are
// not finite, and oversize.

#include <memory>
#include <string>
#include <string_view>

#include "hil_drivers/tron/rsi/wire/ethernet_xml.h"
#include "hil_drivers/tron/rsi/wire/messages.h"

namespace vbar::tron::rsi {

/// Replaces `datagram` by the document. `precision`: decimals, 0 to 9. Returns false if a value is not finite or beyond
/// 1e9.
[[nodiscard]] bool encode(const Rob& rob, const EthernetXml& ethernet, int precision, std::string& datagram);
/// Replaces `datagram`; values that `sen` leaves out are not written. Returns false as above, or if kMaxAnswerBytes is
/// exceeded.
[[nodiscard]] bool encode(const Sen& sen, const EthernetXml& ethernet, std::string& datagram);

/// Decodes one document after the other without throwing; memory is reused.
class Decoder {
 public:
  /// Copies `ethernet`.
  explicit Decoder(const EthernetXml& ethernet);
  ~Decoder();
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  /// Returns false if the document is rejected: problem() is one sentence, and the output is unspecified.
  [[nodiscard]] bool decode(std::string_view datagram, Rob& rob);
  [[nodiscard]] bool decode(std::string_view datagram, Sen& sen);
  [[nodiscard]] const std::string& problem() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace vbar::tron::rsi
