#include "emulators/zaber/device.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "emulators/common/host_line.h"
#include "emulators/common/sockets.h"
#include "hil_drivers/wire/bytes.h"

namespace vbar::zaber {

namespace {

constexpr const char* kBadCommand = "BADCOMMAND";
constexpr const char* kBadData = "BADDATA";
constexpr const char* kBadAxis = "BADAXIS";
constexpr const char* kStatusBusy = "STATUSBUSY";
/// Steps of a speed: microsteps/s times this.
constexpr double kSpeedUnit = 1.6384;
constexpr std::int64_t kMaxPosition = 1'000'000'000;
constexpr std::uint64_t kFirstSerial = 30'000, kSerials = 10'000;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::optional<std::int64_t> integer_of(const std::string& word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || std::abs(value) > kMaxPosition) return std::nullopt;
  return value;
}

}  // namespace

Device::Device(const DeviceSettings& settings, std::function<double()> now_s)
    : settings_(settings), now_s_(std::move(now_s)) {
  for (std::size_t k = 0; k < settings.axes.size(); ++k)
    axes_.emplace_back(settings.axes[k], engine::RandomStream(settings.seed, fmt::format("rails/axis/{}", k + 1)));
}

Axis& Device::axis(std::size_t index) {
  axes_.at(index).advance(now_s_());
  return axes_[index];
}

std::vector<std::string> Device::answer(std::string_view line) {
  Command command;
  try {
    command = decode_command(line);
  } catch (const WireError&) {
    return {};
  }
  if (command.device != 0 && command.device != settings_.address) return {};
  Result result;
  // The state is that after the command; a move is under way even if it lasts no time.
  const bool is_status = command.text.empty() || command.text.starts_with("get ");
  if (is_status)
    for (Axis& axis : axes_) axis.advance(now_s_());
  if (command.axis > static_cast<int>(axes_.size()))
    result = {true, kBadAxis};
  else
    result = execute(command);
  Message reply = status_of(command);
  reply.is_rejected = result.is_rejected;
  reply.data = result.data;
  return {encode(reply)};
}

Message Device::status_of(const Command& command) const {
  Message reply;
  reply.device = settings_.address;
  reply.axis = command.axis;
  reply.id = command.id;
  reply.has_checksum = command.has_checksum;
  constexpr const char* kByGravity[] = {"FS", "WR", "WM", "NI"};
  std::size_t gravest = std::size(kByGravity);
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    if (command.axis != 0 && command.axis != static_cast<int>(k) + 1) continue;
    reply.is_busy = reply.is_busy || axes_[k].is_busy();
    const std::string warning = axes_[k].warning();
    for (std::size_t rank = 0; rank < gravest; ++rank)
      if (warning == kByGravity[rank]) gravest = rank;
  }
  if (gravest < std::size(kByGravity)) reply.warning = kByGravity[gravest];
  return reply;
}

Device::Result Device::execute(const Command& command) {
  const std::vector<std::string> words = words_of(command.text);
  if (words.empty()) return {};
  const double now_s = now_s_();
  if (command.axis != 0) return execute_on(axes_[static_cast<std::size_t>(command.axis - 1)], words, now_s);
  if (words.size() == 2 && words[0] == "get") {
    if (words[1] == "deviceid") return {false, "30222"};
    if (words[1] == "version") return {false, "6.16"};
    if (words[1] == "system.serial") return {false, std::to_string(kFirstSerial + settings_.seed % kSerials)};
    if (words[1] == "system.access") return {false, "1"};
    if (words[1] == "system.axiscount") return {false, std::to_string(axes_.size())};
    if (words[1] == "comm.alert" || words[1] == "comm.checksum") return {false, "0"};
    if (words[1] == "comm.address") return {false, std::to_string(settings_.address)};
  }
  if (words.size() == 3 && words[0] == "set" && words[1] == "comm.alert")
    return words[2] == "0" ? Result{} : Result{true, kBadData};
  Result all;
  std::string data;
  for (Axis& axis : axes_) {
    const Result one = execute_on(axis, words, now_s);
    if (one.is_rejected) return one;
    data += (data.empty() ? "" : " ") + one.data;
  }
  if (words[0] == "get") all.data = data;
  if (words[0] == "warnings") all.data = status_of(command).warning == "--" ? "00" : "01 " + status_of(command).warning;
  return all;
}

Device::Result Device::execute_on(Axis& axis, const std::vector<std::string>& words, double now_s) {
  const std::string& verb = words[0];
  if (verb == "home" && words.size() == 1) return axis.home(now_s), Result{};
  if ((verb == "stop" || verb == "estop") && words.size() == 1) return axis.stop(now_s), Result{};
  if (verb == "move") return move(axis, words, now_s);
  if (verb == "get" && words.size() == 2) {
    axis.advance(now_s);
    const std::string value = value_of(axis, words[1]);
    return value.empty() ? Result{true, kBadCommand} : Result{false, value};
  }
  if (verb == "set" && words.size() == 3) {
    axis.advance(now_s);
    if (axis.is_busy() && words[1] == "pos") return {true, kStatusBusy};
    return set(axis, words[1], words[2]);
  }
  if (verb == "warnings" && (words.size() == 1 || (words.size() == 2 && words[1] == "clear"))) {
    const std::string warning = axis.warning();
    if (words.size() == 2) axis.clear_warnings();
    return {false, warning == "--" ? "00" : "01 " + warning};
  }
  return {true, kBadCommand};
}

