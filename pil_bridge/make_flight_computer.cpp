#include "pil_bridge/make_flight_computer.h"

#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "boards/common/flight_executive.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/io/udp_socket.h"
#include "pil_bridge/qemu.h"
#include "pil_bridge/remote_computer.h"
#include "pil_bridge/telecommand_security.h"
#include "pil_bridge/test_article.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {
namespace {

constexpr std::array<std::pair<std::string_view, Target>, 5> kTargets{{{"in_process", Target::kInProcess},
                                                                       {"host_process", Target::kHostProcess},
                                                                       {"zynq_qemu", Target::kZynqQemu},
                                                                       {"zynq_linux_qemu", Target::kZynqLinuxQemu},
                                                                       {"board", Target::kBoard}}};
constexpr std::array<std::pair<std::string_view, LinkKind>, 3> kLinks{
    {{"serial", LinkKind::kSerial}, {"pty", LinkKind::kPty}, {"udp", LinkKind::kUdp}}};

template <class Table>
auto look_up(const Table& table, std::string_view name, std::string_view what) {
  std::string accepted;
  for (const auto& [known, value] : table) {
    if (known == name) return value;
    accepted += (accepted.empty() ? "" : ", ") + std::string(known);
  }
  throw std::invalid_argument("'" + std::string(name) + "' is no " + std::string(what) + "; accepted: " + accepted);
}

template <class Table, class Value>
std::string_view name_in(const Table& table, Value value) {
  for (const auto& [name, known] : table) {
    if (known == value) return name;
  }
  return "unknown";
}

// An endpoint of a board that is not a device.
constexpr std::string_view kUnix = "unix:";
constexpr std::string_view kTcp = "tcp:";

/// Number of the first inherited descriptor in a started program.
constexpr int kChildLinkFd = 3;
constexpr int kPortAttempts = 3;

/// The two ends of a link to a program not yet started.
struct ChildLink {
  std::unique_ptr<FrameTransport> transport;
  io::FileDescriptor child_end;
  std::vector<std::string> flight_arguments;  ///< arguments by which vbar_flight is given its end
};

std::unique_ptr<FrameTransport> finish(std::unique_ptr<FrameTransport> transport,
                                       const FlightComputerOptions& options) {
  if (!options.faults.any_frame_fault()) return transport;
  return with_frame_faults(std::move(transport), options.faults);
}

std::unique_ptr<FrameTransport> finish(std::unique_ptr<ByteChannel> channel, const FlightComputerOptions& options) {
  if (options.paced_bits_per_s > 0.0) channel = io::paced(std::move(channel), options.paced_bits_per_s);
  if (options.faults.any_byte_fault()) channel = with_byte_faults(std::move(channel), options.faults);
  return finish(std::make_unique<StreamTransport>(std::move(channel)), options);
}

ChildLink make_child_link(const FlightComputerOptions& options) {
  const std::string fd = std::to_string(kChildLinkFd);
  switch (options.link) {
    case LinkKind::kSerial: {
      auto [ours, theirs] = io::make_socket_pair();
      return {finish(io::adopt_socket(std::move(ours), "stream socket"), options), std::move(theirs), {"--stream", fd}};
    }
    case LinkKind::kPty: {
      io::Pty pty = io::make_pty();
      return {finish(io::adopt_pty(std::move(pty.master), "pseudo-terminal " + pty.slave_path), options),
              std::move(pty.slave),
              {"--stream", fd}};
    }
    case LinkKind::kUdp:
      break;
  }
  io::BoundUdpSocket ours = io::bind_udp_loopback();
  io::BoundUdpSocket theirs = io::bind_udp_loopback();
  return {finish(make_udp_transport(std::move(ours.socket), "127.0.0.1", theirs.port), options),
          std::move(theirs.socket),
          {"--datagram", fd, "--peer", "127.0.0.1:" + std::to_string(ours.port)}};
}

std::string full_name(const FlightComputerOptions& options) {
  return std::string(name_of(options.target)) + " over " + std::string(name_of(options.link));
}

bool is_device(const std::string& endpoint) {
  return !endpoint.starts_with(kUnix) && !endpoint.starts_with(kTcp);
}

/// Returns the rate of the serial line, bits/s; 0: none, or as fast as it goes.
double line_rate(const FlightComputerOptions& options) {
  if (options.link == LinkKind::kUdp) return 0.0;
  if (options.target == Target::kBoard) return is_device(options.endpoint) ? options.baud : 0.0;
  return options.paced_bits_per_s;
}

RemoteParts parts_for(const FlightComputerOptions& options) {
  RemoteParts parts;
  parts.name = full_name(options);
  parts.timing = options.timing;
  parts.spacecraft = options.spacecraft;
  parts.receiver = options.receiver;
  parts.line_bits_per_s = line_rate(options);
  if (options.target == Target::kZynqQemu || options.target == Target::kBoard) parts.step_budget = options.step_budget;
  return parts;
}

/// Arguments of vbar_flight for its link, for the receiver that is wired to it, and for its key of telecommands.
std::vector<std::string> flight_arguments(const ChildLink& link, const FlightComputerOptions& options) {
  std::vector<std::string> arguments = link.flight_arguments;
  if (options.receiver) arguments.insert(arguments.end(), {"--receiver", options.receiver->device});
  if (!options.telecommand_key_file.empty())
    arguments.insert(arguments.end(), {"--telecommand-key", options.telecommand_key_file});
  return arguments;
}

/// A receiver is wired only to a flight computer that has a line for it.
void check_receiver(const FlightComputerOptions& options) {
  if (!options.receiver) return;
  const std::string wired = "sensors.gnss.wired = \"board\": ";
  if (options.target == Target::kInProcess)
    throw FlightComputerError(wired +
                              "the flight computer in_process has no line for a receiver; set flight_computer.target "
                              "to host_process, zynq_qemu, zynq_linux_qemu or board");
  if (options.target == Target::kZynqQemu && options.link != LinkKind::kUdp)
    throw FlightComputerError(wired +
                              "the receiver needs UART0 of zynq_qemu, which is its link; set flight_computer.link to "
                              "udp");
  if (options.target != Target::kBoard && options.receiver->device.empty())
    throw FlightComputerError(wired + "the device of the receiver's log port is unknown");
}

/// Discards what a line has brought before the flight computer was started: an emulator would pass a part of it on.
void discard_received(const io::WiredReceiver& receiver) {
  const auto line = io::open_serial(receiver.device, receiver.baud);
  constexpr std::chrono::milliseconds kQuiet{20};
  while (!line->read(Clock::now() + kQuiet).empty()) {
  }
}

std::unique_ptr<io::ChildProcess> start(const std::vector<std::string>& arguments, std::uint64_t memory_bytes,
                                        std::vector<io::FileDescriptor> inherited = {}) {
  try {
    return std::make_unique<io::ChildProcess>(arguments, std::move(inherited), memory_bytes);
  } catch (const std::system_error& error) {
    throw FlightComputerError(error.what());
  }
}

std::vector<io::FileDescriptor> only(io::FileDescriptor descriptor) {
  std::vector<io::FileDescriptor> list;
  list.push_back(std::move(descriptor));
  return list;
}

/// Places of an image in the build and the installation, relative to the folder of the running program, and the CMake
/// preset that builds it.
struct BuiltImage {
  const char* built;
  const char* installed;
  const char* preset;
};

BuiltImage built_image(Target target) {
  if (target == Target::kZynqQemu)
    return {"../zynq/vbar_zynq7000.elf", "../lib/vbar/zynq7000/vbar_zynq7000.elf", "zynq"};
  if (target == Target::kZynqLinuxQemu)
    return {"../zynq-linux/vbar_flight", "../lib/vbar/zynq7000_linux/vbar_flight", "zynq-linux"};
  return {"vbar_flight", "vbar_flight", "host"};
}

/// Throws FlightComputerError for a file that the emulated processor cannot execute.
void check_image(const std::string& image, Target target) {
  if (target != Target::kZynqQemu && target != Target::kZynqLinuxQemu) return;
  const std::string fault = fault_of_arm_image(image, target == Target::kZynqLinuxQemu);
  if (!fault.empty()) throw FlightComputerError("flight_computer.image '" + image + "': " + fault);
}

/// `options.image`, or the image that the build put beside the running program.
std::string find_image(const FlightComputerOptions& options) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto [built, installed, preset] = built_image(options.target);
  if (!options.image.empty()) {
    if (fs::is_regular_file(options.image, error)) {
      check_image(options.image, options.target);
      return options.image;
    }
    const std::string found = fs::exists(options.image, error) ? "is a folder or a device" : "there is no such file";
    throw FlightComputerError("flight_computer.image '" + options.image + "': " + found +
                              " (vbar's own is built by the CMake preset '" + preset + "')");
  }
  std::string image = beside_program(installed, built);
  if (!fs::is_regular_file(image, error)) {
    throw FlightComputerError("flight computer " + std::string(name_of(options.target)) + ": there is no image '" +
                              image + "' (built by the CMake preset '" + preset + "': cmake --build --preset " +
                              preset + ")");
  }
  return image;
}

