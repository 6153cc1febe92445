#include "hil_drivers/grand/generators/control_connection.h"

#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/io/byte_channel.h"

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

namespace {

using wire::Json;

std::string error_message(const Json& result) {
  const auto message = result.find("ErrorMsg");
  return message != result.end() && message->is_string() ? wire::printable(message->get<std::string>()) : "no ErrorMsg";
}

}  // namespace

SkydelControl::SkydelControl(const std::string& host, std::uint16_t port, std::chrono::milliseconds answer_limit)
    : connection_("Skydel", host, port, answer_limit) {
  constexpr std::string_view kExchange = "API version";
  connection_.send(kExchange, wire::encode_api_version(wire::kSkydelApiVersion));
  const wire::SkydelFrame answer = next_frame(kExchange, connection_.answer_deadline());
  if (answer.kind != wire::SkydelFrameKind::kApiVersion) fail(kExchange, "the answer is not an API version");
  if (answer.api_version != wire::kSkydelApiVersion)
    fail(kExchange, fmt::format("the generator has {}, this driver {}", answer.api_version, wire::kSkydelApiVersion));
}

wire::SkydelFrame SkydelControl::next_frame(std::string_view command, io::Clock::time_point deadline) {
  try {
    for (;;) {
      if (auto frame = frames_.next()) return *frame;
      frames_.append(connection_.receive(command, deadline));
    }
  } catch (const wire::WireError& error) {
    fail(command, error.what());
  }
}

Json SkydelControl::call(std::string_view name, const Json& fields, std::string_view expected,
                         std::chrono::milliseconds more_time) {
  const std::string uuid = fmt::format("00000000-0000-4000-8000-{:012x}", ++commands_);
  connection_.send(name, wire::encode_command(wire::skydel_command(name, uuid, fields)));
  const auto deadline = connection_.answer_deadline() + more_time;
  for (;;) {
    const wire::SkydelFrame frame = next_frame(name, deadline);
    if (frame.kind != wire::SkydelFrameKind::kResult) fail(name, "the answer is not a result");
    try {
      // The answer to a command that was given up.
      if (wire::related_uuid(frame.json) != uuid) continue;
      const std::string result = wire::name_of(frame.json);
      if (result == wire::kSkydelFailure)
        fail(name, fmt::format("answered {}: {}", wire::kSkydelFailure, error_message(frame.json)));
      if (result != expected) fail(name, fmt::format("answered {} instead of {}", result, expected));
    } catch (const wire::WireError& error) {
      fail(name, error.what());
    }
    return frame.json;
  }
}

}  // namespace vbar::grand
