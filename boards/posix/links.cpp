#include "boards/posix/links.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

namespace vbar::boards::posix {

namespace {

struct Rate {
  std::uint32_t baud;
  speed_t code;
};
constexpr std::array kRates{Rate{2400, B2400},      Rate{4800, B4800},       Rate{9600, B9600},
                            Rate{19200, B19200},    Rate{38400, B38400},     Rate{57600, B57600},
                            Rate{115200, B115200},  Rate{230400, B230400},   Rate{460800, B460800},
                            Rate{921600, B921600},  Rate{1000000, B1000000}, Rate{2000000, B2000000},
                            Rate{3000000, B3000000}};

bool set_raw(int fd, const Rate* rate) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  if (rate != nullptr && ::cfsetspeed(&settings, rate->code) != 0) return false;
  return ::tcsetattr(fd, TCSANOW, &settings) == 0;
}

/// Closes `fd` and preserves errno.
int give_up(int fd) {
  const int reason = errno;
  ::close(fd);
  errno = reason;
  return -1;
}

}  // namespace

int open_serial(const char* device, std::uint32_t baud) {
  const Rate* rate = nullptr;
  for (const Rate& known : kRates) {
    if (known.baud == baud) rate = &known;
  }
  if (rate == nullptr) {
    errno = EINVAL;
    return -1;
  }
  const int fd = ::open(device, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (fd < 0) return -1;
  return set_raw(fd, rate) ? fd : give_up(fd);
}

int connect_unix(const char* path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (std::strlen(path) >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  std::strcpy(address.sun_path, path);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  return ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? fd : give_up(fd);
}

int bind_udp(const sockaddr_in& address) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  return ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? fd : give_up(fd);
}

bool make_raw_if_terminal(int fd) {
  return ::isatty(fd) == 0 || set_raw(fd, nullptr);
}

bool parse_address(const char* text, sockaddr_in& address) {
  const char* const colon = std::strrchr(text, ':');
  std::array<char, INET_ADDRSTRLEN> host{};
  if (colon == nullptr || static_cast<std::size_t>(colon - text) >= host.size()) return false;
  std::memcpy(host.data(), text, static_cast<std::size_t>(colon - text));
  std::uint32_t port = 0;
  address = {};
  address.sin_family = AF_INET;
  if (!parse_number(colon + 1, UINT16_MAX, port) || ::inet_pton(AF_INET, host.data(), &address.sin_addr) != 1)
    return false;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return true;
}

bool parse_number(const char* text, std::uint32_t limit, std::uint32_t& number) {
  std::uint64_t value = 0;
  if (*text == '\0') return false;
  for (; *text != '\0'; ++text) {
    if (*text < '0' || *text > '9') return false;
    value = 10 * value + static_cast<std::uint64_t>(*text - '0');
    if (value > limit) return false;
  }
  number = static_cast<std::uint32_t>(value);
  return true;
}

bool ReceiverLine::open(std::uint32_t baud) {
  close();
  if (device_ == nullptr || baud == 0) return false;
  baud_ = baud;
  if (!open_device()) {
    close();
    return false;
  }
  // Reading, not tcflush: it also reaches bytes that the kernel has not yet passed on to the terminal's queue.
  constexpr int kMaxPieces = 1024;
  std::array<std::uint8_t, 1024> discarded{};
  for (int k = 0; k < kMaxPieces && read(discarded) > 0; ++k) {
  }
  return true;
}

void ReceiverLine::close() {
  hang_up();
  baud_ = 0;
}

std::size_t ReceiverLine::read(std::span<std::uint8_t> out) {
  if (baud_ == 0 || (fd_ < 0 && !open_device())) return 0;
  for (;;) {
    const ssize_t count = ::read(fd_, out.data(), out.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && errno == EINTR) continue;
    if (count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK)) hang_up();
    return 0;
  }
}

bool ReceiverLine::open_device() {
  fd_ = open_serial(device_, baud_);
  if (fd_ < 0) return false;
  const int flags = ::fcntl(fd_, F_GETFL);
  if (flags >= 0 && ::fcntl(fd_, F_SETFL, flags | O_NONBLOCK) == 0) return true;
  hang_up();
  return false;
}

void ReceiverLine::hang_up() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

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
