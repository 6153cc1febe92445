#include "emulators/grand/receiver/receiver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <GeographicLib/Geocentric.hpp>

#include "emulators/grand/receiver/console.h"
#include "emulators/grand/receiver/logs.h"
#include "emulators/grand/receiver/measurement_engine.h"
#include "emulators/grand/receiver/serial_line.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {
namespace {

namespace oem = twins::gnss::oem;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kBreakPair_ns = 3 * kSecond_ns;
constexpr std::int64_t kResetDelay_ns = kSecond_ns / 2;  ///< the answer to RESET leaves before the restart

fsw::Vector3 ecef_of_geodetic(double latitude_deg, double longitude_deg, double height_m) {
  fsw::Vector3 ecef;
  GeographicLib::Geocentric::WGS84().Forward(latitude_deg, longitude_deg, height_m, ecef.x(), ecef.y(), ecef.z());
  return ecef;
}

const std::shared_ptr<const twins::gnss::Constellation>& needed(
    const std::shared_ptr<const twins::gnss::Constellation>& constellation) {
  if (!constellation) throw std::invalid_argument("emulated receiver: no constellation");
  return constellation;
}

}  // namespace

class Receiver::Core {
 public:
  Core(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
       std::uint64_t seed, const std::string& vehicle, std::unique_ptr<Measurements> measurements);

  void advance(const RfBlock& block);
  void pass(fsw::Duration span);
  [[nodiscard]] bool busy() const;
  void listen(int port, std::span<const std::uint8_t> bytes, unsigned host_baud);
  void line_break(int port);
  Bytes speak(int port, unsigned host_baud);
  [[nodiscard]] unsigned baud(int port) const { return at(port).line.baud(); }
  void power(bool on);
  void set_cn0_offset_db(double offset_db) { cn0_offset_db_ = offset_db; }
  [[nodiscard]] ReceiverReport report() const;

 private:
  struct Port {
    SerialLine line;
    Console console;
    unsigned saved_baud;
    std::optional<unsigned> next_baud;  ///< takes effect when the answer has been queued
    std::optional<std::int64_t> break_ns;
  };

  Port& at(int port) { return ports_.at(static_cast<std::size_t>(port)); }
  [[nodiscard]] const Port& at(int port) const { return ports_.at(static_cast<std::size_t>(port)); }
  [[nodiscard]] bool running() const { return on_ && !boot_end_ns_; }

  void restart();
  void end_of_boot();
  void add_factory_log(int port);
  void on_epoch(const EpochData& epoch, std::int64_t block_begin_ns);
  void send_new_messages();
  void set_status_bit(unsigned bit, bool set);
  void queue_log(const LogRequest& request, const Bytes& bytes, std::int64_t ready_ns);
  [[nodiscard]] oem::Header header(int port) const;
  [[nodiscard]] oem::Header header_at(int port, fsw::GpsTime reading, bool position_valid) const;

