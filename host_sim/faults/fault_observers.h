#pragma once
// Times during which each source aided navigation, by the events that the flight computer sent.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/receiver_decoder.h"
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

// What the bytes of one receiver show of its carriers and its clock: decoded from the packets that the flight computer
// received, without the truth and without the receiver.

/// One epoch of observations against those before it.
struct ReceiverEpoch {
  struct Slip {
    fsw::gnss::SatelliteId satellite;
    double cycles = 0.0;
  };
  fsw::GpsTime time;  ///< by the receiver's clock
  std::size_t carriers = 0;
  std::size_t known = 0;  ///< number of carriers that an earlier epoch had
  /// Number of known carriers whose lock time does not continue that of the earlier epoch.
  std::size_t restarted = 0;
  /// Median over all signals of pseudorange minus the last one continued by Doppler, over c, s. Range accelerations
  /// leave less than 1e-7 s over 10 s.
  std::optional<double> clock_jump_s;
  /// Carriers with a continuous lock time that differ by more than half a cycle from the polynomial of degree 4 through
  /// the last five epochs, the difference of the median carrier (the clock) subtracted. At 10 s the orbital motion
  /// leaves 1 mm, noise of 1.5 mm becomes 24 mm; at 60 s nothing is found.
  std::vector<Slip> slips;
};

class ReceiverObserver {
 public:
  /// The next packet with bytes of the receiver; the epochs that it completes. None of another packet.
  [[nodiscard]] std::vector<ReceiverEpoch> take(const fsw::packets::PacketView& packet);

 private:
  struct Sample {
    fsw::GpsTime time;
    double phase_m = 0.0;
  };
  using CarrierKey = std::pair<fsw::gnss::SatelliteId, fsw::gnss::Signal>;
  struct Carrier {
    fsw::GpsTime time;
    fsw::gnss::Observation last;
    std::vector<Sample> past;            ///< in one lock, the latest last
    std::optional<double> difference_m;  ///< difference of the last epoch from the polynomial
  };

  [[nodiscard]] ReceiverEpoch compare(const fsw::gnss::ObservationEpoch& epoch);
  void find_slips(ReceiverEpoch& found);

  fsw::gnss::ReceiverDecoder decoder_;
  std::map<CarrierKey, Carrier> carriers_;
  fsw::GpsTime last_;
};

}  // namespace vbar::faults
