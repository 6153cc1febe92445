#include "hil_drivers/optical_stimulator/bench/screen/screen_watch.h"

#include <algorithm>
#include <cmath>

namespace vbar::optical_stimulator::bench {
namespace {

/// Pictures older than this belong to no exposure.
constexpr double kKept_s = 60.0;

double seconds(ScreenWatch::Clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

Pictures pictures_of(const std::deque<TimedPicture>& shown, double begin_s, double end_s, double response_s) {
  // The light of a picture shown from a to b rises as 1 - exp(-(t - a)/tau) and falls as exp(-(t - b)/tau): the
  // integral of what the step at `at` has reached.
  const auto after_step = [&](double at) {
    const double from = std::max(begin_s, at);
    if (from >= end_s) return 0.0;
    if (response_s <= 0.0) return end_s - from;
    return (end_s - from) + response_s * (std::exp((at - end_s) / response_s) - std::exp((at - from) / response_s));
  };
  Pictures pictures;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const double reached = k == 0 ? end_s - begin_s : after_step(shown[k].begin_s);
    const double left = k + 1 < shown.size() ? after_step(shown[k + 1].begin_s) : 0.0;
    const double fraction = (reached - left) / (end_s - begin_s);
    if (fraction > 0.0) pictures.push_back({shown[k].counts, fraction});
  }
  return pictures;
}

ScreenWatch::ScreenWatch(const DisplaySettings& settings, Pace pace, ReadScreen read)
    : settings_(settings), read_(std::move(read)) {
  if (pace == Pace::kReal) thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

ScreenWatch::~ScreenWatch() = default;

void ScreenWatch::watch(const std::stop_token& stop) {
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / settings_.refresh_hz));
  std::vector<std::uint8_t> grey;
  for (Clock::time_point next = Clock::now(); !stop.stop_requested(); next += period) {
    std::this_thread::sleep_until(next);
    read_(grey);
    const double begin_s = seconds(next - origin_) + settings_.latency_frames / settings_.refresh_hz;
    const std::lock_guard lock(mutex_);
    if (shown_.empty() || *shown_.back().counts != grey)
      shown_.push_back({begin_s, std::make_shared<const std::vector<std::uint8_t>>(grey)});
    while (shown_.size() > 1 && shown_[1].begin_s < begin_s - kKept_s) shown_.pop_front();
    next = std::max(next, Clock::now() - period);  // a loaded computer leaves out refreshes
  }
}

Pictures ScreenWatch::during(Clock::time_point begin, double exposure_s) {
  if (!thread_.joinable()) {
    auto counts = std::make_shared<std::vector<std::uint8_t>>();
    read_(*counts);
    return {{std::move(counts), 1.0}};
  }
  const double begin_s = seconds(begin - origin_), end_s = begin_s + exposure_s;
  std::this_thread::sleep_until(begin +
                                std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(exposure_s)));
  const std::lock_guard lock(mutex_);
  if (shown_.empty()) return {};
  return pictures_of(shown_, begin_s, end_s, 1e-3 * settings_.response_ms);
}

}  // namespace vbar::optical_stimulator::bench
