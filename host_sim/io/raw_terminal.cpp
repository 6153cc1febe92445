#include "host_sim/io/raw_terminal.h"

#include <cerrno>
#include <cstring>

#include <termios.h>

#include "host_sim/io/byte_channel.h"

namespace vbar::io {

void set_raw(int terminal, const std::string& description) {
  const auto fail = [&] { throw ChannelError(description + ": " + std::strerror(errno)); };
  termios settings{};
  if (::tcgetattr(terminal, &settings) != 0) fail();
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  if (::tcsetattr(terminal, TCSANOW, &settings) != 0) fail();
}

}  // namespace vbar::io
