#pragma once
// A NovAtel OEM628 on a spacecraft, as bytes: GPS L1/L2, Galileo E1, BeiDou B1I.
//
// Observables, in metres (code P, carrier L; r receiver, s satellite, f signal):
//   P = range + Shapiro + c (dt_r - dt_s + TGD_f) + I_f + b_rf + m_rsf + noise
//   L = range + Shapiro + c (dt_r - dt_s)         - I_f + lambda_f (N_rsf + beta_rf) + w_rsf + noise
// at the instant at which its own clock shows the epoch. N is an integer, beta a fraction of a cycle that all carriers
// of one signal share in one receiver: double differences within a signal hold integers. w is the carrier wander, a
// first-order Gauss-Markov process of each receiver, satellite and signal. Half-cycle ambiguities do not occur. Phase
// wind-up is neglected: it is the same in antennas of parallel attitude, which the missions fly (each 20 arcsec of
// relative yaw would make 3e-6 m). m is the code wander, multipath for example: a process like w whose sigma depends on
// the elevation; by default there is none, as in the paper's table. Noise of two epochs is independent: right for
// periods above the code loop's 2 s, while at 1 Hz real code noise would be correlated.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/oem_encoder.h"
#include "host_sim/twins/gnss/point_solution.h"
#include "host_sim/twins/gnss/receiver_bytes.h"
#include "host_sim/twins/gnss/signal_path.h"
#include "host_sim/twins/gnss/tracking.h"

namespace vbar::twins::gnss {

/// The truth of one observation, for tests and report.
struct ObservationTruth {
  SatelliteId satellite;
  Signal signal = Signal::kGpsL1;
  double range_m = 0.0;       ///< geometric, from the true antenna
  double code_m = 0.0;        ///< P without noise
  double carrier_m = 0.0;     ///< L without noise, N and beta
  double ionosphere_m = 0.0;  ///< I of this signal
  double elevation = 0.0;     ///< above the local horizontal, rad
  std::int64_t ambiguity_cycles = 0;
  double carrier_fraction_cycles = 0.0;  ///< beta
  double carrier_wander_m = 0.0;         ///< w
  double code_wander_m = 0.0;            ///< m
  int slips = 0;
};

/// The truth of the receiver's last epoch.
struct ReceiverTruth {
  double clock_offset_s = 0.0;
  double clock_drift = 0.0;
  int clock_jumps = 0;
  int visible_satellites = 0;
  fsw::Vector3 antenna_from_com_body_m = fsw::Vector3::Zero();  ///< noise of the epoch included
  fsw::Vector3 antenna_ecef = fsw::Vector3::Zero();             ///< at reception
  std::vector<ObservationTruth> observations;                   ///< in the order of observations()
};

class GnssReceiver final : public ReceiverBytes {
 public:
  /// Makes a receiver. `name` is the spacecraft's (with the receiver's number, if it has several): it names all random
  /// streams, so that neither another receiver nor another setting changes this one's draws. `constellation` must not
  /// be null and may be shared. Throws std::invalid_argument for settings, std::runtime_error for the data directory's
  /// antenna pattern.
  GnssReceiver(const GnssReceiverSettings& settings, std::shared_ptr<const Constellation> constellation,
               const std::filesystem::path& data_directory, std::uint64_t seed, const std::string& name);

  /// Measures one epoch: returns the logs that the receiver sends, in the order RANGE, ephemerides, IONUTC, BESTXYZ,
  /// TIME. The first call switches it on. Throws std::invalid_argument for a time that is not later than the last or
  /// not a whole millisecond, and for a truth that is not finite or not near the Earth.
  std::vector<std::uint8_t> bytes_at(const BodyTruth& truth);
  ReceiverOutput output_at(const BodyTruth& truth) override { return {bytes_at(truth)}; }

  /// Lets a carrier slip by whole cycles at the next epoch, if it is tracked then.
  void command_slip(SatelliteId satellite, Signal signal, std::int64_t cycles, bool seen);

  /// Upsets the receiver at the next epoch. A slip that is not detected, of all carriers of the satellites concerned;
  /// false while none of them is tracked. A reset begins as the first epoch did, except that it draws another clock and
  /// other ambiguities.
  bool upset(const Upset& upset) override;

  /// Returns the last epoch's observations and the truth about them.
  [[nodiscard]] const std::vector<oem::RangeRecord>& observations() const { return observations_; }
  [[nodiscard]] const ReceiverTruth& truth() const { return truth_; }
  [[nodiscard]] const BodyFrameErrors& body_frame() const { return body_errors_; }
  [[nodiscard]] const GnssReceiverSettings& settings() const { return settings_; }

 private:
  // Content of one satellite's messages, and the time when it was last sent.
  struct MessageState {
    bool received = false;
    BroadcastSet set;
    fsw::GpsTime logged_at;
    bool logged = false;
  };
  // Constants of a signal in this receiver.
  struct SignalBias {
    double code_m = 0.0;
    double carrier_fraction_cycles = 0.0;
  };

  // How one signal arrives.
  struct Reception {
    const SignalPath& path;
    double ionosphere_l1_m, elevation, code_cn0_dbhz;
  };

  void advance(const BodyTruth& truth);
  void restart();
  bool slip_satellites(const std::string& satellite, std::int64_t cycles);
  AntennaState antenna_state(const BodyTruth& truth);
  void observe(const AntennaState& antenna, fsw::GpsTime now);
  void observe_satellite(const AntennaState& antenna, fsw::GpsTime now, std::size_t index);
  void observe_signal(SignalTrack& track, const Reception& reception, fsw::GpsTime now, std::size_t index);
  void hear_messages(fsw::GpsTime now);
  [[nodiscard]] std::optional<PointSolution> point_solution(const AntennaState& antenna) const;
  [[nodiscard]] oem::TimeStatus time_status(fsw::GpsTime now, bool solved) const;
  void append_ephemerides(oem::Bytes& bytes, const oem::Header& header);
  void append_solution(oem::Bytes& bytes, const oem::Header& header, const AntennaState& antenna,
                       const std::optional<PointSolution>& solution, const UtcOffset& utc) const;

  GnssReceiverSettings settings_;
  std::uint64_t seed_;
  std::string name_;
  std::shared_ptr<const Constellation> constellation_;
  AntennaPattern pattern_;
  BodyFrameErrors body_errors_;
  engine::RandomStream antenna_noise_;
  ReceiverClock clock_;
  std::vector<SatelliteTracking> tracking_;  ///< by the constellation's index, as the following
  std::vector<MessageState> messages_;
  std::array<SignalBias, kSignals> biases_{};

  bool must_restart_ = false;
  int restarts_ = 0;
  double clock_step_s_ = 0.0;  ///< at the next epoch

  bool on_ = false;
  fsw::GpsTime switched_on_;
  fsw::GpsTime last_epoch_;
  bool corrections_logged_ = false;
  fsw::GpsTime corrections_logged_at_;
  std::vector<oem::RangeRecord> observations_;
  std::vector<std::size_t> observed_satellites_;  ///< the constellation's index of each observation
  ReceiverTruth truth_;
};

}  // namespace vbar::twins::gnss
