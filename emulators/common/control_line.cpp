#include "emulators/common/control_line.h"

#include <cstdint>
#include <stdexcept>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "host_sim/mission/mission_error.h"

namespace vbar::emulators {

namespace {

namespace asio = boost::asio;
using asio::local::stream_protocol;
using boost::system::error_code;

constexpr std::size_t kMaxLine = 4096;

std::string error_line(const std::string& reason) {
  return nlohmann::json{{"error", reason}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

struct ControlLine::State {
  State(asio::io_context& context, Handler line_handler) : acceptor(context), handler(std::move(line_handler)) {}

  stream_protocol::acceptor acceptor;
  Handler handler;
};

namespace {

/// One client; it lives as long as something is under way on it.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(stream_protocol::socket socket, ControlLine::Handler handler)
      : socket_(std::move(socket)), handler_(std::move(handler)) {}

  void read() {
    asio::async_read_until(socket_, asio::dynamic_buffer(received_, kMaxLine), '\n',
                           [self = shared_from_this()](const error_code& error, std::size_t size) {
                             if (error == asio::error::not_found) self->answer(error_line("a line that is too long"));
                             if (error) return;
                             const std::string line = self->received_.substr(0, size - 1);
                             self->received_.erase(0, size);
                             self->handle(line);
                             self->read();
                           });
  }

 private:
  void handle(const std::string& line) {
    try {
      handler_(line, [weak = weak_from_this()](const std::string& text) {
        if (const auto client = weak.lock()) client->answer(text);
      });
    } catch (const std::exception& error) {
      answer(error_line(error.what()));
    }
  }

  // A line is short: what the socket does not take at once belongs to a client that does not read.
  void answer(const std::string& line) {
    error_code ignored;
    asio::write(socket_, asio::buffer(line + "\n"), ignored);
  }

  stream_protocol::socket socket_;
  ControlLine::Handler handler_;
  std::string received_;
};

template <class State>
void accept_next(const std::shared_ptr<State>& state) {
  state->acceptor.async_accept([state](const error_code& error, stream_protocol::socket socket) {
    if (error) return;
    std::make_shared<Client>(std::move(socket), state->handler)->read();
    accept_next(state);
  });
}

}  // namespace

ControlLine::ControlLine(asio::io_context& context, const std::filesystem::path& path, Handler handler)
    : state_(std::make_shared<State>(context, std::move(handler))) {
  try {
    std::filesystem::remove(path);
    state_->acceptor.open();
    state_->acceptor.bind(stream_protocol::endpoint(path.string()));
    state_->acceptor.listen();
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: the control line cannot be made: {}", path.string(), error.what()));
  }
  accept_next(state_);
}

ControlLine::~ControlLine() {
  error_code ignored;
  const auto endpoint = state_->acceptor.local_endpoint(ignored);
  state_->acceptor.close(ignored);
  ::unlink(endpoint.path().c_str());
}

toml::table table_of_json(const std::string& line, const std::string& where, std::string_view example) {
  const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  if (!object.is_object())
    throw mission::MissionError(where, "", "something else",
                                "one JSON object in a line, such as " + std::string(example));
  toml::table table;
  for (const auto& [key, value] : object.items()) {
    if (value.is_string())
      table.insert(key, value.get<std::string>());
    else if (value.is_number_integer())
      table.insert(key, value.get<std::int64_t>());
    else if (value.is_number())
      table.insert(key, value.get<double>());
    else
      throw mission::MissionError(where, key, value.dump().substr(0, 80), "a number or a text");
  }
  return table;
}

}  // namespace vbar::emulators
