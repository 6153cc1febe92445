#include "hil_drivers/grand/receiver_link.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "fsw/gnss/gps_week.h"
#include "host_sim/files/output_file.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::grand {

void RawRecord::add(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (file_.is_open()) {
    write(bytes);
  } else {
    early_.insert(early_.end(), bytes.begin(), bytes.end());
  }
}

void RawRecord::keep_in(const std::filesystem::path& file) {
  const std::lock_guard lock(mutex_);
  path_ = file;
  files::remove_link(file);
  file_.open(file, std::ios::binary | std::ios::trunc);
  if (!file_) throw std::runtime_error(file.string() + ": cannot be written");
  write(early_);
  early_.clear();
}

void RawRecord::flush() {
  const std::lock_guard lock(mutex_);
  if (file_.is_open()) file_.flush();
}

void RawRecord::write(std::span<const std::uint8_t> bytes) {
  file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be written");
}

namespace {

constexpr std::int64_t kCycle_ns = 1024 * fsw::gnss::kNanosecondsPerWeek;
// An epoch cannot arrive before it was measured.
constexpr fsw::Duration kEarliest{-50'000'000};

}  // namespace

void TagCheck::check(fsw::GpsTime tag, fsw::GpsTime arrival) {
  const fsw::Duration apart = arrival - tag;
  const std::int64_t cycles = std::llround(static_cast<double>(apart.ns) / static_cast<double>(kCycle_ns));
  const fsw::Duration latency{apart.ns - cycles * kCycle_ns};
  const int weeks = static_cast<int>(1024 * cycles);
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(fmt::format("{}: its time is {} where the run's is {}: {}", receiver_,
                                         truth::format_utc(tag), truth::format_utc(arrival), what));
  };
  // After the first tag a late epoch is one of a slow line: the flight software goes by its tag.
  if (weeks_ && weeks == *weeks_) return;
  if (latency < kEarliest || latency > max_latency_)
    fail(
        fmt::format("{:.3f} s apart, where -0.05 to {:g} s are allowed; check the start time of the scenario, the leap "
                    "seconds and sensors.gnss.max_latency_s",
                    fsw::seconds(latency), fsw::seconds(max_latency_)));
  if (weeks != 0 && !accepts_week_shift_)
    fail(fmt::format("{} weeks apart, a rollover of its week number; testbed.grand.week_shift = true accepts it",
                     weeks));
  if (weeks_) fail(fmt::format("{} weeks apart, after {}", weeks, *weeks_));
  weeks_ = weeks;
}

namespace {

using fsw::Duration;
using fsw::GpsTime;
using twins::gnss::BodyTruth;
using twins::gnss::ReceiverOutput;

constexpr Duration kBetweenAttempts = fsw::duration_of_seconds(1);
constexpr Duration kMemory = fsw::duration_of_seconds(3);  // attitudes kept: longer than any latency
constexpr int kSilentEpochs = 3;
// Bytes that complete no epoch are passed on after this, or when there are this many.
constexpr Duration kLongestWait = fsw::duration_of_seconds(2);
constexpr std::size_t kLargestRest = 60'000;

}  // namespace

ReceiverLink::ReceiverLink(LinkPlan plan)
    : plan_(std::move(plan)),
      port_(
          plan_.spacecraft, plan_.device, plan_.configuration,
          [this](std::span<const std::uint8_t> bytes) { raw_.add(bytes); }, plan_.start_patience),
      tag_check_(name(), plan_.week_shift, plan_.max_latency) {}

ReceiverLink::~ReceiverLink() {
  close();
}

std::string ReceiverLink::name() const {
  return fmt::format("receiver of {} on {}", plan_.spacecraft, plan_.device);
}

void ReceiverLink::open() {
  try {
    port_.open(true);
  } catch (const io::ChannelError& error) {
    throw std::runtime_error(fmt::format("receiver of {}: {}", plan_.spacecraft, error.what()));
  }
  port_.set_patience(plan_.reopen_patience);
}

