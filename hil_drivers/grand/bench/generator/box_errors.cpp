#include "hil_drivers/grand/bench/generator/box_errors.h"

#include <cmath>
#include <string>

#include "hil_drivers/grand/bench/rf_block.h"

namespace vbar::grand::bench {
namespace {

std::string stream_name(std::string_view vehicle, twins::gnss::SatelliteId satellite, twins::gnss::Signal signal,
                        std::string_view quantity) {
  std::string name = "grand/box/";
  name.append(vehicle).append("/").append(name_of(satellite)).append("/");
  return name.append(structure(signal).name).append("/").append(quantity);
}

}  // namespace

ChannelErrors::ChannelErrors(const BoxErrorSettings& settings, std::uint64_t seed, std::string_view vehicle,
                             twins::gnss::SatelliteId satellite, twins::gnss::Signal signal)
    : sigma_m_(settings.channel_phase_mm * 1e-3),
      blocks_per_time_constant_(settings.channel_phase_time_s / seconds(RfBlock::kLength)),
      decay_(std::exp(-1.0 / blocks_per_time_constant_)),
      stream_(seed, stream_name(vehicle, satellite, signal, "channel_phase")) {
  engine::RandomStream alignment(seed, stream_name(vehicle, satellite, signal, "alignment"));
  carrier_alignment_m_ = alignment.normal() * settings.carrier_alignment_mm * 1e-3;
  code_alignment_m_ = alignment.normal() * settings.code_alignment_mm * 1e-3;
}

ChannelErrors::Wander ChannelErrors::wander(std::int64_t number) {
  if (sigma_m_ == 0.0) return {};
  step_to(number);
  const double begin_m = phase_m_;
  step_to(number + 1);
  return {begin_m, phase_m_};
}

void ChannelErrors::step_to(std::int64_t node) {
  if (!started_) {
    started_ = true;
    node_ = node;
    phase_m_ = sigma_m_ * stream_.normal();
    return;
  }
  const std::int64_t steps = node - node_;
  if (steps <= 0) return;
  const double decay = steps == 1 ? decay_ : std::exp(-static_cast<double>(steps) / blocks_per_time_constant_);
  phase_m_ = decay * phase_m_ + sigma_m_ * std::sqrt(1.0 - decay * decay) * stream_.normal();
  node_ = node;
}

}  // namespace vbar::grand::bench
