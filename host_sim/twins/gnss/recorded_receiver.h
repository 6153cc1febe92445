#pragma once
// A recorded GPS receiver in the place of the twin: the epochs of an observation file as the logs that an OEM receiver
// would have sent, with the broadcast sets of a navigation file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/observation_files/rinex_observations.h"
#include "host_sim/twins/gnss/gnss_settings.h"
#include "host_sim/twins/gnss/oem_encoder.h"
#include "host_sim/twins/gnss/receiver_bytes.h"

namespace vbar::twins::gnss {

/// Observation types of one signal: code, carrier phase, signal strength.
struct SignalTypes {
  std::string code, phase, strength;
};

struct RecordingSettings {
  std::filesystem::path observations;  ///< RINEX or compact RINEX, gzip allowed
  std::filesystem::path navigation;    ///< RINEX navigation file: of the day, or of vbar_fit_ephemerides
  /// Types of L1; empty: C1, L1, S1 in version 2, C1C, L1C, S1C from version 3 on.
  std::optional<SignalTypes> l1;
  /// Types of L2; empty: P2, L2, S2 in version 2, C2W, L2W, S2W from version 3 on.
  std::optional<SignalTypes> l2;
  bool uses_l2 = true;  ///< false: a receiver of one frequency
  /// The code of L1 is corrected for the group delay and the ionosphere above the receiver by what the satellites
  /// broadcast, as receivers of one frequency do for their own solution: the flight software does neither.
  bool corrects_code = false;
  bool strength_is_amplitude = false;  ///< ratio of amplitudes in 1 Hz, not dB-Hz
  /// Noise that the logs state for an observation: the loops' formulas with its C/N0.
  TrackingSettings tracking;
  double ephemeris_period_s = 300.0;  ///< each set again; new ones at once
};

/// What the logs hold and what they do not.
struct RecordingCounts {
  std::size_t epochs = 0;          ///< sent
  std::size_t epochs_between = 0;  ///< recorded between two calls
  std::size_t epochs_untimed = 0;  ///< recorded at a time that is not a whole millisecond, which the logs cannot hold
  std::size_t gaps = 0;            ///< calls without a recorded epoch, one for each row of them
  std::size_t missing = 0;         ///< calls without a recorded epoch
  std::size_t observations = 0;    ///< records in the logs
  std::size_t without_code = 0;    ///< satellites of an epoch without the code of L1
  std::size_t acquisitions = 0;    ///< carriers that begin, or begin again after a gap
  std::size_t losses_of_lock = 0;  ///< carriers whose loss of lock the receiver noted while it tracked them
  std::map<char, std::size_t> other_systems;  ///< satellites of an epoch that are not of GPS
};

class RecordedReceiver final : public ReceiverBytes {
 public:
  /// Reads both files; paths that are not absolute are from `data_directory`. Throws std::runtime_error, one sentence
  /// that names the file.
  RecordedReceiver(const RecordingSettings& settings, const std::filesystem::path& data_directory);

  /// Returns the logs of the epoch recorded at the time of `truth`, RANGE and the sets that are due; no bytes where
  /// none was. Throws files::FormatError for a damaged epoch.
  ReceiverOutput output_at(const BodyTruth& truth) override;

  [[nodiscard]] std::vector<Note> statistics() const override;
  [[nodiscard]] const RecordingCounts& counts() const { return counts_; }
  [[nodiscard]] const observation_files::ObservationCounts& file_counts() const { return reader_->counts(); }
  /// Returns the notes on the content of the navigation file that is not used.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// Returns the time of the first recorded epoch.
  [[nodiscard]] fsw::GpsTime first_epoch() const { return first_epoch_; }

 private:
  /// A carrier that is tracked.
  struct Carrier {
    fsw::GpsTime lock_since, last;
    double phase_cycles = 0.0;
  };
  /// The sets of a satellite in order of reference time, and what was sent of them.
  struct Sets {
    std::vector<Ephemeris> sets;
    std::optional<std::size_t> sent;
    fsw::GpsTime sent_at;
  };

  [[nodiscard]] SignalTypes types_of(Signal signal, int version) const;
  void append_signal(const observation_files::RecordedEpoch& epoch,
                     const observation_files::SatelliteObservations& satellite, Signal signal,
                     std::vector<oem::RangeRecord>& records);
  [[nodiscard]] const Ephemeris* set_of(int number, fsw::GpsTime time) const;
  [[nodiscard]] double code_correction_m(int number, const BodyTruth& body) const;
  void append_ephemerides(const observation_files::RecordedEpoch& epoch, oem::Bytes& bytes, const oem::Header& header);
  void go_to(fsw::GpsTime time);

  RecordingSettings settings_;
  std::string text_;
  std::unique_ptr<observation_files::ObservationReader> reader_;
  std::optional<observation_files::RecordedEpoch> next_;
  fsw::GpsTime first_epoch_;
  fsw::Duration longest_step_{};  ///< a longer one between two epochs ends the count of a carrier
  std::map<int, Sets> sets_;
  KlobucharCoefficients ionosphere_;
  std::vector<std::string> notes_;
  std::map<std::pair<int, Signal>, Carrier> carriers_;
  bool is_in_gap_ = false;
  RecordingCounts counts_;
};

}  // namespace vbar::twins::gnss
