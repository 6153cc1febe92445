#pragma once
// Driver's end of a control connection: every wait has a limit, and every error is one sentence with generator, command
// and answer.

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "host_sim/io/byte_channel.h"

namespace vbar::grand {

class ControlConnection {
 public:
  /// Connects; `generator` is the name in errors ("Skydel"). Throws std::runtime_error, as all functions below.
  ControlConnection(const std::string& generator, const std::string& host, std::uint16_t port,
                    std::chrono::milliseconds answer_limit);

  void send(std::string_view command, std::span<const std::uint8_t> bytes);
  /// Returns the bytes that arrive next, at least one.
  std::span<const std::uint8_t> receive(std::string_view command, io::Clock::time_point deadline);
  /// Returns bytes that have arrived without a command, if any; a closed connection is detected in this way.
  std::span<const std::uint8_t> poll(std::string_view command);

  [[nodiscard]] io::Clock::time_point answer_deadline() const { return io::Clock::now() + answer_limit_; }
  /// Throws "Skydel at 127.0.0.1:4820: StartPPS: PROBLEM".
  [[noreturn]] void fail(std::string_view command, std::string_view problem) const;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::chrono::milliseconds answer_limit_;
  std::unique_ptr<io::ByteChannel> channel_;
};

}  // namespace vbar::grand
