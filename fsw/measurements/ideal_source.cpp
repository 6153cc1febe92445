#include "fsw/measurements/ideal_source.h"

#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::measurements {

using messaging::vector;

void IdealSource::collect(Context& context, RecordFiler records) {
  const auto& measurements = context.inbox.queue<vbar::ideal_navigation>();
  for (std::size_t k = 0; k < measurements.size(); ++k) {
    const GpsTime time = measurements[k].tag.time;
    if (time > context.now) {
      context.inbox.count_unusable_time();
      continue;
    }
    const ideal_navigation& measured = measurements[k].value;
    const States states{.servicer = {.position_eci = vector(measured.servicer_position_eci),
                                     .velocity_eci = vector(measured.servicer_velocity_eci)},
                        .target = {.position_eci = vector(measured.target_position_eci),
                                   .velocity_eci = vector(measured.target_velocity_eci)}};
    // A state outside the domain of the orbit models is invalid: wait for the next one.
    if (!orbit::qns_from_cartesian(states.servicer).ok() || !orbit::qns_from_cartesian(states.target).ok()) {
      context.inbox.count_bad_content();
      continue;
    }
    if (records.file(time, filed_) != Status::kOk) continue;
    waiting_[filed_ % waiting_.size()] = states;
    ++filed_;
  }
}

void IdealSource::process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter) {
  if (filed_ - record.number > waiting_.size()) return context.inbox.count_unusable_time();
  const States& states = waiting_[record.number % waiting_.size()];
  filter.set_states(states.servicer, states.target);
  last_measurement_ = record.time;
  aid_.go_to(AidState::kAiding, record.time);
}

}  // namespace vbar::fsw::measurements
