#include "hil_drivers/grand/generators/control_connection.h"

#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/io/byte_channels.h"

namespace vbar::grand {

ControlConnection::ControlConnection(const std::string& generator, const std::string& host, std::uint16_t port,
                                     std::chrono::milliseconds answer_limit)
    : name_(fmt::format("{} at {}:{}", generator, host, port)), answer_limit_(answer_limit) {
  try {
    channel_ = io::connect_tcp(host, std::to_string(port), answer_deadline());
  } catch (const io::ChannelError& error) {
    fail("connecting", error.what());
  }
}

void ControlConnection::fail(std::string_view command, std::string_view problem) const {
  throw std::runtime_error(fmt::format("{}: {}: {}", name_, command, problem));
}

void ControlConnection::send(std::string_view command, std::span<const std::uint8_t> bytes) {
  try {
    channel_->write(bytes, answer_deadline());
  } catch (const io::ChannelError& error) {
    fail(command, fmt::format("the command cannot be sent ({})", error.what()));
  }
}

std::span<const std::uint8_t> ControlConnection::receive(std::string_view command, io::Clock::time_point deadline) {
  std::span<const std::uint8_t> bytes;
  try {
    bytes = channel_->read(deadline);
  } catch (const io::ChannelError& error) {
    fail(command, fmt::format("the generator closed the connection ({})", error.what()));
  }
  if (bytes.empty())
    fail(command, fmt::format("no answer within {} s", std::chrono::duration<double>(answer_limit_).count()));
  return bytes;
}

std::span<const std::uint8_t> ControlConnection::poll(std::string_view command) {
  try {
    return channel_->read(io::Clock::now());
  } catch (const io::ChannelError& error) {
    fail(command, fmt::format("the generator closed the connection ({})", error.what()));
  }
}

}  // namespace vbar::grand
