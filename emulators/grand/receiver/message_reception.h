#pragma once
// Navigation messages as a receiver obtains them: bit by bit. A part (a subframe, a page) has been received when the
// channel was in lock from its first bit to its last and the sign of the bits is known; a set of ephemerides is
// complete with all its parts of one issue. There is no timer.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

/// Positions of the parts that a receiver needs, in seconds of the message's cycle; cycles begin with the system's
/// week.
struct MessageLayout {
  struct Part {
    double begin_s;
    double length_s;
  };
  double cycle_s;
  std::vector<Part> ephemeris;
  Part sync;  ///< first occurrence of the pattern that gives the sign of the bits
  double sync_period_s;
  Part time_of_week;  ///< first occurrence
  double time_of_week_period_s;
};

/// Returns the layout of the satellite's message: GPS LNAV (IS-GPS-200N, 20.3.3: subframes 1 to 3 of 6 s), Galileo
/// I/NAV on E1-B (OS SIS ICD 2.1, table 36: words 2, 4, 1, 3, 5 of 2 s), BeiDou D1 (BDS-SIS-ICD-B1I-3.0, 5.2.1:
/// subframes 1 to 3 of 6 s) and D2 (5.3.1: ten pages of subframe 1, 0.6 s every 3 s).
const MessageLayout& message_layout(twins::gnss::SatelliteId satellite);

/// Reception from one satellite.
class MessageReception {
 public:
  explicit MessageReception(twins::gnss::SatelliteId satellite);

  /// Parts received by the last call of receive().
  struct News {
    bool sign_of_bits = false;  ///< the sync pattern was received: the channel's half cycle is known
    bool time_of_week = false;
    bool ephemeris = false;    ///< a new set
    bool corrections = false;  ///< ionosphere and UTC (GPS subframe 4, page 18)
  };
  /// Receives the bits transmitted until `transmitted` (system independent, GPS time). `locked`: in phase lock and bit
  /// synchronisation since the last call. `index` is the satellite's in the constellation.
  News receive(fsw::GpsTime transmitted, bool locked, const twins::gnss::Constellation& constellation,
               std::size_t index);

  /// Restarts the reception after the channel was found to have slipped by half cycles: the present part is invalid.
  void restart() { heard_since_.reset(); }

  [[nodiscard]] const std::optional<twins::gnss::BroadcastSet>& set() const { return set_; }
  /// Time at which the first part of the set was transmitted.
  [[nodiscard]] fsw::GpsTime set_transmitted() const { return set_transmitted_; }
  void keep(const twins::gnss::BroadcastSet& set, fsw::GpsTime transmitted);
  void forget();

 private:
  struct Heard {
    fsw::GpsTime begin;  ///< begin of the last complete reception
    fsw::GpsTime toe;    ///< toe of its set
    bool valid = false;
  };
  /// Returns the begin of the last occurrence that ended by `transmitted` and began in lock; empty if there is none.
  [[nodiscard]] std::optional<fsw::GpsTime> last_heard(double begin_s, double length_s, double period_s,
                                                       fsw::GpsTime transmitted) const;
  bool complete_set(const twins::gnss::Constellation& constellation, std::size_t index);

  twins::gnss::SatelliteId satellite_;
  const MessageLayout* layout_;
  std::optional<fsw::GpsTime> heard_since_;
  fsw::GpsTime last_sync_, last_time_of_week_, last_corrections_;
  std::vector<Heard> parts_;
  std::optional<twins::gnss::BroadcastSet> set_;
  fsw::GpsTime set_transmitted_;
};

}  // namespace vbar::grand::bench
