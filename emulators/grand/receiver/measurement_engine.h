#pragma once
// Receiver without its ports: channels, search, clock, messages and own solution on the radio field.

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "emulators/grand/receiver/measurements.h"
#include "emulators/grand/receiver/message_reception.h"
#include "emulators/grand/receiver/receiver_settings.h"
#include "emulators/grand/receiver/signal_channel.h"
#include "emulators/grand/receiver/signal_search.h"
#include "emulators/grand/receiver/steered_clock.h"
#include "host_sim/twins/gnss/oem_encoder.h"

namespace vbar::grand::bench {

class MeasurementEngine final : public Measurements {
 public:
  MeasurementEngine(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
                    std::uint64_t seed, std::string_view vehicle);

  /// Discards everything but what is stored.
  void restart(StoredData stored) override;

  void advance(const RfBlock& block, double cn0_offset_db, const Listener& listener) override;

  // Commands.
  void set_approximate_time(fsw::GpsTime time) override { clock_.set_approximate(time); }
  void set_approximate_position(const fsw::Vector3& position_ecef) override { approximate_position_ = position_ecef; }
  void enable_steering(bool on) override { clock_.enable_steering(on); }
  void set_smoothing(double smoothing_s) override { smoothing_s_ = smoothing_s; }
  void set_elevation_cutoff(double elevation) override { elevation_cutoff_ = elevation; }

  [[nodiscard]] const SteeredClock& clock() const { return clock_; }
  [[nodiscard]] TimeStatus time_status() const override { return clock_.status(); }
  [[nodiscard]] fsw::GpsTime reading() const override { return clock_.reading_at_end(); }
  [[nodiscard]] const std::optional<OwnSolution>& solution() const { return solution_; }

  [[nodiscard]] std::size_t satellites() const override { return receptions_.size(); }
  [[nodiscard]] const MessageReception& reception(std::size_t satellite) const override {
    return receptions_[satellite];
  }
  [[nodiscard]] bool corrections_known() const override { return corrections_known_; }
  /// Events of the last block: satellites with a new set, and whether ionosphere and UTC were received.
  [[nodiscard]] const std::vector<std::size_t>& new_sets() const override { return new_sets_; }
  [[nodiscard]] bool new_corrections() const override { return new_corrections_; }

  [[nodiscard]] const std::vector<SignalChannel>& channels() const { return channels_; }
  void report(ReceiverReport& report) const override;

 private:
  /// Channels of a satellite: the first, and the one of L2 or a second one of the same signal.
  struct Satellite {
    std::size_t first_channel = 0;
    bool has_second = false;
  };
  /// Constants of a signal in this receiver.
  struct SignalBias {
    double code_m = 0.0;
    double carrier_fraction_cycles = 0.0;
  };

  void match(const RfBlock& block);
  void stop_all();
  void begin_after_restart(fsw::GpsTime time);
  std::uint32_t wanted_updates(const Listener& listener);
  void search(fsw::GpsTime time, double cn0_offset_db);
  void start_second_signals(double cn0_offset_db);
  void advance_channels(double cn0_offset_db, std::uint32_t snapshots);
  void receive_messages(fsw::GpsTime end);
  void measure(std::size_t k, bool whole_second);
  void add_record(std::size_t channel, std::size_t k, double after_update_s);
  void solve(bool whole_second);
  void apply_elevation_cutoff();

  ReceiverSettings settings_;
  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  SteeredClock clock_;
  SignalSearch search_;
  std::vector<SignalChannel> channels_;  ///< in the order of satellite and signal, as in the radio field
  std::vector<std::size_t> satellite_of_channel_;
  std::vector<bool> bit_synchronised_;  ///< for each channel
  std::vector<Satellite> satellites_;
  std::vector<MessageReception> receptions_;
  std::array<SignalBias, twins::gnss::kSignals> biases_{};

  StoredData stored_ = StoredData::kNothing;
  bool restarted_ = true;
  std::optional<fsw::GpsTime> expected_begin_;
  std::optional<fsw::Vector3> approximate_position_;
  std::optional<OwnSolution> solution_;  ///< the last one
  int seconds_since_solution_ = 0;
  double smoothing_s_;
  double elevation_cutoff_ = -1.5707963267948966;
  bool corrections_known_ = false;
  bool new_corrections_ = false;
  std::vector<std::size_t> new_sets_;
  std::int64_t last_epoch_ = -1;

  // Data of the block.
  std::vector<const RfSignal*> rf_;        ///< signal of each channel, or null
  std::vector<const RfSignal*> rf_first_;  ///< signal of each satellite's first channel
  std::vector<bool> tracked_;              ///< each satellite
  std::vector<std::size_t> found_;
  double setting_m_ = 0.0;
  std::array<double, twins::gnss::kSignals> setting_cycles_{};
  EpochData epoch_;
  std::vector<std::size_t> epoch_satellites_;  ///< satellite of each record
  std::vector<SolutionInput> solution_input_;
};

}  // namespace vbar::grand::bench
