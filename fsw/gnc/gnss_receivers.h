#pragma once
// From packets of receiver bytes and attitudes to what GNSS navigation takes: one decoder a receiver.

#include <array>
#include <cstdint>

#include "fsw/gnc/inbox.h"
#include "fsw/gnss/receiver_decoder.h"
#include "fsw/navigation/gnss_navigation.h"

namespace vbar::fsw::gnc {

class GnssReceivers {
 public:
  /// Feeds the step's packets to `navigation`. A packet with a count that its array cannot have, or an attitude that is
  /// none, is counted in the inbox and left out.
  void feed(GpsTime now, Inbox& inbox, navigation::GnssNavigation& navigation);

  /// Whole messages of both receivers, and those that were refused for their checksum or contents.
  [[nodiscard]] std::int32_t messages() const;
  [[nodiscard]] std::int32_t refused() const;

 private:
  template <class Queue>
  void decode(navigation::Receiver receiver, const Queue& packets, Inbox& inbox,
              navigation::GnssNavigation& navigation);

  std::array<gnss::ReceiverDecoder, 2> decoders_{};
};

}  // namespace vbar::fsw::gnc
