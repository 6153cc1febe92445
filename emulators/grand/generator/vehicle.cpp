#include "emulators/grand/generator/vehicle.h"

#include <string>
#include <utility>

namespace vbar::grand::bench {

namespace {

constexpr std::uint64_t kRun = 200;               ///< bytes of a message that pass, then as many that are missing
constexpr std::size_t kGarbageBytes = 40;         ///< added every 100 ms
constexpr double kGarbageProbability = 0.01;      ///< probability that a byte is replaced
constexpr std::size_t kFloodBytes = 20'000;       ///< every 100 ms
constexpr double kSyncProbability = 1.0 / 300.0;  ///< probability of a sync pattern in random bytes

}  // namespace

LineImpairment::LineImpairment(std::uint64_t seed, std::string_view name)
    : stream_(seed, "grand/line/" + std::string(name)) {}

std::vector<std::uint8_t> LineImpairment::to_host(std::vector<std::uint8_t> bytes) {
  if (on_[kGarbage]) {
    for (std::uint8_t& byte : bytes) {
      if (stream_.uniform() >= kGarbageProbability) continue;
      byte = random_byte();
      ++counts_[kGarbage];
    }
    add_random(bytes, kGarbageBytes, kGarbage);
  }
  if (on_[kHalfMessages]) {
    std::vector<std::uint8_t> passed;
    for (const std::uint8_t byte : bytes) {
      if (position_++ / kRun % 2 == 0)
        passed.push_back(byte);
      else
        ++counts_[kHalfMessages];
    }
    bytes = std::move(passed);
  }
  if (on_[kFlood]) add_random(bytes, kFloodBytes, kFlood);
  return bytes;
}

std::vector<std::uint8_t> LineImpairment::from_host(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> heard(bytes.begin(), bytes.end());
  if (on_[kRefuses]) {
    // Letters of the next alphabet: lines keep their ends, binary commands lose their check sum.
    for (std::uint8_t& byte : heard) {
      if (byte < 0x40U) continue;
      byte ^= 0x15U;
      ++counts_[kRefuses];
    }
  }
  if (on_[kUnanswered]) {
    counts_[kUnanswered] += heard.size();
    heard.clear();
  }
  return heard;
}

// Beginnings of binary messages are among them, so that a decoder has something to reject.
void LineImpairment::add_random(std::vector<std::uint8_t>& bytes, std::size_t count, Kind kind) {
  while (count > 0) {
    const bool sync = count >= 4 && stream_.uniform() < kSyncProbability;
    if (sync) {
      for (const std::uint8_t byte : {0xAA, 0x44, 0x12, 0x1C}) bytes.push_back(byte);
      count -= 4;
      counts_[kind] += 4;
      continue;
    }
    bytes.push_back(random_byte());
    --count;
    ++counts_[kind];
  }
}

namespace {

constexpr fsw::Duration kIdleStep{10'000'000};
constexpr int kMaxIdleSteps = 6000;

}  // namespace

Vehicle::Vehicle(boost::asio::io_context& context, const std::filesystem::path& directory, std::string name,
                 std::size_t com_ports, std::uint64_t seed, std::unique_ptr<ReceiverEnd> receiver)
    : name_(std::move(name)), motion_(fsw::Duration{}), receiver_(std::move(receiver)) {
  ports_.reserve(com_ports);
  for (std::size_t port = 0; port < com_ports; ++port) {
    const std::string line_name = name_ + ".com" + std::to_string(port + 1);
    auto listener = [this, port](auto bytes, unsigned host_baud) { listen(port, bytes, host_baud); };
    ports_.push_back({std::make_unique<emulators::HostLine>(context, directory / line_name, std::move(listener)),
                      LineImpairment(seed, line_name)});
    ports_.back().line->set_host_baud(receiver_->baud(port));  // until the host sets its own
  }
}

void Vehicle::reset(fsw::Duration join) {
  motion_ = VehicleMotion(join);
  sky_.reset();
  next_block_ = 0;
  last_snap_block_ = INT64_MIN;
}

void Vehicle::start(std::unique_ptr<Sky> sky) {
  sky_ = std::move(sky);
}

void Vehicle::fly(fsw::Duration time) {
  while (blocks_end() + RfBlock::kLength <= time) {
    motion_.advance(blocks_end() + RfBlock::kLength);
    sky_->fill(motion_, next_block_, motion_.is_radiated() && !outage_, block_);
    if (block_.snapped) last_snap_block_ = next_block_;
    ++next_block_;
    receiver_->advance(block_);
    speak();
  }
  motion_.advance(time);
}

void Vehicle::idle(fsw::Duration span) {
  receiver_->idle(span);
  speak();
}

void Vehicle::listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud) {
  const std::vector<std::uint8_t> heard = ports_[port].impairment.from_host(bytes);
  if (heard.empty()) return;
  receiver_->listen(port, heard, host_baud);
  if (answers_at_once_) settle();
}

void Vehicle::answer_at_once(bool is_on) {
  answers_at_once_ = is_on;
  if (is_on) settle();
}

// At most a minute of the receiver's time.
void Vehicle::settle() {
  for (int step = 0; step < kMaxIdleSteps && receiver_->busy(); ++step) idle(kIdleStep);
}

void Vehicle::poll_lines() {
  for (Port& port : ports_) port.line->poll();
}

void Vehicle::speak() {
  for (std::size_t port = 0; port < ports_.size(); ++port) {
    emulators::HostLine& line = *ports_[port].line;
    const std::vector<std::uint8_t> bytes = ports_[port].impairment.to_host(receiver_->speak(port, line.host_baud()));
    if (!bytes.empty()) line.write(bytes);
  }
}

double Vehicle::seconds_since_snap() const {
  if (last_snap_block_ == INT64_MIN) return 1e9;
  return static_cast<double>(next_block_ - last_snap_block_) * fsw::seconds(RfBlock::kLength);
}

}  // namespace vbar::grand::bench
