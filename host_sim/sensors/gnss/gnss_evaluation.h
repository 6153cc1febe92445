#pragma once
// Evaluation of a run with GNSS: telemetry as rows, and the noise of both receivers' measurements against the truth.

#include <deque>
#include <memory>
#include <optional>

#include "fsw/gnss/differential.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/gnss_front_end.h"
#include "fsw/gnss/receiver_decoder.h"
#include "fsw/measurements/pointing.h"
#include "fsw/packets/messages.h"
#include "host_sim/sensors/gnss/difference_noise.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

class GnssEvaluation final : public Evaluation {
 public:
  explicit GnssEvaluation(const EvaluationContext& context) : context_(context) {}

  /// Decodes the bytes that the flight software receives, by the same decoders.
  void on_inputs(fsw::GpsTime time, std::span<const twins::Packet> inputs) override;
  void on_answer(fsw::GpsTime time, std::span<const fsw::packets::PacketView> answer) override;
  void finish() override;

 private:
  static constexpr std::size_t kServicer = 0, kTarget = 1;

  /// Both receivers' epoch of one tag, without the truth yet.
  struct Pair {
    fsw::gnss::DifferentialEpoch differences;
    fsw::Vector3 servicer_eci = fsw::Vector3::Zero();  ///< antenna
    fsw::Vector3 lever_arms_eci = fsw::Vector3::Zero();
    double target_later_s = 0.0;  ///< its instant of measurement against the servicer's
  };
  struct Relative {
    fsw::Vector3 position_eci, target_velocity_eci;
  };

  void take(const fsw::packets::PacketView& packet);
  template <class Message>
  void take_bytes(std::size_t receiver, const Message& message);
  template <class Message>
  void take_attitude(std::size_t receiver, fsw::GpsTime time, const Message& message);
  void match_epochs();
  void add_pair(const fsw::gnss::ObservationEpoch& ours, const fsw::gnss::ObservationEpoch& theirs);
  void compare_with_truth();
  [[nodiscard]] std::optional<Relative> relative_at(double time_s) const;
  [[nodiscard]] double seconds_of(fsw::GpsTime time) const { return fsw::seconds(time - context_.mission.epoch); }

  EvaluationContext context_;
  // As telecommanded.
  std::optional<vbar::earth_configuration> earth_;
  std::optional<vbar::receiver_configuration> receiver_;
  std::optional<vbar::carrier_configuration> carrier_;
  std::array<fsw::gnss::ReceiverDecoder, 2> decoders_{};
  fsw::gnss::EphemerisStore ephemerides_;
  std::array<fsw::gnss::EpochBuffer, 2> waiting_{};
  std::array<fsw::measurements::AttitudeHistory, 2> attitudes_{};
  std::deque<Pair> pairs_;
  DifferenceNoise noise_;
};

}  // namespace vbar::sensors
