#include "emulators/grand/control/line_server.h"

#include <algorithm>

#include <fmt/format.h>

namespace vbar::grand::bench {

LineServer::LineServer(boost::asio::io_context& context, Engine& engine, const ControlSettings& settings,
                       std::size_t udp_ports)
    : engine_(engine), last_samples_(engine.vehicles()) {
  auto [listener, port] = emulators::bind_both(context, port_at(settings.control_ports, 0));
  listener_ = std::move(listener);
  ports_.push_back(std::move(port));
  for (std::size_t k = 1; k < udp_ports; ++k)
    ports_.push_back(std::make_shared<DatagramPort>(context, port_at(settings.control_ports, k)));
}

LineServer::~LineServer() {
  listener_->close();
  for (const auto& port : ports_) port->close();
}

std::vector<std::uint16_t> LineServer::hil_ports() const {
  std::vector<std::uint16_t> numbers;
  for (const auto& port : ports_) numbers.push_back(port->port());
  return numbers;
}

void LineServer::serve() {
  listener_->start([this] { return accept(); });
  for (std::size_t k = 0; k < ports_.size(); ++k) {
    ports_[k]->start([this, k](auto datagram, const auto&) {
      try {
        take_datagram(k, datagram);
      } catch (const wire::WireError&) {
        ++statistics_.malformed;
      }
    });
  }
}

Connection::Receive LineServer::accept() {
  if (faults_.refuses_connections) {
    ++statistics_.faults_applied;
    return nullptr;
  }
  return [this, lines = std::make_shared<wire::LineBuffer>()](Connection& connection, auto bytes) {
    lines->append(bytes);
    try {
      while (connection.is_open()) {
        const auto line = lines->next();
        if (!line) return;
        handle(*line, connection);
      }
    } catch (const wire::WireError& error) {
      ++statistics_.malformed;
      connection.send(refusal_of(error.what()));
      connection.close();
    }
  };
}

void LineServer::handle(const std::string& line, Connection& connection) {
  ++statistics_.commands;
  const auto answer = [alive = std::weak_ptr<int>(alive_),
                       weak = connection.weak_from_this()](const std::string& text) {
    const auto open = weak.lock();
    if (open && !alive.expired()) open->send(text);
  };
  const auto refuse = [&](const std::string& reason) {
    ++statistics_.refused;
    answer(refusal_of(reason));
  };
  switch (fault_of(faults_, command_of(line), statistics_)) {
    case FaultEffect::kNoAnswer:
      return;
    case FaultEffect::kClosing:
      return connection.close();
    case FaultEffect::kRefusal:
      return refuse(faults_.refusal);
    case FaultEffect::kNone:
      break;
  }
  // Samples sent before the line have arrived before it.
  drain();
  follow_engine();
  try {
    if (const auto text = execute(line, answer)) answer(*text);
  } catch (const Refusal& refusal) {
    refuse(refusal.what());
  } catch (const wire::WireError& error) {
    ++statistics_.malformed;
    refuse(error.what());
  }
}

void LineServer::drain() {
  for (const auto& port : ports_) port->drain();
}

LineServer::Stage LineServer::stage() const {
  const EngineState state = engine_.state();
  const bool has_run = stage_ == Stage::kArmed || stage_ == Stage::kRunning;
  if (!has_run || state == EngineState::kArmed || state == EngineState::kStreaming) return stage_;
  return state == EngineState::kIdle ? Stage::kIdle : Stage::kEnded;
}

void LineServer::follow_engine() {
  const Stage now = stage();
  if (now == stage_) return;
  stage_ = now;
  ++run_;
  if (now == Stage::kIdle) last_samples_.assign(engine_.vehicles(), std::nullopt);
}

void LineServer::take_sample(std::size_t vehicle, const TrajectorySample& sample) {
  follow_engine();
  if (vehicle >= engine_.vehicles() || stage_ == Stage::kEnded) {
    ++statistics_.samples_refused;
    return;
  }
  ++statistics_.samples;
  last_samples_[vehicle] = sample;
  if (stage_ == Stage::kArmed || stage_ == Stage::kRunning) engine_.sample(vehicle, sample);
}

void LineServer::begin_configuration(fsw::GpsTime start) {
  if (stage_ == Stage::kArmed || stage_ == Stage::kRunning)
    throw Refusal("the scenario is armed or running; it cannot be configured now");
  // Samples that came before the configuration belong to it.
  if (stage_ == Stage::kEnded) last_samples_.assign(engine_.vehicles(), std::nullopt);
  engine_.reset();
  if (const std::string refusal = engine_.set_start_time(start); !refusal.empty()) throw Refusal(refusal);
  stage_ = Stage::kConfigured;
}

void LineServer::arm() {
  if (stage_ == Stage::kIdle) throw Refusal("there is no start time");
  if (stage_ != Stage::kConfigured) throw Refusal("the scenario is armed, running or ended");
  for (std::size_t k = 0; k < last_samples_.size(); ++k)
    if (!last_samples_[k]) throw Refusal(fmt::format("vehicle {} has no motion at time 0", k + 1));
  if (const std::string refusal = engine_.arm(); !refusal.empty()) throw Refusal(refusal);
  stage_ = Stage::kArmed;
  ++run_;
  for (std::size_t k = 0; k < last_samples_.size(); ++k) engine_.sample(k, *last_samples_[k]);
}

void LineServer::start_at_edge(std::function<void(const std::string& refusal)> done) {
  if (stage_ != Stage::kArmed) throw Refusal("the scenario is not armed");
  engine_.on_next_edge.emplace_back([this, alive = std::weak_ptr<int>(alive_), run = run_, done = std::move(done)] {
    if (alive.expired()) return;
    if (run != run_ || stage_ != Stage::kArmed) return done("the scenario was stopped before the edge of the 1PPS");
    const std::string refusal = engine_.start(fsw::Duration{});
    if (refusal.empty()) stage_ = Stage::kRunning;
    done(refusal);
  });
}

void LineServer::stop_run() {
  if (stage_ == Stage::kArmed || stage_ == Stage::kRunning) engine_.stop();
  stage_ = Stage::kEnded;
  ++run_;
}

fsw::Duration LineServer::time_into_run() const {
  fsw::Duration latest;
  std::optional<fsw::Duration> behind;
  for (std::size_t k = 0; k < last_samples_.size(); ++k) {
    const fsw::Duration flown = engine_.report(k).time;
    latest = std::max(latest, flown);
    if (last_samples_[k] && flown < last_samples_[k]->time) behind = std::min(behind.value_or(flown), flown);
  }
  return behind.value_or(latest);
}

}  // namespace vbar::grand::bench
