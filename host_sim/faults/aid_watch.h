#pragma once
// Times during which each source aided navigation, by the events that the flight computer sent.

#include <cstdint>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/packet.h"

namespace vbar::faults {

class AidWatch {
 public:
  /// One packet of the flight computer's answer to the step at `time`. A restarted computer aids with nothing.
  void take(fsw::GpsTime time, const fsw::packets::PacketView& packet);

  /// Returns the sources that aided immediately before `time`: a sum of navigation_configuration::kUse.
  [[nodiscard]] std::int32_t before(fsw::GpsTime time) const;
  /// The first time from `from` on at which all of `sources` aid; empty if there is none.
  [[nodiscard]] std::optional<fsw::GpsTime> first_with(std::int32_t sources, fsw::GpsTime from) const;

 private:
  struct Change {
    fsw::GpsTime time;
    std::int32_t aiding = 0;  ///< from then on
  };
  void change(fsw::GpsTime time, std::int32_t aiding);

  std::vector<Change> changes_;
  bool has_stepped_ = false;
  fsw::GpsTime reported_at_;   ///< step of the last event,
  std::int32_t reported_ = 0;  ///< and sources with an event in that step
};

}  // namespace vbar::faults
