#include "boards/posix/links.h"

#include <array>
#include <cerrno>
#include <ctime>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace vbar::boards::posix {
namespace {

void wait_until(int fd, short event) {
  pollfd request{.fd = fd, .events = event, .revents = 0};
  (void)::poll(&request, 1, -1);
}

/// Returns true if the call is to be repeated after `result` of a read or write, at once or when `event` has happened.
bool is_passing(int fd, short event) {
  if (errno == EINTR) return true;
  if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
  wait_until(fd, event);
  return true;
}

/// Waits until `link` can be read; meanwhile the executive takes what the receiver brings.
void wait_for_link(int link, FlightExecutive& executive, const ReceiverLine* receiver) {
  for (;;) {
    const int receiver_fd = receiver != nullptr && executive.has_receiver() ? receiver->fd() : -1;
    if (receiver_fd < 0) return;  // the read of the link waits
    std::array<pollfd, 2> requests{
        {{.fd = link, .events = POLLIN, .revents = 0}, {.fd = receiver_fd, .events = POLLIN, .revents = 0}}};
    if (::poll(requests.data(), requests.size(), -1) < 0 && errno != EINTR) return;
    if (requests[1].revents != 0) executive.read_receiver();
    if (requests[0].revents != 0) return;
  }
}

/// Errors by which a stream or a terminal reports that the other end is closed.
bool says_peer_gone(int error) {
  return error == EIO || error == EPIPE || error == ECONNRESET;
}

bool write_all(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    } else if (!is_passing(fd, POLLOUT)) {
      return false;
    }
  }
  return true;
}

std::uint64_t now_ms() {
  timespec now{};
  (void)::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1000U + static_cast<std::uint64_t>(now.tv_nsec) / 1'000'000U;
}

}  // namespace

void StreamLink::send(void* context, std::span<const std::uint8_t> frame) {
  auto* const link = static_cast<StreamLink*>(context);
  const auto size = fsw::link::cobs_encode(frame, link->coded_);
  if (!size.ok() || link->broken_) return;
  link->broken_ = !write_all(link->fd_, std::span(link->coded_).first(size.value()));
}

LinkEnd StreamLink::serve(FlightExecutive& executive, const ReceiverLine* receiver) {
  std::uint32_t rejected = 0;
  for (;;) {
    wait_for_link(fd_, executive, receiver);
    const ssize_t count = ::read(fd_, received_.data(), received_.size());
    if (count == 0) return LinkEnd::kPeerGone;
    if (count < 0) {
      if (is_passing(fd_, POLLIN)) continue;
      return says_peer_gone(errno) ? LinkEnd::kPeerGone : LinkEnd::kFailed;
    }
    for (const std::uint8_t byte : std::span(received_).first(static_cast<std::size_t>(count))) {
      const bool frame_complete = decoder_.push(byte);
      executive.count_rejected(decoder_.rejected() - rejected);
      rejected = decoder_.rejected();
      if (frame_complete && executive.on_frame(decoder_.frame()) == Activity::kGoodbye) return LinkEnd::kGoodbye;
    }
    if (broken_) return LinkEnd::kPeerGone;
  }
}

void DatagramLink::send(void* context, std::span<const std::uint8_t> frame) {
  auto* const link = static_cast<DatagramLink*>(context);
  if (!link->peer_is_fixed_ && !link->guard_.has_peer()) return;
  const DatagramSender& peer = link->peer_is_fixed_ ? link->fixed_peer_ : link->guard_.peer();
  const auto* const address = reinterpret_cast<const sockaddr*>(&peer.address);
  // A datagram that the system does not accept is lost, and requested again.
  while (::sendto(link->fd_, frame.data(), frame.size(), 0, address, sizeof peer.address) < 0 && errno == EINTR) {
  }
}

LinkEnd DatagramLink::serve(FlightExecutive& executive, const ReceiverLine* receiver) {
  for (;;) {
    wait_for_link(fd_, executive, receiver);
    DatagramSender sender;
    socklen_t length = sizeof sender.address;
    auto* const address = reinterpret_cast<sockaddr*>(&sender.address);
    const ssize_t count = ::recvfrom(fd_, received_.data(), received_.size(), 0, address, &length);
    if (count < 0) {
      // An earlier datagram of this program was not received: no reason to stop listening.
      if (errno == ECONNREFUSED || is_passing(fd_, POLLIN)) continue;
      return LinkEnd::kFailed;
    }
    const auto datagram = std::span<const std::uint8_t>(received_).first(static_cast<std::size_t>(count));
    if (!admits(sender, datagram)) {
      executive.count_rejected(1);
    } else if (executive.on_frame(datagram) == Activity::kGoodbye) {
      return LinkEnd::kGoodbye;
    }
  }
}

bool DatagramLink::admits(const DatagramSender& sender, std::span<const std::uint8_t> datagram) {
  return peer_is_fixed_ ? sender == fixed_peer_ : guard_.admits(sender, datagram, now_ms());
}

}  // namespace vbar::boards::posix
