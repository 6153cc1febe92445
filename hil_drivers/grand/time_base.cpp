#include "hil_drivers/grand/time_base.h"

#include <stdexcept>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {
namespace {

constexpr std::chrono::seconds kFirstEdge{10};

}  // namespace

TimeBase::TimeBase(fsw::GpsTime start, const std::string& pps, const std::string& chrony) : start_(start) {
  if (pps == "none") return;
  EdgeClockSettings settings;
  if (!chrony.empty()) {
    chrony_.emplace(chrony);
    settings.on_edge = [this](const Edge& edge) { chrony_->forward(edge); };
  }
  edges_ = std::make_unique<EdgeClock>(make_edge_source(pps), std::make_unique<engine::SteadyWallClock>(), settings);
}

void TimeBase::begin(std::optional<std::chrono::steady_clock::time_point> host_start) {
  const auto at_host = host_start ? std::chrono::duration_cast<Span>(host_start->time_since_epoch()) : host_.now();
  if (!edges_) {
    start_of_run_ = at_host;
    return;
  }
  edges_->wait_for_edges(1, kFirstEdge);
  if (const auto labelled = edges_->at_gps(start_)) {
    start_of_run_ = *labelled;
  } else if (host_start) {
    start_of_run_ = edges_->at(at_host);
  } else {
    throw std::runtime_error("the start of the generator is unknown: neither its edges nor its answers contain it");
  }
}

std::optional<double> TimeBase::last_edge_s() const {
  if (!edges_) return std::nullopt;
  const auto edge = edges_->last_edge();
  if (!edge) return std::nullopt;
  return std::chrono::duration<double>(*edge - start_of_run_).count();
}

}  // namespace vbar::grand
