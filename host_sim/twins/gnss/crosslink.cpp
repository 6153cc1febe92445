#include "host_sim/twins/gnss/crosslink.h"

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace vbar::twins::gnss {
namespace {

const CrosslinkSettings& checked(const CrosslinkSettings& settings) {
  check(settings);
  return settings;
}

}  // namespace

void check(const CrosslinkSettings& settings) {
  const double loss = settings.link.loss_probability;
  if (!(loss >= 0.0 && loss <= 1.0))
    throw std::invalid_argument(fmt::format("loss_probability = {}: accepted is 0 to 1", loss));
  if (engine::check_link_settings(settings.link) != fsw::Status::kOk)
    throw std::invalid_argument(
        fmt::format("latency mean {} s, standard deviation {} s, from {} to {} s is not a valid distribution: "
                    "accepted are finite, ordered, positive times up to 9e8 s",
                    settings.link.latency.mean_s, settings.link.latency.standard_deviation_s,
                    settings.link.latency.minimum_s, settings.link.latency.maximum_s));
  for (const auto& [name, value] : {std::pair{"silence_begin_s", settings.silence_begin_s},
                                    std::pair{"silence_duration_s", settings.silence_duration_s}})
    if (!(value >= 0.0 && value <= 1e9))
      throw std::invalid_argument(fmt::format("{} = {}: accepted is 0 to 1e9", name, value));
}

Crosslink::Crosslink(const CrosslinkSettings& settings, std::uint64_t seed, std::string_view name)
    : settings_(checked(settings)),
      link_(settings.link, engine::RandomStream(seed, "crosslink/" + std::string(name))) {}

bool Crosslink::silent(fsw::GpsTime now) const {
  const double elapsed_s = seconds(now - *first_);
  return elapsed_s >= settings_.silence_begin_s && elapsed_s < settings_.silence_begin_s + settings_.silence_duration_s;
}

std::optional<fsw::GpsTime> Crosslink::send(fsw::GpsTime now) {
  if (!first_) first_ = now;
  const engine::Transfer transfer = link_.send(now);
  ++counters_.sent;
  if (transfer.lost || silent(now)) {
    ++counters_.lost;
    return std::nullopt;
  }
  return transfer.delivery;
}

}  // namespace vbar::twins::gnss
