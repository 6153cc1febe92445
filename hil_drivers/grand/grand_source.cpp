#include "hil_drivers/grand/grand_source.h"

#include <utility>

#include "hil_drivers/grand/grand_bench.h"

namespace vbar::grand {

GrandSource::GrandSource(std::shared_ptr<GrandBench> bench, std::size_t vehicle)
    : bench_(std::move(bench)), vehicle_(vehicle) {}

void GrandSource::start(fsw::GpsTime first_epoch) {
  bench_->start(first_epoch);
}

void GrandSource::stop(twins::StopReason /*reason*/) {
  bench_->stop();
}

std::optional<fsw::Duration> GrandSource::call_period() const {
  return bench_->sample_period();
}

std::optional<io::WiredReceiver> GrandSource::wired_receiver() const {
  return bench_->wired_receiver(vehicle_);
}

twins::gnss::ReceiverOutput GrandSource::output_at(const twins::gnss::BodyTruth& truth) {
  return bench_->exchange(vehicle_, truth);
}

}  // namespace vbar::grand
