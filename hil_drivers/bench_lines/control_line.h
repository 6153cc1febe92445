#pragma once
// The control line of an emulated bench: a Unix stream socket. Each line that comes in is one command; the answer is
// one line: what the handler answers, at once or later, or {"error": "..."}.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

namespace vbar::bench_lines {

/// Without effect once the client has gone.
using Answer = std::function<void(const std::string& line)>;

class ControlLine {
 public:
  /// What it throws becomes the error of the answer.
  using Handler = std::function<void(const std::string& line, const Answer& answer)>;

  /// Throws std::runtime_error if the socket cannot be made.
  ControlLine(boost::asio::io_context& context, const std::filesystem::path& path, Handler handler);
  ~ControlLine();
  ControlLine(const ControlLine&) = delete;
  ControlLine& operator=(const ControlLine&) = delete;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace vbar::bench_lines
