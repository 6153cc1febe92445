#pragma once
// Driver's end of a control connection: every wait has a limit, and every error is one sentence with generator, command
// and answer.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hil_drivers/grand/wire/skydel.h"
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

// Control connection to one Skydel instance.

class SkydelControl {
 public:
  /// Connects and exchanges the version of the API. Throws std::runtime_error, as all functions below.
  SkydelControl(const std::string& host, std::uint16_t port, std::chrono::milliseconds answer_limit);

  /// Sends a command and returns its result, which must have the name `expected`. `more_time` is the time that the
  /// command may take beyond the limit of every answer.
  wire::Json call(std::string_view name, const wire::Json& fields = wire::Json::object(),
                  std::string_view expected = "SuccessResult", std::chrono::milliseconds more_time = {});

  [[noreturn]] void fail(std::string_view command, std::string_view problem) const {
    connection_.fail(command, problem);
  }

 private:
  wire::SkydelFrame next_frame(std::string_view command, io::Clock::time_point deadline);

  ControlConnection connection_;
  wire::SkydelFrames frames_;
  std::uint64_t commands_ = 0;
};

}  // namespace vbar::grand
