#include "emulators/grand/receiver/message_reception.h"

#include <algorithm>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {
namespace {

using twins::gnss::BroadcastSet;
using twins::gnss::Constellation;
using twins::gnss::SatelliteId;
using twins::gnss::System;
using twins::gnss::WeekTime;

// 1.2 s: telemetry and handover word of GPS, preamble and seconds of week of BeiDou.
const MessageLayout kLnav{30.0, {{0.0, 6.0}, {6.0, 6.0}, {12.0, 6.0}}, {0.0, 1.2}, 6.0, {0.0, 1.2}, 6.0};
const MessageLayout kBeidouD1 = kLnav;
// The sign of E1-C follows from its secondary code, 25 chips of 4 ms; the time of week is in word 5.
const MessageLayout kGalileo{
    30.0, {{0.0, 2.0}, {2.0, 2.0}, {20.0, 2.0}, {22.0, 2.0}, {24.0, 2.0}}, {0.0, 0.1}, 0.1, {24.0, 2.0}, 30.0};
const MessageLayout kBeidouD2 = [] {
  MessageLayout layout{30.0, {}, {0.0, 0.12}, 0.6, {0.0, 0.12}, 0.6};
  for (int page = 0; page < 10; ++page) layout.ephemeris.push_back({3.0 * page, 0.6});
  return layout;
}();

// Page 18 of 25 of subframe 4.
constexpr double kCorrectionsPeriod_s = 750.0;
constexpr double kCorrectionsBegin_s = 17.0 * 30.0 + 18.0;
constexpr double kCorrectionsLength_s = 6.0;

}  // namespace

const MessageLayout& message_layout(SatelliteId satellite) {
  switch (satellite.system) {
    case System::kGps:
      return kLnav;
    case System::kGalileo:
      return kGalileo;
    case System::kBeidou:
      return is_geostationary(satellite) ? kBeidouD2 : kBeidouD1;
  }
  return kLnav;
}

MessageReception::MessageReception(SatelliteId satellite)
    : satellite_(satellite), layout_(&message_layout(satellite)), parts_(layout_->ephemeris.size()) {}

void MessageReception::keep(const BroadcastSet& set, fsw::GpsTime transmitted) {
  set_ = set;
  set_transmitted_ = transmitted;
}

void MessageReception::forget() {
  heard_since_.reset();
  set_.reset();
  std::fill(parts_.begin(), parts_.end(), Heard{});
  last_sync_ = last_time_of_week_ = last_corrections_ = {};
}

std::optional<fsw::GpsTime> MessageReception::last_heard(double begin_s, double length_s, double period_s,
                                                         fsw::GpsTime transmitted) const {
  const WeekTime time = twins::gnss::week_time(satellite_.system, transmitted);
  const std::int64_t period_ns = fsw::nearest_duration(period_s).ns;
  const std::int64_t since_ns = time.ns_of_week - fsw::nearest_duration(begin_s + length_s).ns;
  if (since_ns < 0) return std::nullopt;
  const fsw::GpsTime week_begin = transmitted - fsw::Duration{time.ns_of_week};
  const fsw::GpsTime begin =
      week_begin + fsw::Duration{since_ns / period_ns * period_ns} + fsw::nearest_duration(begin_s);
  if (begin < *heard_since_) return std::nullopt;
  return begin;
}

MessageReception::News MessageReception::receive(fsw::GpsTime transmitted, bool locked,
                                                 const Constellation& constellation, std::size_t index) {
  News news;
  if (!locked) {
    heard_since_.reset();
    return news;
  }
  if (!heard_since_) heard_since_ = transmitted;
  const auto heard_again = [&](double begin_s, double length_s, double period_s, fsw::GpsTime& last) {
    const std::optional<fsw::GpsTime> begin = last_heard(begin_s, length_s, period_s, transmitted);
    if (!begin || *begin <= last) return false;
    last = *begin;
    return true;
  };
  news.sign_of_bits = heard_again(layout_->sync.begin_s, layout_->sync.length_s, layout_->sync_period_s, last_sync_);
  news.time_of_week = heard_again(layout_->time_of_week.begin_s, layout_->time_of_week.length_s,
                                  layout_->time_of_week_period_s, last_time_of_week_);
  if (satellite_.system == System::kGps)
    news.corrections = heard_again(kCorrectionsBegin_s, kCorrectionsLength_s, kCorrectionsPeriod_s, last_corrections_);
  bool new_part = false;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const MessageLayout::Part& part = layout_->ephemeris[k];
    if (!heard_again(part.begin_s, part.length_s, layout_->cycle_s, parts_[k].begin)) continue;
    parts_[k].toe = constellation.broadcast_set(index, parts_[k].begin).ephemeris.toe;
    parts_[k].valid = new_part = true;
  }
  news.ephemeris = new_part && complete_set(constellation, index);
  return news;
}

bool MessageReception::complete_set(const Constellation& constellation, std::size_t index) {
  fsw::GpsTime first = parts_.front().begin;
  for (const Heard& part : parts_) {
    if (!part.valid || part.toe != parts_.front().toe) return false;
    first = std::min(first, part.begin);
  }
  if (set_ && set_->ephemeris.toe == parts_.front().toe) return false;
  // A GPS log names the beginning of subframe 1.
  keep(constellation.broadcast_set(index, parts_.front().begin), parts_.front().begin);
  return true;
}

}  // namespace vbar::grand::bench
