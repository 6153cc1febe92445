#include "hil_drivers/gige/camera/camera_presence.h"

#include <array>
#include <stdexcept>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <poll.h>

#include "hil_drivers/gige/wire/gvcp.h"

namespace vbar::gige {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

constexpr std::uint32_t kControlPrivilege = 0xA00;  // readable by all, whoever owns the camera

udp::socket connected(asio::io_context& context, const std::string& address) {
  error_code error;
  const auto peer = asio::ip::make_address_v4(address, error);
  if (error) throw std::invalid_argument("this is not an IPv4 address");
  udp::socket socket(context, udp::v4());
  socket.connect(udp::endpoint(peer, wire::kGvcpPort), error);
  if (error) throw std::runtime_error("no network interface routes to it: " + error.message());
  return socket;
}

bool is_answer(wire::ByteSpan datagram, std::uint16_t id) {
  try {
    return wire::decode_acknowledge(datagram).id == id;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

}  // namespace

std::string routing_address(const std::string& address) {
  asio::io_context context;
  return connected(context, address).local_endpoint().address().to_string();
}

bool camera_answers(const std::string& address, int tries, std::chrono::milliseconds wait) {
  asio::io_context context;
  udp::socket socket = connected(context, address);
  socket.non_blocking(true);
  std::array<std::uint8_t, 1024> buffer{};
  for (int attempt = 1; attempt <= tries; ++attempt) {
    const auto id = static_cast<std::uint16_t>(attempt);
    error_code error;
    socket.send(asio::buffer(wire::encode_command({true, id, wire::ReadRegisters{{kControlPrivilege}}})), 0, error);
    const auto deadline = std::chrono::steady_clock::now() + wait;
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0) break;
      pollfd ready{socket.native_handle(), POLLIN, 0};
      if (::poll(&ready, 1, static_cast<int>(left.count())) <= 0) break;
      const std::size_t n = socket.receive(asio::buffer(buffer), 0, error);
      // A port without a program reports itself as an error: the next attempt waits for a camera that starts.
      if (!error && is_answer(wire::ByteSpan(buffer).first(n), id)) return true;
    }
  }
  return false;
}

}  // namespace vbar::gige