void ReceiverLink::keep_in(const std::filesystem::path& folder) {
  raw_.keep_in(folder / ("receiver_" + plan_.spacecraft + ".gps"));
}

void ReceiverLink::close() noexcept {
  is_ending_ = true;
  turns_.abandon();
  if (reopening_.valid()) reopening_.wait();
  port_.close();
  raw_.flush();
}

void ReceiverLink::remember(const BodyTruth& truth) {
  attitudes_.push_back({truth.time, truth.q_body_eci, truth.q_body_eci * truth.rate_body_eci});
  while (truth.time - attitudes_.front().time > kMemory) attitudes_.pop_front();
}

/// Returns the attitude of the nearest sample: half a sample period away at most, which the flight software bridges by
/// the rate.
std::optional<twins::gnss::EpochAttitude> ReceiverLink::attitude_at(GpsTime epoch) const {
  if (attitudes_.empty() || epoch < attitudes_.front().time) return std::nullopt;
  const auto distance = [&](const Sample& sample) {
    const std::int64_t apart = (sample.time - epoch).ns;
    return apart < 0 ? -apart : apart;
  };
  const auto nearest = std::ranges::min_element(attitudes_, {}, distance);
  return twins::gnss::EpochAttitude{nearest->time, nearest->q_body_eci, nearest->rate_body};
}

ReceiverOutput ReceiverLink::take(const BodyTruth& truth, GpsTime arrival) {
  const GpsTime now = truth.time;
  remember(truth);
  last_call_ = now;
  if (!last_heard_) last_heard_ = last_delivery_ = now;
  std::vector<std::uint8_t> bytes = read(now);
  second_.bytes += static_cast<std::int64_t>(bytes.size());
  statistics_.bytes += bytes.size();
  const std::uint32_t messages = cutter_.counters().messages;
  std::vector<Burst> bursts = cutter_.push(bytes);
  if (cutter_.counters().messages != messages) last_heard_ = now;
  ReceiverOutput output = deliver(std::move(bursts), now, arrival);
  output.notes = std::exchange(notes_, {});
  if (!lost_since_ || output.is_epoch || now < next_failure_) return output;
  next_failure_ = now + plan_.period;
  output.failure =
      fmt::format("{} has been lost for {:.1f} s: {}", name(), fsw::seconds(now - *lost_since_), lost_reason_);
  return output;
}

std::vector<std::uint8_t> ReceiverLink::read(GpsTime now) {
  std::vector<std::uint8_t> bytes;
  if (lost_since_) try_to_reopen(now);
  if (lost_since_) return bytes;
  try {
    port_.read(bytes);
  } catch (const io::ChannelError& error) {
    lose(now, error.what());
  }
  if (!lost_since_ && (now - *last_heard_).ns > kSilentEpochs * plan_.period.ns)
    lose(now, fmt::format("no message for {} epochs", kSilentEpochs));
  return bytes;
}

void ReceiverLink::lose(GpsTime now, const std::string& reason) {
  port_.close();
  lost_since_ = next_attempt_ = next_failure_ = now;
  lost_reason_ = reason;
  ++statistics_.losses;
  notes_.push_back({"receiver_lost", 1.0, reason});
}

void ReceiverLink::try_to_reopen(GpsTime now) {
  if (reopening_.valid() || turns_.is_running()) return go_on_reopening(now);
  if (now - *lost_since_ >= plan_.give_up)
    throw std::runtime_error(fmt::format("{} has been lost for {:g} s (testbed.grand.give_up_s): {}", name(),
                                         fsw::seconds(plan_.give_up), lost_reason_));
  if (now < next_attempt_) return;
  next_attempt_ = now + kBetweenAttempts;
  start_reopening();
  go_on_reopening(now);
}

