#pragma once
// From packets of receiver bytes and attitudes to the inputs of GNSS navigation: one decoder per receiver.

#include <array>
#include <cstdint>

#include "fsw/gnc/inbox.h"
#include "fsw/gnss/receiver_decoder.h"
#include "fsw/navigation/gnss_navigation.h"

namespace vbar::fsw::gnc {

class GnssReceivers {
 public:
  /// Passes the packets of the step to `navigation`. A packet with a count beyond its array, or an invalid attitude,
  /// is counted in the inbox and skipped.
  void feed(GpsTime now, Inbox& inbox, navigation::GnssNavigation& navigation);

  /// Complete messages of both receivers, and those refused because of checksum or contents.
  [[nodiscard]] std::int32_t messages() const;
  [[nodiscard]] std::int32_t refused() const;

 private:
  template <class Queue>
  void decode(navigation::Receiver receiver, const Queue& packets, Inbox& inbox,
              navigation::GnssNavigation& navigation);

  std::array<gnss::ReceiverDecoder, 2> decoders_{};
};

}  // namespace vbar::fsw::gnc
