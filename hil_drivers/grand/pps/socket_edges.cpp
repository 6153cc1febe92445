#include "hil_drivers/grand/pps/socket_edges.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/datagram_protocol.hpp>
#include <fmt/format.h>
#include <poll.h>

#include "hil_drivers/grand/wire/pps_datagram.h"

namespace vbar::grand {
namespace {

namespace asio = boost::asio;
using asio::local::datagram_protocol;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// After this silence the sender may be another one, which does not have this client among its subscribers.
constexpr std::chrono::seconds kSubscribeAgainAfter{2};

datagram_protocol::endpoint endpoint_of(const std::string& path) {
  try {
    return {path};
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(fmt::format("socket:{}: {}", path, error.code().message()));
  }
}

class SocketEdges final : public EdgeSource {
 public:
  explicit SocketEdges(const std::string& path) : path_(path), sender_(endpoint_of(path)), socket_(context_) {
    error_code error;
    socket_.open(datagram_protocol(), error);
    // An empty endpoint: the system chooses an address, to which the sender can reply.
    if (!error) socket_.bind(datagram_protocol::endpoint(), error);
    if (!error) socket_.non_blocking(true, error);
    if (error) throw std::runtime_error(fmt::format("{}: {}", description(), error.message()));
  }

  std::optional<Edge> next(Clock::time_point deadline) override {
    for (;;) {
      if (const auto edge = receive()) return edge;
      const Clock::time_point now = Clock::now();
      if (now >= subscribe_at_) subscribe(now);
      if (now >= deadline) return receive();
      wait(std::min(deadline, subscribe_at_) - now);
    }
  }

  [[nodiscard]] std::string description() const override { return "socket:" + path_; }
  [[nodiscard]] std::uint64_t malformed() const override { return malformed_; }

 private:
  /// A connected socket receives from its peer only. That no sender is there is not an error: the bench may start
  /// later.
  void subscribe(Clock::time_point now) {
    constexpr std::chrono::milliseconds kRetryAfter{200};
    constexpr std::array<std::uint8_t, 1> kRequest{1};
    error_code error;
    socket_.connect(sender_, error);
    if (!error) socket_.send(asio::buffer(kRequest), 0, error);
    subscribe_at_ = now + (error ? Clock::duration(kRetryAfter) : Clock::duration(kSubscribeAgainAfter));
  }

  std::optional<Edge> receive() {
    // A flood of malformed datagrams does not hold the caller.
    constexpr int kMaxDatagrams = 64;
    for (int k = 0; k < kMaxDatagrams; ++k) {
      std::array<std::uint8_t, wire::kPpsDatagramBytes + 1> bytes{};
      error_code error;
      const std::size_t size = socket_.receive(asio::buffer(bytes), 0, error);
      if (error) return std::nullopt;  // nothing there, or the sender has gone
      if (const auto datagram = wire::decode_pps_datagram(std::span(bytes).first(size))) {
        subscribe_at_ = Clock::now() + kSubscribeAgainAfter;
        return Edge{datagram->gps, std::chrono::nanoseconds(datagram->monotonic_ns), datagram->count};
      }
      ++malformed_;
    }
    return std::nullopt;
  }

  void wait(Clock::duration limit) {
    pollfd poll{socket_.native_handle(), POLLIN, 0};
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(limit).count();
    ::poll(&poll, 1, static_cast<int>(std::clamp<std::int64_t>(ms, 0, 1000)));
  }

  std::string path_;
  datagram_protocol::endpoint sender_;
  asio::io_context context_;
  datagram_protocol::socket socket_;
  Clock::time_point subscribe_at_{};
  std::uint64_t malformed_ = 0;
};

}  // namespace

const EdgeSourceKind kSocketEdges{
    "socket", "socket:PATH", true,
    [](const std::string& path) -> std::unique_ptr<EdgeSource> { return std::make_unique<SocketEdges>(path); }};

}  // namespace vbar::grand
