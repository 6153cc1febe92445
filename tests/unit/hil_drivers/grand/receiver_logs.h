#pragma once
// Logs of a receiver for the tests, by the encoder of the digital twin.

#include "host_sim/twins/gnss/oem_encoder.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand {

namespace oem = twins::gnss::oem;

/// RANGE with `signals` observations, BESTXYZ and TIME of one epoch.
inline oem::Bytes burst_of(fsw::GpsTime epoch, oem::TimeStatus status = oem::TimeStatus::kFine, int signals = 3) {
  const oem::Header header{epoch, status, true};
  oem::Bytes bytes;
  oem::append_range(bytes, header, std::vector<oem::RangeRecord>(static_cast<std::size_t>(signals)));
  oem::append_bestxyz(bytes, header, {});
  oem::append_time(bytes, header, {}, {});
  return bytes;
}

}  // namespace vbar::grand
