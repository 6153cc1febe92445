#include "fsw/sources/range_finder/range_source.h"

#include "fsw/sources/valid_range.h"

namespace vbar::fsw::sources {

static_assert(static_cast<int>(RangeEditStatus::kUsed) == telemetry_range::kEditUsed);

bool is_valid(const range_configuration& c) {
  return is_positive(c.noise_sigma_m, 1e3) && is_between(c.bias_sigma_m, 0.0, 1e3);
}

bool RangeSource::configure(const Configuration& configuration) {
  const auto* ranges = configuration.telecommands.in_force<range_configuration>();
  if (ranges == nullptr) return false;
  aiding_.configure({.noise_sigma_m = ranges->noise_sigma_m, .bias_sigma_m = ranges->bias_sigma_m});
  return true;
}

void RangeSource::collect(Context& context, RecordFiler records) {
  processed_.reset();
  const auto& packets = context.inbox.queue<range_measurement>();
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const GpsTime time = packets[k].tag.time;
    const double range_m = packets[k].value.range_m;
    if (!(range_m > 0.0)) {
      context.inbox.count_bad_content();
    } else if (time > context.now || context.now - time > kLongestDelay ||
               records.file(time, next_number_) != Status::kOk) {
      context.inbox.count_unusable_time();
    } else {
      ranges_m_[next_number_ % kMaxWaiting] = range_m;
      ++next_number_;
    }
  }
}

void RangeSource::process_record(const Record& record, Context& /*context*/, filter::RelativeNavigationFilter& filter) {
  processed_ = record.time;
  range_m_ = ranges_m_[record.number % kMaxWaiting];
  edit_status_ = aiding_.process(range_m_, filter);
}

void RangeSource::report(const Telemetry& telemetry) const {
  if (!processed_) return;
  constexpr int kBias = filter::kAt<RangeBias>;
  telemetry_range message{};
  message.step = telemetry.step;
  message.range_m = range_m_;
  message.fate = static_cast<std::int8_t>(edit_status_);
  message.prefit_m = aiding_.prefit_m();
  message.nis = aiding_.nis();
  message.bias_m = telemetry.filter.estimate().mean(kBias);
  message.bias_sigma_m = math::sqrt(telemetry.filter.estimate().variance(kBias));
  message.used = aiding_.counters().used;
  message.refused = aiding_.counters().rejected;
  telemetry.outbox.send(*processed_, message);
}

}  // namespace vbar::fsw::sources
