#include "boards/posix/receiver_line.h"

#include <array>
#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

#include "boards/posix/endpoints.h"

namespace vbar::boards::posix {

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

}  // namespace vbar::boards::posix