std::unique_ptr<FlightComputer> make_host_process(const FlightComputerOptions& options) {
  const std::string image = find_image(options);
  ChildLink link = make_child_link(options);
  std::vector<std::string> arguments =
      options.image.empty() ? files::words_that_start(image) : std::vector<std::string>{image};
  const auto of_flight = flight_arguments(link, options);
  arguments.insert(arguments.end(), of_flight.begin(), of_flight.end());
  RemoteParts parts = parts_for(options);
  parts.process = start(arguments, options.memory_bytes, only(std::move(link.child_end)));
  parts.transport = std::move(link.transport);
  return std::make_unique<RemoteComputer>(std::move(parts));
}

std::unique_ptr<FlightComputer> make_zynq_linux_qemu(const FlightComputerOptions& options) {
  const std::string image = find_image(options);
  ChildLink link = make_child_link(options);
  RemoteParts parts = parts_for(options);
  parts.process = start(linux_arm_qemu(image, flight_arguments(link, options)), options.memory_bytes,
                        only(std::move(link.child_end)));
  parts.transport = std::move(link.transport);
  return std::make_unique<RemoteComputer>(std::move(parts));
}

std::unique_ptr<FlightComputer> make_zynq_qemu_over_udp(const FlightComputerOptions& options,
                                                        const std::string& image) {
  const std::string receiver = options.receiver ? options.receiver->device : "";
  if (options.receiver) discard_received(*options.receiver);
  for (int attempt = 1;; ++attempt) {
    // Found free, released, and taken by the emulator: another program may take it in between, hence the retry.
    const std::uint16_t port = io::bind_udp_loopback().port;
    RemoteParts parts = parts_for(options);
    parts.icount_shift = options.icount_shift;
    parts.process = start(zynq_qemu_over_udp(image, options.icount_shift, port, receiver), options.memory_bytes);
    parts.transport = finish(make_udp_transport("127.0.0.1", port), options);
    try {
      return std::make_unique<RemoteComputer>(std::move(parts));
    } catch (const FlightComputerError& error) {
      const bool port_taken = std::string_view(error.what()).find(kPortTakenMessage) != std::string_view::npos;
      if (!port_taken || attempt == kPortAttempts) throw;
    }
  }
}