Device::Result Device::move(Axis& axis, const std::vector<std::string>& words, double now_s) {
  if (words.size() < 2) return {true, kBadCommand};
  const std::string& kind = words[1];
  if (kind == "min" || kind == "max") {
    if (words.size() != 2) return {true, kBadCommand};
    if (!axis.is_homed()) return {true, kBadData};
    (void)axis.move_to(kind == "min" ? axis.limit_min() : axis.limit_max(), now_s);
    return {};
  }
  if ((kind != "abs" && kind != "rel" && kind != "vel") || words.size() != 3) return {true, kBadCommand};
  const auto value = integer_of(words[2]);
  if (!value) return {true, kBadData};
  if (kind == "vel") {
    axis.move_at(static_cast<double>(*value) / kSpeedUnit, now_s);
    return {};
  }
  axis.advance(now_s);
  const std::int64_t target = kind == "abs" ? *value : axis.count() + *value;
  return axis.move_to(target, now_s) ? Result{} : Result{true, kBadData};
}

std::string Device::value_of(const Axis& axis, const std::string& name) const {
  if (name == "pos") return std::to_string(axis.count());
  if (name == "maxspeed") return std::to_string(std::lround(axis.speed_um_s() / axis.microstep_um() * kSpeedUnit));
  if (name == "limit.min") return std::to_string(axis.limit_min());
  if (name == "limit.max") return std::to_string(axis.limit_max());
  if (name == "limit.home.triggered") return axis.is_homed() ? "1" : "0";
  if (name == "resolution") return "64";
  if (name == "peripheralid") return "0";  // the axis is part of the device
  return {};
}

Device::Result Device::set(Axis& axis, const std::string& name, const std::string& value) {
  const auto number = integer_of(value);
  constexpr std::array<std::string_view, 4> kWritable{"pos", "maxspeed", "limit.min", "limit.max"};
  if (std::ranges::find(kWritable, name) == kWritable.end()) return {true, kBadCommand};
  if (!number) return {true, kBadData};
  if (name == "pos") {
    axis.set_count(*number);
  } else if (name == "maxspeed") {
    if (*number < 1) return {true, kBadData};
    axis.set_speed(static_cast<double>(*number) * axis.microstep_um() / kSpeedUnit);
  } else if (name == "limit.min") {
    if (*number > axis.limit_max()) return {true, kBadData};
    axis.set_limits(*number, axis.limit_max());
  } else {
    if (*number < axis.limit_min()) return {true, kBadData};
    axis.set_limits(axis.limit_min(), *number);
  }
  return {};
}

using Bytes = std::span<const std::uint8_t>;

struct DeviceServer::Lines {
  Lines(DeviceServer& owner, boost::asio::io_context& context, Device& emulated, const std::filesystem::path& terminal,
        std::uint16_t port)
      : server(owner),
        device(emulated),
        serial(context, terminal, [this](Bytes bytes, unsigned) { serial.write(answers(from_serial, bytes)); }),
        listener(std::make_shared<emulators::Listener>(context, port)) {
    listener->start([this]() -> emulators::Connection::Receive {
      return [this, lines = std::make_shared<wire::LineBuffer>()](emulators::Connection& connection, Bytes bytes) {
        connection.send(answers(*lines, bytes));
      };
    });
  }
  ~Lines() { listener->close(); }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  wire::Bytes answers(wire::LineBuffer& lines, Bytes bytes) {
    std::string text;
    lines.append(bytes);
    try {
      while (const auto line = lines.next())
        for (const std::string& reply : device.answer(*line)) text += reply + "\r\n";
    } catch (const wire::WireError&) {
      // A line that never ends: the buffer has discarded it.
    }
    if (!text.empty() && server.on_command) server.on_command();
    return {text.begin(), text.end()};
  }

  DeviceServer& server;
  Device& device;
  wire::LineBuffer from_serial;
  emulators::HostLine serial;
  std::shared_ptr<emulators::Listener> listener;
};

DeviceServer::DeviceServer(boost::asio::io_context& context, Device& device, const std::filesystem::path& terminal,
                           std::uint16_t tcp_port)
    : lines_(std::make_unique<Lines>(*this, context, device, terminal, tcp_port)) {}

DeviceServer::~DeviceServer() = default;

std::uint16_t DeviceServer::tcp_port() const {
  return lines_->listener->port();
}

}  // namespace vbar::zaber
