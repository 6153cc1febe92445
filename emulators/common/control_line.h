#pragma once
// Control line of an emulator: a Unix stream socket. Each line received is one command. The answer is one line, which
// the handler gives at once or later, or {"error": "..."}.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <toml++/toml.h>

namespace vbar::emulators {

/// Sends the answer; without effect once the client has gone.
using Answer = std::function<void(const std::string& line)>;

class ControlLine {
 public:
  /// Executes a command. An exception becomes the error of the answer.
  using Handler = std::function<void(const std::string& line, const Answer& answer)>;

  /// Opens the socket. Throws std::runtime_error if it cannot be made.
  ControlLine(boost::asio::io_context& context, const std::filesystem::path& path, Handler handler);
  ~ControlLine();
  ControlLine(const ControlLine&) = delete;
  ControlLine& operator=(const ControlLine&) = delete;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

// Command on a control line: a JSON object with the keys of a table in the scenario file of the emulator.

/// Returns the table of a JSON object whose values are numbers and texts. `where` and `example` stand in the message.
/// Throws mission::MissionError.
[[nodiscard]] toml::table table_of_json(const std::string& line, const std::string& where, std::string_view example);

}  // namespace vbar::emulators
