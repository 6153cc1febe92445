#include "fsw/sources/gnss/receiver_decoders.h"

namespace vbar::fsw::sources {

std::int32_t ReceiverDecoders::messages() const {
  std::uint32_t sum = 0;
  for (const auto& decoder : decoders_) sum += decoder.stream().counters().messages;
  return static_cast<std::int32_t>(sum & 0x7FFF'FFFFU);
}

std::int32_t ReceiverDecoders::refused() const {
  std::uint32_t sum = 0;
  for (const auto& decoder : decoders_) sum += decoder.stream().counters().bad_checksum + decoder.counters().refused;
  return static_cast<std::int32_t>(sum & 0x7FFF'FFFFU);
}

}  // namespace vbar::fsw::sources
