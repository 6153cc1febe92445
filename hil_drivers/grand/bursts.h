#pragma once
// Division of a receiver's bytes into bursts: everything up to and including the TIME log of an epoch.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::grand {

/// Time in the header of a log.
struct TimeTag {
  std::uint8_t status = 0;  ///< as sent; fsw::gnss::OemTimeStatus
  fsw::GpsTime time;        ///< undefined unless the receiver has the time

  /// Returns true if the time is known to better than a microsecond.
  [[nodiscard]] bool is_fine() const;
};

struct Burst {
  std::vector<std::uint8_t> bytes;
  TimeTag tag;                  ///< tag of the epoch
  int tracked_signals = 0;      ///< observations in its RANGE log
  bool limit_exceeded = false;  ///< the receiver withholds its solution for export limits of height or velocity
};

class BurstCutter {
 public:
  /// Returns the bursts that these bytes complete.
  [[nodiscard]] std::vector<Burst> push(std::span<const std::uint8_t> bytes);

  /// Returns everything that belongs to no complete burst, as it came.
  [[nodiscard]] std::vector<std::uint8_t> take_rest() { return std::exchange(rest_, {}); }
  [[nodiscard]] std::size_t rest_size() const { return rest_.size(); }

  [[nodiscard]] const fsw::gnss::OemStreamCounters& counters() const { return stream_.counters(); }

 private:
  fsw::gnss::OemStream stream_;
  std::vector<std::uint8_t> rest_;
  Burst next_;
};

/// Adds `weeks` to the week of every log in `bytes`, and to the weeks that RAWEPHEM and GPSEPHEM repeat in their
/// bodies; the checksums are renewed. Other bytes remain.
void shift_weeks(std::span<std::uint8_t> bytes, int weeks);

}  // namespace vbar::grand
