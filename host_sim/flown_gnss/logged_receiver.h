#pragma once
// The receiver of a run by its packet log: what the flight software got from an emulated testbed, for example.

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::flown_gnss {

class LoggedReceiver final : public twins::gnss::ReceiverBytes {
 public:
  /// Reads the receiver's bytes of spacecraft `number` (in packet headers) from a packet log. `period`: between calls
  /// of output_at(). Throws as twins::read_packet_log(), and std::runtime_error for a log without such bytes.
  LoggedReceiver(const std::filesystem::path& log, std::uint8_t number, fsw::Duration period);

  /// Returns all bytes that were delivered from this call until the next one: a device delivers after its epoch.
  twins::gnss::ReceiverOutput output_at(const twins::gnss::BodyTruth& truth) override;

 private:
  fsw::Duration period_;
  std::map<fsw::GpsTime, std::vector<std::uint8_t>> bytes_;  ///< by the time of their delivery
};

}  // namespace vbar::flown_gnss