  Response execute(int port, const Command& command);
  Response log(int port, const Command& command);
  Response unlog_all(int port, const Command& command);
  Response set_serial(int port, const Command& command);
  Response set_approximate_time(const Command& command);
  void send_once(const LogRequest& request);
  void answer(int port, std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<int> resolve(std::uint32_t id, int this_port) const;

  ReceiverSettings settings_;
  std::shared_ptr<const twins::gnss::Constellation> constellation_;
  std::unique_ptr<Measurements> engine_;
  LogWriter writer_;
  engine::RandomStream computing_;
  std::vector<Port> ports_;
  LogList logs_;
  std::optional<LogList> saved_logs_;
  std::vector<LogRequest> until_time_known_;  ///< messages of satellites that will leave when the clock has been set
  std::vector<LogRequest> after_answer_;      ///< logs that follow the answer to the command
  StoredData stored_;

  bool on_ = false;
  std::optional<std::int64_t> boot_end_ns_;
  std::optional<std::int64_t> reset_ns_;
  StoredData stored_after_reset_;
  bool factory_reset_ = false;
  std::int64_t local_ns_ = 0;  ///< since the receiver was made
  double cn0_offset_db_ = 0.0;
  std::uint32_t status_bits_ = 0;  ///< but "position invalid"
  bool position_valid_ = false;
  ReceiverReport counters_;
};

Receiver::Core::Core(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
                     std::uint64_t seed, const std::string& vehicle, std::unique_ptr<Measurements> measurements)
    : settings_(settings),
      constellation_(needed(constellation)),
      engine_(std::move(measurements)),
      writer_(*engine_, *constellation_, fsw::duration_of_seconds(settings.week_shift * twins::gnss::kSecondsPerWeek),
              fsw::duration_of_seconds(settings.time_shift_s)),
      computing_(seed, "grand/receiver/" + vehicle + "/computing"),
      stored_(settings.stored),
      stored_after_reset_(settings.stored) {
  for (int port = 0; port < kReceiverPorts; ++port) {
    const std::string name = "grand/receiver/" + vehicle + "/com" + std::to_string(port + 1);
    ports_.push_back({SerialLine(settings.line.baud, settings.line.buffer_bytes, engine::RandomStream(seed, name)),
                      Console(port, {[this](int p, const Command& command) { return execute(p, command); },
                                     [this](int p) { return header(p); },
                                     [this](int p, std::span<const std::uint8_t> bytes) { answer(p, bytes); }}),
                      settings.line.baud, std::nullopt, std::nullopt});
  }
}

void Receiver::Core::power(bool on) {
  if (on == on_) return;
  on_ = on;
  boot_end_ns_.reset();
  reset_ns_.reset();
  for (Port& port : ports_) port.line.clear();
  if (on) restart();
}

void Receiver::Core::restart() {
  engine_->restart(stored_);
  logs_ = saved_logs_.value_or(LogList{});
  for (int port = 0; port < kReceiverPorts; ++port) {
    Port& p = at(port);
    p.line.clear();
    p.line.set_baud(p.saved_baud);
    p.console.restart();
    p.next_baud.reset();
    add_factory_log(port);
  }
  until_time_known_.clear();
  status_bits_ = 0;
  position_valid_ = false;
  boot_end_ns_ = local_ns_ + fsw::nearest_duration(settings_.line.boot_s).ns;
}

// Every port has a held RXSTATUSEVENTA ONNEW.
void Receiver::Core::add_factory_log(int port) {
  Command command{CommandId::kLog, {}};
  command.values[1] = static_cast<double>(static_cast<std::uint32_t>(oem::MessageId::kRxStatusEvent) +
                                          65536U * static_cast<std::uint32_t>(LogFormat::kAscii));
  command.values[2] = static_cast<double>(Trigger::kOnNew);
  command.values[5] = 1.0;
  static_cast<void>(logs_.add(command, port));
}

void Receiver::Core::end_of_boot() {
  const std::int64_t when = *std::exchange(boot_end_ns_, std::nullopt);
  for (Port& port : ports_) {
    const std::string prompt = "\r\n" + port.console.prompt();
    port.line.queue({reinterpret_cast<const std::uint8_t*>(prompt.data()), prompt.size()}, when);
  }
}

void Receiver::Core::pass(fsw::Duration span) {
  const std::int64_t end_ns = local_ns_ + span.ns;
  if (on_ && reset_ns_ && *reset_ns_ <= end_ns) {
    local_ns_ = *reset_ns_;
    reset_ns_.reset();
    stored_ = stored_after_reset_;
    if (std::exchange(factory_reset_, false)) {
      saved_logs_.reset();
      for (Port& port : ports_) port.saved_baud = kFactoryBaud;
    }
    restart();
  }
  if (on_ && boot_end_ns_ && *boot_end_ns_ <= end_ns) end_of_boot();
  local_ns_ = end_ns;
}

bool Receiver::Core::busy() const {
  if (!on_) return false;
  return boot_end_ns_ || reset_ns_ ||
         std::ranges::any_of(ports_, [this](const Port& port) { return port.line.busy(local_ns_); });
}

void Receiver::Core::advance(const RfBlock& block) {
  const std::int64_t begin_ns = local_ns_;
  const bool measures = running();
  pass(RfBlock::kLength);
  if (!measures || !running()) return;
  engine_->advance(block, cn0_offset_db_,
                   {[this](std::int64_t epoch) { return logs_.any_due_at(epoch); },
                    [this, begin_ns](const EpochData& epoch) { on_epoch(epoch, begin_ns); }});
  send_new_messages();
}

oem::Header Receiver::Core::header_at(int port, fsw::GpsTime reading, bool position_valid) const {
  return writer_.header(port, reading, position_valid, status_bits_);
}

oem::Header Receiver::Core::header(int port) const {
  return header_at(port, engine_->reading(), position_valid_);
}

void Receiver::Core::queue_log(const LogRequest& request, const Bytes& bytes, std::int64_t ready_ns) {
  if (bytes.empty()) return;
  const bool fits = at(request.port).line.queue(bytes, ready_ns);
  ++(fits ? counters_.logs : counters_.logs_dropped);
  set_status_bit(oem::kTransmitOverrunBit + static_cast<unsigned>(request.port), !fits);
}

void Receiver::Core::on_epoch(const EpochData& epoch, std::int64_t block_begin_ns) {
  ++counters_.epochs;
  const double spread_ms = settings_.line.computing_spread_ms;
  const double computing_s = (settings_.line.computing_ms + computing_.uniform(-spread_ms, spread_ms)) * 1e-3;
  const std::int64_t ready_ns = block_begin_ns + fsw::nearest_duration(epoch.after_begin_s + computing_s).ns;
  set_status_bit(oem::kPositionInvalidBit, !epoch.solution);
  std::vector<LogRequest> done;
  const std::vector<LogRequest> requests = logs_.requests();
  for (const LogRequest& request : requests) {
    const bool once = request.trigger == Trigger::kOnNext && request.kind->log_class == LogClass::kEpoch;
    if (!once && !request.due_at(epoch.number)) continue;
    // Without a time no signal can be listed, and RTKLIB takes a RANGE of none for a repetition of the last one it has.
    if (request.kind->id == oem::MessageId::kRange && !engine_->time_is_set()) continue;
    Bytes bytes;
    const oem::Header head = header_at(request.port, epoch.reading, epoch.solution.has_value());
    switch (request.kind->log_class) {
      case LogClass::kEpoch:
        writer_.append_epoch(bytes, request, head, epoch);
        break;
      case LogClass::kMessage:
        writer_.append_messages(bytes, request, head, std::nullopt);
        break;
      case LogClass::kPolled:
        writer_.append_version(bytes, request, head);
        break;
      case LogClass::kEvent:
        break;
    }
    queue_log(request, bytes, ready_ns);
    if (once) done.push_back(request);
  }
  for (const LogRequest& request : done) logs_.remove(request);
}

void Receiver::Core::send_new_messages() {
  if (!engine_->time_is_set()) return;
  const std::vector<LogRequest> complete = std::exchange(until_time_known_, {});
  for (const LogRequest& request : complete) send_once(request);
  if (engine_->new_sets().empty() && !engine_->new_corrections()) return;
  const std::vector<LogRequest> requests = logs_.requests();
  for (const LogRequest& request : requests) {
    if (request.kind->log_class != LogClass::kMessage || request.trigger == Trigger::kOnTime) continue;
    const bool sent = std::ranges::any_of(complete, [&request](const LogRequest& other) {
      return other.port == request.port && other.kind == request.kind && other.format == request.format;
    });
    if (sent) continue;
    Bytes bytes;
    if (request.kind->id == oem::MessageId::kIonUtc) {
      if (engine_->new_corrections()) writer_.append_messages(bytes, request, header(request.port), std::nullopt);
    } else {
      for (const std::size_t satellite : engine_->new_sets())
        writer_.append_messages(bytes, request, header(request.port), satellite);
    }
    if (bytes.empty()) continue;
    queue_log(request, bytes, local_ns_);
    if (request.trigger == Trigger::kOnNext) logs_.remove(request);
  }
}

void Receiver::Core::set_status_bit(unsigned bit, bool set) {
  if (bit == oem::kPositionInvalidBit) {
    if (position_valid_ == !set) return;
    position_valid_ = !set;
  } else {
    const std::uint32_t mask = 1U << bit;
    if (((status_bits_ & mask) != 0) == set) return;
    status_bits_ ^= mask;
  }
  const std::vector<LogRequest> requests = logs_.requests();
  for (const LogRequest& request : requests) {
    if (request.kind->log_class != LogClass::kEvent) continue;
    Bytes bytes;
    writer_.append_event(bytes, request, header(request.port), bit, set);
    // An event that does not fit is lost: it must not raise the next one.
    const bool fits = at(request.port).line.queue(bytes, local_ns_);
    ++(fits ? counters_.logs : counters_.logs_dropped);
  }
}

void Receiver::Core::listen(int port, std::span<const std::uint8_t> bytes, unsigned host_baud) {
  if (!running()) return;
  Port& p = at(port);
  if (host_baud == p.line.baud()) {
    p.console.listen(bytes, local_ns_);
    return;
  }
  counters_.garbage_bytes += bytes.size();
  p.console.listen(p.line.garbage(bytes, host_baud, p.line.baud()), local_ns_);
}

void Receiver::Core::line_break(int port) {
  if (!running()) return;
  Port& p = at(port);
  const bool second = p.break_ns && local_ns_ - *p.break_ns <= kBreakPair_ns;
  p.break_ns = local_ns_;
  if (!second) return;
  p.break_ns.reset();
  p.line.clear();
  p.line.set_baud(kFactoryBaud);
  p.console.restart();
  logs_.remove_all(port, true);
  add_factory_log(port);
}

Bytes Receiver::Core::speak(int port, unsigned host_baud) {
  if (!on_) return {};
  return at(port).line.take(local_ns_, host_baud);
}

void Receiver::Core::answer(int port, std::span<const std::uint8_t> bytes) {
  Port& p = at(port);
  static_cast<void>(p.line.queue(bytes, local_ns_));
  if (p.next_baud) p.line.set_baud(*std::exchange(p.next_baud, std::nullopt));
  for (const LogRequest& request : std::exchange(after_answer_, {})) send_once(request);
}

std::optional<int> Receiver::Core::resolve(std::uint32_t id, int this_port) const {
  if (id == static_cast<std::uint32_t>(PortId::kThisPort) || id == static_cast<std::uint32_t>(PortId::kThisPortAll))
    return this_port;
  for (int port = 0; port < kReceiverPorts; ++port) {
    const auto number = static_cast<std::uint32_t>(port + 1);
    if (id == number || id == number * static_cast<std::uint32_t>(PortId::kCom1)) return port;
  }
  return std::nullopt;
}

Response Receiver::Core::execute(int port, const Command& command) {
  switch (command.id) {
    case CommandId::kLog:
      return log(port, command);
    case CommandId::kUnlog: {
      const std::optional<int> to = resolve(command.whole(0), port);
      if (!to) return unknown_port();
      logs_.remove(*to, command.message_id(1), command.format(1));
      std::erase_if(until_time_known_, [&](const LogRequest& request) {
        return request.port == *to && static_cast<std::uint16_t>(request.kind->id) == command.message_id(1);
      });
      return {};
    }
    case CommandId::kUnlogAll:
      return unlog_all(port, command);
    case CommandId::kCom:
    case CommandId::kSerialConfig:
      return set_serial(port, command);
    case CommandId::kReset:
    case CommandId::kFreset:
      reset_ns_ = local_ns_ + kResetDelay_ns;
      if (command.id == CommandId::kReset) {
        *reset_ns_ += static_cast<std::int64_t>(command.whole(0)) * kSecond_ns;
      } else {
        constexpr std::uint32_t kStandard = 0, kAlmanac = 2, kEphemerides = 3;
        const std::uint32_t target = command.whole(0);
        if (target == kStandard || target == kAlmanac) stored_after_reset_ = StoredData::kNothing;
        if (target == kEphemerides) stored_after_reset_ = std::min(stored_, StoredData::kAlmanac);
        factory_reset_ = target == kStandard;
      }
      return {};
    case CommandId::kSaveConfig:
      saved_logs_ = logs_;
      for (Port& p : ports_) p.saved_baud = p.line.baud();
      return {};
    case CommandId::kClockAdjust:
      engine_->enable_steering(command.whole(0) != 0);
      return {};
    case CommandId::kElevationCutoff:
      engine_->set_elevation_cutoff(command.values[0] * std::numbers::pi / 180.0);
      return {};
    case CommandId::kCodeSmoothing:
      engine_->set_smoothing(command.values[0]);
      return {};
    case CommandId::kSetApproxTime:
      return set_approximate_time(command);
    case CommandId::kSetApproxPos:
      engine_->set_approximate_position(ecef_of_geodetic(command.values[0], command.values[1], command.values[2]));
      return {};
    case CommandId::kPpsControl:
      return {};  // the receiver's own pulse is not wired
  }
  return command_failed();
}

Response Receiver::Core::log(int port, const Command& command) {
  const std::optional<int> to = resolve(command.whole(0), port);
  if (!to) return unknown_port();
  LogList trial = logs_;
  if (Response refusal = trial.add(command, *to); !refusal.ok()) return refusal;
  const LogKind* const kind = find_log_kind(command.message_id(1));
  const auto added = std::ranges::find_if(trial.requests(), [&](const LogRequest& request) {
    return request.port == *to && request.kind == kind && request.format == command.format(1);
  });
  const LogRequest request = *added;
  const bool at_next_epoch = request.trigger == Trigger::kOnce && kind->log_class == LogClass::kEpoch;
  if (request.trigger == Trigger::kOnce && !at_next_epoch) {
    after_answer_.push_back(request);
    return {};
  }
  if (at_next_epoch) {
    // The log that is current is the one of the next epoch.
    Command next = command;
    next.values[2] = static_cast<double>(Trigger::kOnNext);
    return logs_.add(next, *to);
  }
  logs_ = std::move(trial);
  if (request.trigger == Trigger::kOnChanged) after_answer_.push_back(request);
  if (request.trigger == Trigger::kOnNext && kind->log_class == LogClass::kPolled) {
    after_answer_.push_back(request);
    logs_.remove(request);
  }
  return {};
}

// Sends the present content of a log. Messages of satellites wait for the clock: without a time in the header readers
// drop them.
void Receiver::Core::send_once(const LogRequest& request) {
  if (request.kind->log_class == LogClass::kMessage && !engine_->time_is_set()) {
    until_time_known_.push_back(request);
    return;
  }
  Bytes bytes;
  if (request.kind->log_class == LogClass::kMessage)
    writer_.append_messages(bytes, request, header(request.port), std::nullopt);
  if (request.kind->log_class == LogClass::kPolled) writer_.append_version(bytes, request, header(request.port));
  queue_log(request, bytes, local_ns_);
}

Response Receiver::Core::unlog_all(int port, const Command& command) {
  const bool held = command.whole(1) != 0;
  const bool all_ports = command.whole(0) == static_cast<std::uint32_t>(PortId::kAllPorts);
  const std::optional<int> to = all_ports ? std::optional<int>(-1) : resolve(command.whole(0), port);
  if (!to) return unknown_port();
  logs_.remove_all(*to, held);
  std::erase_if(until_time_known_, [&](const LogRequest& request) { return all_ports || request.port == *to; });
  return {};
}

Response Receiver::Core::set_serial(int port, const Command& command) {
  const std::optional<int> to = resolve(command.whole(0), port);
  if (!to) return unknown_port();
  const std::uint32_t rate = command.whole(1);
  if (!is_baud_rate(rate)) return invalid_baud();
  constexpr std::uint32_t kNoParity = 0, kEightBits = 8, kOneStopBit = 1, kNoHandshake = 0;
  if (command.whole(2) != kNoParity || command.whole(3) != kEightBits || command.whole(4) != kOneStopBit ||
      command.whole(5) != kNoHandshake)
    return command_failed();  // 8N1 without handshake is emulated, nothing else
  if (*to == port) {
    at(*to).next_baud = rate;
  } else {
    at(*to).line.set_baud(rate);
  }
  return {};
}

Response Receiver::Core::set_approximate_time(const Command& command) {
  const auto week = static_cast<int>(command.whole(0));
  const fsw::GpsTime time =
      twins::gnss::gps_time_of(twins::gnss::System::kGps, week, 0) + fsw::nearest_duration(command.values[1]);
  engine_->set_approximate_time(time);
  return {};
}

ReceiverReport Receiver::Core::report() const {
  ReceiverReport report = counters_;
  engine_->report(report);
  for (const Port& port : ports_) {
    report.commands += port.console.commands();
    report.commands_refused += port.console.refused();
  }
  return report;
}

Receiver::Receiver(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
                   std::uint64_t seed, std::string_view vehicle)
    : Receiver(settings, constellation, seed, vehicle,
               std::make_unique<MeasurementEngine>(settings, needed(constellation), seed, vehicle)) {}
Receiver::Receiver(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
                   std::uint64_t seed, std::string_view vehicle, std::unique_ptr<Measurements> measurements)
    : core_(std::make_unique<Core>(settings, std::move(constellation), seed, std::string(vehicle),
                                   std::move(measurements))) {}
Receiver::Receiver(Receiver&&) noexcept = default;
Receiver& Receiver::operator=(Receiver&&) noexcept = default;
Receiver::~Receiver() = default;

void Receiver::advance(const RfBlock& block) {
  core_->advance(block);
}
void Receiver::idle(fsw::Duration span) {
  core_->pass(span);
}
bool Receiver::busy() const {
  return core_->busy();
}
void Receiver::listen(int port, std::span<const std::uint8_t> bytes, unsigned host_baud) {
  core_->listen(port, bytes, host_baud);
}
void Receiver::line_break(int port) {
  core_->line_break(port);
}
std::vector<std::uint8_t> Receiver::speak(int port, unsigned host_baud) {
  return core_->speak(port, host_baud);
}
unsigned Receiver::baud(int port) const {
  return core_->baud(port);
}
void Receiver::power(bool on) {
  core_->power(on);
}
void Receiver::set_cn0_offset_db(double offset_db) {
  core_->set_cn0_offset_db(offset_db);
}
ReceiverReport Receiver::report() const {
  return core_->report();
}

}  // namespace vbar::grand::bench