void ReceiverLink::start_reopening() {
  if (plan_.pace == Pace::kRealTime) {
    const PortTime time{.now = {}, .wait = {}, .abandoned = [this] { return is_ending_.load(); }};
    reopening_ = std::async(std::launch::async, [this, time] { port_.open(false, time); });
    return;
  }
  const PortTime time{.now = [this] { return turns_.now(); },
                      .wait = [this](PortTime::Point) { turns_.wait(); },
                      .abandoned = [this] { return turns_.is_abandoned(); }};
  turns_.start([this, time] { port_.open(false, time); });
}

void ReceiverLink::go_on_reopening(GpsTime now) {
  using namespace std::chrono_literals;
  try {
    if (turns_.is_running()) {
      if (!turns_.go_on(PortTime::Point(std::chrono::nanoseconds(now.ns)))) return;
    } else {
      if (reopening_.wait_for(0s) != std::future_status::ready) return;
      reopening_.get();
    }
    reconnected(now);
  } catch (const std::runtime_error& error) {
    lost_reason_ = error.what();
  }
}

void ReceiverLink::reconnected(GpsTime now) {
  const double lost_s = fsw::seconds(now - *lost_since_);
  ++statistics_.reconnects;
  statistics_.lost_s += lost_s;
  notes_.push_back({"receiver_reconnected_after_s", lost_s});
  lost_since_.reset();
  last_heard_ = now;
}

ReceiverOutput ReceiverLink::deliver(std::vector<Burst> bursts, GpsTime now, GpsTime arrival) {
  ReceiverOutput output;
  output.is_epoch = !bursts.empty();
  output.bytes_bypass_host = plan_.bytes_bypass_host;
  for (Burst& burst : bursts) {
    take_tag(burst, arrival);
    output.bytes.insert(output.bytes.end(), burst.bytes.begin(), burst.bytes.end());
    if (burst.tag.is_fine()) output.measured = attitude_at(burst.tag.time);
  }
  const bool is_overdue = now - *last_delivery_ >= plan_.period + kLongestWait;
  if (!output.is_epoch && cutter_.rest_size() > 0 && (is_overdue || cutter_.rest_size() > kLargestRest)) {
    output.is_epoch = true;
    output.bytes = cutter_.take_rest();
    if (tag_check_.weeks() != 0) shift_weeks(output.bytes, tag_check_.weeks());
  }
  if (output.is_epoch) last_delivery_ = now;
  return output;
}

void ReceiverLink::take_tag(Burst& burst, GpsTime arrival) {
  ++statistics_.epochs;
  second_.time_status = burst.tag.status;
  second_.tracked_signals = burst.tracked_signals;
  if (burst.limit_exceeded)
    throw std::runtime_error(name() +
                             " withholds its solution beyond export limits of height and velocity; such a "
                             "receiver cannot be used in orbit");
  if (!burst.tag.is_fine()) return;
  const bool is_first = !tag_check_.has_checked();
  tag_check_.check(burst.tag.time, arrival);
  if (const int weeks = tag_check_.weeks(); weeks != 0) {
    shift_weeks(burst.bytes, weeks);
    burst.tag.time = burst.tag.time + Duration{weeks * fsw::gnss::kNanosecondsPerWeek};
    statistics_.week_shift = weeks;
    if (is_first) notes_.push_back({"week_shift_weeks", static_cast<double>(weeks), "time tags shifted to the run's"});
  }
  second_.latency_s = fsw::seconds(arrival - burst.tag.time);
  statistics_.latencies_s.push_back(*second_.latency_s);
}

ReceiverSecond ReceiverLink::second() {
  second_.is_lost = lost_since_.has_value();
  ReceiverSecond next;
  next.time_status = second_.time_status;
  next.tracked_signals = second_.tracked_signals;
  return std::exchange(second_, next);
}

LinkStatistics ReceiverLink::statistics() const {
  LinkStatistics statistics = statistics_;
  statistics.stream = cutter_.counters();
  if (lost_since_) statistics.lost_s += fsw::seconds(last_call_ - *lost_since_);
  return statistics;
}

}  // namespace vbar::grand
