#include <algorithm>
#include <deque>

#include "fsw/math/math.h"
#include "fsw/packets/messages.h"
#include "host_sim/sensors/range_finder/range_finder_kind.h"

namespace vbar::sensors {
namespace {

/// A measurement that has not reached the flight software after this time is taken to be lost.
constexpr fsw::Duration kLongestDelay = fsw::duration_of_seconds(60);

class RangeEvaluation final : public Evaluation {
 public:
  RangeEvaluation(const mission::Sensor& sensor, const EvaluationContext& context)
      : context_(context),
        own_(settings_of<RangeFinderSensor>(sensor)),
        name_(sensor.name),
        unit_(unit_of(sensor, context.servicer)) {}

  void on_measured(const twins::TruthSnapshot& truth) override {
    const RangeFinderSettings& settings = own_.range_finder;
    RangeRow row = row_at(truth.time);
    const auto sight = line_of_sight(truth, context_.servicer.name, own_.target, settings.boresight_body);
    if (sight) {
      row.true_m = sight->range_m;
      row.off_boresight_deg = sight->off_boresight_rad * 180.0 / fsw::math::kPi;
      row.in_field_of_view = sight->off_boresight_rad <= settings.half_angle_rad;
    }
    pending_.push_back({truth.time, row});
  }

  void on_inputs(fsw::GpsTime time, std::span<const twins::Packet> inputs) override {
    for (const twins::Packet& bytes : inputs) {
      const auto packet = fsw::packets::parse_packet(bytes);
      if (!packet.ok() || packet.value().header.unit != unit_) continue;
      if (const auto message = fsw::packets::decode<range_measurement>(packet.value()); message.ok())
        take(packet.value().header.time, message.value().range_m);
    }
    while (!pending_.empty() && (pending_.front().row.measured_m || pending_.front().time + kLongestDelay < time))
      release();
  }

  void finish() override {
    while (!pending_.empty()) release();
  }

 private:
  struct Pending {
    fsw::GpsTime time;
    RangeRow row;
  };

  [[nodiscard]] RangeRow row_at(fsw::GpsTime time) const {
    RangeRow row;
    row.time_s = fsw::seconds(time - context_.mission.epoch);
    row.sensor = name_;
    row.sigma_m = std::hypot(own_.range_finder.bias_sigma_m, own_.range_finder.noise_sigma_m);
    return row;
  }

  void take(fsw::GpsTime time, double measured_m) {
    auto found = std::ranges::find(pending_, time, &Pending::time);
    if (found == pending_.end()) found = pending_.insert(pending_.end(), {time, row_at(time)});
    found->row.measured_m = measured_m;
    if (found->row.true_m) found->row.error_m = measured_m - *found->row.true_m;
  }

  void release() {
    context_.record.tables.rows<RangeRow>().push_back(pending_.front().row);
    pending_.pop_front();
  }

  EvaluationContext context_;
  const RangeFinderSensor& own_;
  std::string name_;
  std::uint8_t unit_;
  std::deque<Pending> pending_;  ///< in order of time
};

}  // namespace

std::unique_ptr<Evaluation> evaluate_ranges(const mission::Sensor& sensor, const EvaluationContext& context) {
  return std::make_unique<RangeEvaluation>(sensor, context);
}

}  // namespace vbar::sensors
