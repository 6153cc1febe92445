#include "boards/posix/flight_main.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>

#include <unistd.h>

#include "boards/common/flight_executive.h"
#include "boards/posix/links.h"
#include "boards/posix/stack_meter.h"
#include "boards/posix/telecommand_key_file.h"

namespace vbar::boards::posix {
namespace {

constexpr const char* kUsage =
    "usage: %s LINK [--receiver DEVICE] [--telecommand-key FILE]\n"
    "the flight software as a process of its own; LINK is one of\n"
    "  --serial DEVICE [--baud N]             a serial device or pseudo-terminal, 921600 baud unless said otherwise\n"
    "  --unix PATH                            a Unix stream socket on which the host listens\n"
    "  --udp ADDRESS:PORT [--peer HOST:PORT]  listen for datagrams; without --peer, of the first sender of a hello\n"
    "  --stream FD                            an open stream, inherited\n"
    "  --datagram FD [--peer HOST:PORT]       a bound UDP socket, inherited\n"
    "DEVICE is the serial device of a GNSS receiver that is wired to this flight computer\n"
    "FILE holds the key that telecommands need: 64 hexadecimal digits, readable by its owner alone\n";

struct Options {
  const char* serial = nullptr;
  const char* unix_path = nullptr;
  const char* udp = nullptr;
  const char* stream = nullptr;
  const char* datagram = nullptr;
  const char* peer = nullptr;
  const char* receiver = nullptr;
  const char* telecommand_key = nullptr;
  const char* baud = "921600";
};

bool parse(int argc, char** argv, Options& options) {
  struct Known {
    const char* name;
    const char** value;
  };
  const std::array known{Known{"--serial", &options.serial},
                         Known{"--unix", &options.unix_path},
                         Known{"--udp", &options.udp},
                         Known{"--stream", &options.stream},
                         Known{"--datagram", &options.datagram},
                         Known{"--peer", &options.peer},
                         Known{"--baud", &options.baud},
                         Known{"--receiver", &options.receiver},
                         Known{"--telecommand-key", &options.telecommand_key}};
  for (int i = 1; i < argc; i += 2) {
    const char** value = nullptr;
    for (const Known& option : known) {
      if (std::strcmp(argv[i], option.name) == 0) value = option.value;
    }
    if (value == nullptr || i + 1 >= argc) return false;
    *value = argv[i + 1];
  }
  const std::array links{options.serial, options.unix_path, options.udp, options.stream, options.datagram};
  int chosen = 0;
  for (const char* link : links) chosen += link != nullptr ? 1 : 0;
  return chosen == 1;
}

/// An inherited descriptor's number; -1 with EBADF if the text is not one.
int inherited(const char* text) {
  std::uint32_t fd = 0;
  if (parse_number(text, INT32_MAX, fd)) return static_cast<int>(fd);
  errno = EBADF;
  return -1;
}

int open_stream(const Options& options) {
  std::uint32_t baud = 0;
  if (options.unix_path != nullptr) return connect_unix(options.unix_path);
  if (options.serial != nullptr) {
    return parse_number(options.baud, UINT32_MAX, baud) ? open_serial(options.serial, baud)
                                                        : open_serial(options.serial, 0);
  }
  const int fd = inherited(options.stream);
  return fd >= 0 && make_raw_if_terminal(fd) ? fd : -1;
}

int open_datagram(const Options& options) {
  if (options.datagram != nullptr) return inherited(options.datagram);
  sockaddr_in address{};
  if (parse_address(options.udp, address)) return bind_udp(address);
  errno = EINVAL;
  return -1;
}

/// Its memory is static, because it is large; it is constructed when its link exists.
alignas(FlightExecutive) std::array<std::byte, sizeof(FlightExecutive)> executive_memory;

std::uint32_t measure_stack(void* /*context*/) {
  return stack_high_water();
}

template <class Link>
struct Flight {
  const char* name;
  Link* link;
  ReceiverLine* receiver;
  const fsw::packets::TelecommandSecurity* security;
  LinkEnd end;

  static Flight& of(void* context) { return *static_cast<Flight*>(context); }
  static void send(void* context, std::span<const std::uint8_t> frame) { Link::send(of(context).link, frame); }
  static bool open_receiver(void* context, std::uint32_t baud) { return of(context).receiver->open(baud); }
  static std::size_t read_receiver(void* context, std::span<std::uint8_t> out) {
    return of(context).receiver->read(out);
  }

  static void fly(void* context) {
    Flight& flight = of(context);
    Platform platform;
    platform.context = context;
    platform.name = flight.name;
    platform.send = &Flight::send;
    platform.stack_high_water = &measure_stack;
    platform.open_receiver = &Flight::open_receiver;
    platform.read_receiver = &Flight::read_receiver;
    platform.telecommand_security = flight.security;
    auto* const executive = ::new (static_cast<void*>(executive_memory.data())) FlightExecutive(platform);
    flight.end = flight.link->serve(*executive, flight.receiver);
  }
};

template <class Link>
int fly(const char* name, Link& link, const Options& options) {
  ReceiverLine receiver(options.receiver);
  fsw::packets::TelecommandSecurity security;
  const char* const path = options.telecommand_key;
  const char* const fault = path == nullptr ? nullptr : read_telecommand_key(path, security);
  if (fault != nullptr) {
    std::fprintf(stderr, "%s: key of telecommands %s %s\n", name, path, fault);
    return 1;
  }
  Flight<Link> flight{name, &link, &receiver, path == nullptr ? nullptr : &security, LinkEnd::kFailed};
  if (run_on_measured_stack(&Flight<Link>::fly, &flight) && flight.end != LinkEnd::kFailed) return 0;
  std::fprintf(stderr, "%s: the link failed: %s\n", name, std::strerror(errno));
  return 1;
}

int refuse(const char* program, const char* what) {
  std::fprintf(stderr, "%s: %s: %s\n", program, what, std::strerror(errno));
  return 1;
}

int fly_over_datagrams(const char* name, const char* program, const Options& options) {
  sockaddr_in peer{};
  if (options.peer != nullptr && !parse_address(options.peer, peer)) {
    errno = EINVAL;
    return refuse(program, options.peer);
  }
  const int fd = open_datagram(options);
  if (fd < 0) return refuse(program, options.udp != nullptr ? options.udp : options.datagram);
  DatagramLink link = options.peer != nullptr ? DatagramLink(fd, peer) : DatagramLink(fd);
  return fly(name, link, options);
}

int fly_over_stream(const char* name, const char* program, const Options& options) {
  const int fd = open_stream(options);
  if (fd < 0) {
    return refuse(program, options.serial != nullptr      ? options.serial
                           : options.unix_path != nullptr ? options.unix_path
                                                          : options.stream);
  }
  StreamLink link(fd);
  return fly(name, link, options);
}

}  // namespace

int flight_main(const char* name, int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::fprintf(stderr, kUsage, argv[0]);
    return 2;
  }
  // A host that has ended results in a failed write, which ends this program in an orderly way.
  (void)std::signal(SIGPIPE, SIG_IGN);
  const bool datagrams = options.udp != nullptr || options.datagram != nullptr;
  return datagrams ? fly_over_datagrams(name, argv[0], options) : fly_over_stream(name, argv[0], options);
}

}  // namespace vbar::boards::posix
