#include "host_sim/app/started_sources.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace vbar::app {

void StartedSources::start(fsw::GpsTime first_epoch) {
  while (started_ < sources_.size()) {
    const Source& source = sources_[started_++];
    try {
      source.packets->start(first_epoch);
    } catch (const std::exception& error) {
      stop(twins::StopReason::kFailed);
      throw std::runtime_error(fmt::format("source {}: {}", source.name, error.what()));
    }
  }
}

std::string StartedSources::stop(twins::StopReason reason) {
  std::string trouble;
  for (std::size_t k = std::exchange(started_, 0); k-- > 0;) {
    try {
      sources_[k].packets->stop(reason);
    } catch (const std::exception& error) {
      if (!trouble.empty()) trouble += "; ";
      trouble += fmt::format("source {} could not be stopped: {}", sources_[k].name, error.what());
    }
  }
  return trouble;
}

}  // namespace vbar::app