std::unique_ptr<FlightComputer> make_zynq_qemu(const FlightComputerOptions& options) {
  if (options.icount_shift < kMinIcountShift || options.icount_shift > kGreatestIcountShift) {
    throw FlightComputerError("flight_computer.icount_shift is " + std::to_string(options.icount_shift) +
                              "; accepted: " + std::to_string(kMinIcountShift) + " to " +
                              std::to_string(kGreatestIcountShift));
  }
  const std::string image = find_image(options);
  if (options.link == LinkKind::kPty) throw FlightComputerError("zynq_qemu takes link serial or udp, not pty");
  if (options.link == LinkKind::kUdp) return make_zynq_qemu_over_udp(options, image);
  auto [ours, theirs] = io::make_socket_pair();
  RemoteParts parts = parts_for(options);
  parts.icount_shift = options.icount_shift;
  parts.process = start(zynq_qemu_over_serial(image, options.icount_shift, kChildLinkFd), options.memory_bytes,
                        only(std::move(theirs)));
  parts.transport = finish(io::adopt_socket(std::move(ours), "the emulator's UART0"), options);
  return std::make_unique<RemoteComputer>(std::move(parts));
}

struct HostAndPort {
  std::string host;
  std::string port;
};
HostAndPort split_endpoint(const std::string& endpoint, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size()) {
    throw FlightComputerError("flight_computer.endpoint '" + endpoint + "' lacks HOST:PORT");
  }
  return {text.substr(0, colon), text.substr(colon + 1)};
}

