#include "emulators/grand/generator/edge_broadcaster.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/datagram_protocol.hpp>
#include <fmt/format.h>
#include <unistd.h>

namespace vbar::grand {
namespace {

namespace asio = boost::asio;
using asio::local::datagram_protocol;
using boost::system::error_code;

/// Subscribers that have ended are removed at the next edge; more than this at once are an error of a client.
constexpr std::size_t kMaxSubscribers = 16;

/// Returns true if a program is bound to the path, as opposed to a file that an ended program left.
bool is_in_use(asio::io_context& context, const datagram_protocol::endpoint& endpoint) {
  datagram_protocol::socket probe(context);
  error_code error;
  probe.open(datagram_protocol(), error);
  if (!error) probe.connect(endpoint, error);
  return !error;
}

}  // namespace

struct EdgeBroadcaster::State {
  explicit State(const std::string& socket_path) : path(socket_path), socket(context) {
    error_code error;
    try {
      const datagram_protocol::endpoint endpoint(path);
      socket.open(datagram_protocol(), error);
      if (!error) socket.bind(endpoint, error);
      if (error == asio::error::address_in_use && !is_in_use(context, endpoint)) {
        ::unlink(path.c_str());
        error = {};
        socket.bind(endpoint, error);
      }
      if (!error) socket.non_blocking(true, error);
    } catch (const boost::system::system_error& too_long) {
      error = too_long.code();
    }
    if (error) throw std::runtime_error(fmt::format("PPS socket {}: {}", path, error.message()));
  }

  void accept_subscribers() {
    constexpr int kMaxRequests = 64;
    for (int k = 0; k < kMaxRequests; ++k) {
      std::array<std::uint8_t, 1> request{};
      datagram_protocol::endpoint from;
      error_code error;
      socket.receive_from(asio::buffer(request), from, 0, error);
      if (error) return;
      const bool can_be_answered = !from.path().empty();
      if (can_be_answered && subscribers.size() < kMaxSubscribers &&
          std::ranges::find(subscribers, from) == subscribers.end())
        subscribers.push_back(from);
    }
  }

  void send_to_all(std::span<const std::uint8_t> bytes) {
    std::erase_if(subscribers, [&](const datagram_protocol::endpoint& subscriber) {
      error_code error;
      socket.send_to(asio::buffer(bytes.data(), bytes.size()), subscriber, 0, error);
      const bool queue_is_full = error == asio::error::would_block || error == asio::error::no_buffer_space;
      return error && !queue_is_full;
    });
  }

  std::string path;
  asio::io_context context;
  datagram_protocol::socket socket;
  std::vector<datagram_protocol::endpoint> subscribers;
};

EdgeBroadcaster::EdgeBroadcaster(const std::string& path) : state_(std::make_unique<State>(path)) {}

EdgeBroadcaster::~EdgeBroadcaster() {
  ::unlink(state_->path.c_str());
}

void EdgeBroadcaster::send(const wire::PpsDatagram& edge) {
  state_->accept_subscribers();
  wire::PpsDatagram sent = edge;
  sent.gps = sent.gps + jump_;
  sent.monotonic_ns += delay_.ns;
  delay_ = {};
  if (missing_ > 0) {
    --missing_;
    return;
  }
  const auto bytes = wire::encode_pps_datagram(sent);
  state_->send_to_all(bytes);
  if (doubled_ == 0) return;
  --doubled_;
  state_->send_to_all(bytes);
}

std::size_t EdgeBroadcaster::subscribers() const {
  return state_->subscribers.size();
}

}  // namespace vbar::grand
