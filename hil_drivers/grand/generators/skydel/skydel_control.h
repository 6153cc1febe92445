#pragma once
// Control connection to one Skydel instance.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hil_drivers/grand/generators/control_connection.h"
#include "hil_drivers/grand/wire/skydel_control.h"

namespace vbar::grand {

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