std::unique_ptr<FrameTransport> open_board_link(const FlightComputerOptions& options) {
  const std::string& endpoint = options.endpoint;
  const auto deadline = Clock::now() + options.timing.boot_limit;
  if (options.link == LinkKind::kUdp) {
    const auto [host, port] = split_endpoint(endpoint, endpoint);
    std::uint16_t number = 0;
    const auto parsed = std::from_chars(port.data(), port.data() + port.size(), number);
    if (parsed.ec != std::errc{} || parsed.ptr != port.data() + port.size()) {
      throw FlightComputerError("flight_computer.endpoint '" + endpoint + "': '" + port + "' is not a port number");
    }
    return finish(make_udp_transport(host, number, options.local_udp_port), options);
  }
  if (endpoint.starts_with(kUnix)) return finish(io::connect_unix(endpoint.substr(kUnix.size()), deadline), options);
  if (endpoint.starts_with(kTcp)) {
    const auto [host, port] = split_endpoint(endpoint, endpoint.substr(kTcp.size()));
    return finish(io::connect_tcp(host, port, deadline), options);
  }
  return finish(io::open_serial(endpoint, options.baud), options);
}

std::unique_ptr<FlightComputer> make_board(const FlightComputerOptions& options) {
  if (options.endpoint.empty()) throw FlightComputerError("target board needs flight_computer.endpoint");
  RemoteParts parts = parts_for(options);
  parts.name += " at " + options.endpoint;
  parts.transport = open_board_link(options);
  return std::make_unique<RemoteComputer>(std::move(parts));
}

using Security = std::optional<fsw::packets::TelecommandSecurity>;

std::unique_ptr<FlightComputer> make_linked_or_loaded(const FlightComputerOptions& options, const Security& security) {
  const auto* const demanded = security ? &*security : nullptr;
  if (!options.library.empty()) {
    const auto make = [&] { return make_in_process(load_test_article(options.library), options.spacecraft, demanded); };
    return make_guarded(make, "flight_computer.library '" + options.library + "'", options.library_step_limit,
                        options.memory_bytes);
  }
  if (!options.article)
    throw FlightComputerError("in_process: this program is linked with no flight software; name a library");
  return make_in_process(options.article, options.spacecraft, demanded);
}

std::unique_ptr<FlightComputer> make_unauthenticated(const FlightComputerOptions& options, const Security& security) {
  switch (options.target) {
    case Target::kInProcess:
      return make_linked_or_loaded(options, security);
    case Target::kHostProcess:
      return make_host_process(options);
    case Target::kZynqQemu:
      return make_zynq_qemu(options);
    case Target::kZynqLinuxQemu:
      return make_zynq_linux_qemu(options);
    case Target::kBoard:
      return make_board(options);
  }
  throw FlightComputerError("unknown flight computer target");
}

/// Either all telecommands of a run are authenticated, or none.
void check_ends(const FlightComputer& computer, const FlightComputerOptions& options) {
  if (options.target == Target::kInProcess) return;
  const bool demands = computer.description().ends_with(boards::kAuthenticates);
  if (demands == !options.telecommand_key_file.empty()) return;
  throw FlightComputerError(
      "flight computer " + full_name(options) +
      (demands ? ": it accepts authenticated telecommands only; state its key by flight_computer.telecommand_key_file"
               : ": it has no key, as flight_computer.telecommand_key_file demands (docs/board_bringup.md)"));
}

}  // namespace

Target target_from_name(std::string_view name) {
  return look_up(kTargets, name, "flight_computer.target");
}
LinkKind link_from_name(std::string_view name) {
  return look_up(kLinks, name, "flight_computer.link");
}
std::string_view name_of(Target target) {
  return name_in(kTargets, target);
}
std::string_view name_of(LinkKind link) {
  return name_in(kLinks, link);
}

std::string software_file(const FlightComputerOptions& options) {
  switch (options.target) {
    case Target::kInProcess:
      return options.library.empty() ? std::string() : library_file(options.library);
    case Target::kBoard:
      return {};
    case Target::kHostProcess:
    case Target::kZynqQemu:
    case Target::kZynqLinuxQemu:
      break;
  }
  return find_image(options);
}

std::unique_ptr<FlightComputer> make_flight_computer(const FlightComputerOptions& options) {
  check_receiver(options);
  Security security;
  if (!options.telecommand_key_file.empty()) security = read_telecommand_security(options.telecommand_key_file);
  try {
    std::unique_ptr<FlightComputer> computer = make_unauthenticated(options, security);
    check_ends(*computer, options);
    return security ? make_authenticated(std::move(computer), *security) : std::move(computer);
  } catch (const LinkError& error) {
    throw FlightComputerError("flight computer " + full_name(options) + ": " + error.what());
  }
}

}  // namespace vbar::pil
