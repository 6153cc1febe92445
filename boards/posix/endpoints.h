#pragma once
// Endpoints of frame links. Functions that return a file descriptor return -1 and leave errno on failure.

#include <cstdint>

#include <netinet/in.h>

namespace vbar::boards::posix {

/// Opens a serial device: raw, 8N1, no flow control, modem lines ignored. An unknown baud rate: EINVAL.
int open_serial(const char* device, std::uint32_t baud);

/// Connects to a listening Unix stream socket.
int connect_unix(const char* path);

/// Opens a UDP socket bound to `address`.
int bind_udp(const sockaddr_in& address);

/// Puts `fd` into raw mode if it is a terminal. Returns false if that fails.
bool make_raw_if_terminal(int fd);

/// Converts "127.0.0.1:5000" to an address; false if `text` is not one.
bool parse_address(const char* text, sockaddr_in& address);

/// Reads a decimal number up to `limit`; false if `text` is not one.
bool parse_number(const char* text, std::uint32_t limit, std::uint32_t& number);

}  // namespace vbar::boards::posix
