#include "hil_drivers/zaber/device/device_server.h"

#include <span>
#include <string>

#include "hil_drivers/bench_lines/host_line.h"
#include "hil_drivers/bench_lines/sockets.h"
#include "hil_drivers/wire/line_buffer.h"

namespace vbar::zaber {

using Bytes = std::span<const std::uint8_t>;

struct DeviceServer::Lines {
  Lines(DeviceServer& owner, boost::asio::io_context& context, Device& emulated, const std::filesystem::path& terminal,
        std::uint16_t port)
      : server(owner),
        device(emulated),
        serial(context, terminal, [this](Bytes bytes, unsigned) { serial.write(answers(from_serial, bytes)); }),
        listener(std::make_shared<bench_lines::Listener>(context, port)) {
    listener->start([this]() -> bench_lines::Connection::Receive {
      return [this, lines = std::make_shared<wire::LineBuffer>()](bench_lines::Connection& connection, Bytes bytes) {
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
  bench_lines::HostLine serial;
  std::shared_ptr<bench_lines::Listener> listener;
};

DeviceServer::DeviceServer(boost::asio::io_context& context, Device& device, const std::filesystem::path& terminal,
                           std::uint16_t tcp_port)
    : lines_(std::make_unique<Lines>(*this, context, device, terminal, tcp_port)) {}

DeviceServer::~DeviceServer() = default;

std::uint16_t DeviceServer::tcp_port() const {
  return lines_->listener->port();
}

}  // namespace vbar::zaber
