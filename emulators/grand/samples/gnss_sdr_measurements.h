#pragma once
// Measurements of gnss-sdr on the baseband samples of a vehicle, as the measurements of a receiver
// (../../receiver/measurements.h). In real time only; not deterministic.
//
// Ranges, phases, Doppler and C/N0 are gnss-sdr's. A subframe is accepted if it is, bit for bit, one that the satellite
// transmitted; the position is computed from both (measurements.h).

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "emulators/grand/receiver/measurements.h"
#include "emulators/grand/samples/baseband.h"
#include "emulators/grand/samples/gnss_sdr_observables.h"
#include "emulators/grand/samples/gnss_sdr_process.h"
#include "emulators/grand/samples/l1_ca_signal.h"

namespace vbar::grand::bench {

struct GnssSdrSettings {
  std::string program = "gnss-sdr";
  std::filesystem::path directory{};  ///< directory of its files
  int channels = 10;
  BasebandSettings samples{};
};

class GnssSdrMeasurements final : public Measurements {
 public:
  /// The process is started with the first block after a restart. `constellation` must not be null.
  GnssSdrMeasurements(const GnssSdrSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
                      std::uint64_t seed, const std::string& vehicle);

  void restart(StoredData stored) override;
  /// Advances by a block. Throws std::runtime_error, one sentence, if gnss-sdr cannot be started, has ended or is too
  /// slow.
  void advance(const RfBlock& block, double cn0_offset_db, const Listener& listener) override;

  [[nodiscard]] twins::gnss::oem::TimeStatus time_status() const override { return status_; }
  [[nodiscard]] fsw::GpsTime reading() const override { return reading_; }
  [[nodiscard]] std::size_t satellites() const override { return receptions_.size(); }
  [[nodiscard]] const MessageReception& reception(std::size_t satellite) const override {
    return receptions_[satellite].message;
  }
  [[nodiscard]] bool corrections_known() const override { return corrections_known_; }
  [[nodiscard]] const std::vector<std::size_t>& new_sets() const override { return new_sets_; }
  [[nodiscard]] bool new_corrections() const override { return new_corrections_; }
  void report(ReceiverReport& report) const override;

  /// Duration of the samples that gnss-sdr has not read yet, after it was given those it reads now: a program that is
  /// not bound to real time waits for it.
  [[nodiscard]] double seconds_behind();

 private:
  struct Reception {
    MessageReception message;
    std::array<std::int64_t, 3> frames{-1, -1, -1};  ///< frames of 30 s in which subframes 1 to 3 came last
  };

  void send(const RfBlock& block, double cn0_offset_db);
  void take_subframe(const ReceivedSubframe& received, fsw::GpsTime now);
  void complete_set(std::size_t index);
  void measure(const ObservableEpoch& observables, fsw::GpsTime now, const Listener& listener);
  [[nodiscard]] twins::gnss::oem::RangeRecord record_of(const ObservableEpoch::Satellite& satellite,
                                                        std::int64_t rx_time_ms) const;
  [[nodiscard]] std::optional<OwnSolution> solve(const EpochData& epoch);

  GnssSdrSettings settings_;
  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  Baseband baseband_;
  LnavBits messages_;
  std::vector<Reception> receptions_;
  std::array<std::optional<std::size_t>, kCaCodes + 1> index_of_prn_;
  std::optional<GnssSdrProcess> process_;
  std::optional<ObservableEpochs> epochs_;

  twins::gnss::oem::TimeStatus status_ = twins::gnss::oem::TimeStatus::kUnknown;
  fsw::GpsTime reading_;
  std::optional<OwnSolution> solution_;
  int tracked_ = 0;
  bool corrections_known_ = false;
  bool new_corrections_ = false;
  std::vector<std::size_t> new_sets_;
  RfBlock block_;  ///< block with the offset of C/N0
};

}  // namespace vbar::grand::bench
