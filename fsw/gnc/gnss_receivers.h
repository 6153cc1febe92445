#pragma once
// From packets of receiver bytes and attitudes to the inputs of GNSS navigation: one decoder per receiver.

#include <cstdint>

#include "fsw/gnc/inbox.h"
#include "fsw/navigation/gnss_navigation.h"
#include "fsw/sources/gnss/receiver_decoders.h"

namespace vbar::fsw::gnc {

class GnssReceivers {
 public:
  /// Passes the packets of the step to `navigation`. A packet with a count beyond its array, or an invalid attitude,
  /// is counted in the inbox and skipped.
  void feed(GpsTime now, Inbox& inbox, navigation::GnssNavigation& navigation);

  [[nodiscard]] std::int32_t messages() const { return decoders_.messages(); }
  [[nodiscard]] std::int32_t refused() const { return decoders_.refused(); }

 private:
  sources::ReceiverDecoders decoders_;
};

}  // namespace vbar::fsw::gnc
