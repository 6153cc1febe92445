#include "boards/posix/endpoints.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fcntl.h>
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

}  // namespace vbar::boards::posix
