#pragma once
// Construction of every kind of flight computer from the words of a mission file.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "host_sim/io/serial_line.h"
#include "pil_bridge/flight_computer.h"
#include "pil_bridge/link_faults.h"
#include "pil_bridge/qemu.h"
#include "pil_bridge/step_barrier.h"
#include "pil_bridge/test_article.h"

namespace vbar::pil {

enum class Target : std::uint8_t {
  kInProcess,      ///< "in_process"
  kHostProcess,    ///< "host_process": a process of its own on this computer
  kZynqQemu,       ///< "zynq_qemu": the bare-metal image on an emulated Zynq-7000
  kZynqLinuxQemu,  ///< "zynq_linux_qemu": the ARM Linux program under user-mode emulation
  kBoard,          ///< "board": hardware, or any other program that already runs and listens
};

enum class LinkKind : std::uint8_t {
  kSerial,  ///< "serial": a byte stream; for a started process a pair of stream sockets
  kPty,     ///< "pty": a byte stream through a pseudo-terminal (host_process and zynq_linux_qemu)
  kUdp,     ///< "udp"
};

/// Throw std::invalid_argument with the list of accepted names.
Target target_from_name(std::string_view name);
LinkKind link_from_name(std::string_view name);
std::string_view name_of(Target target);
std::string_view name_of(LinkKind link);

struct FlightComputerOptions {
  Target target = Target::kInProcess;
  LinkKind link = LinkKind::kSerial;
  std::uint8_t spacecraft = 0;

  /// in_process: the test article (`linked_test_article()`), unless `library` names a shared library.
  std::shared_ptr<const TestArticle> article;
  std::string library;
  /// A library runs in a child process (test_article.h), which is given up if a step takes longer.
  std::chrono::milliseconds library_step_limit{60'000};

  /// host_process, zynq_qemu, zynq_linux_qemu: the program or image to run. Empty: the one built beside
  /// the running program (`vbar_flight`, `../zynq/vbar_zynq7000.elf`, `../zynq-linux/vbar_flight`).
  std::string image;
  int icount_shift = kDefaultIcountShift;  ///< zynq_qemu

  /// board. Serial: a device ("/dev/ttyUSB1"), "unix:PATH" or "tcp:HOST:PORT". UDP: "ADDRESS:PORT".
  std::string endpoint;
  unsigned baud = 921600;            ///< board, serial device
  std::uint16_t local_udp_port = 0;  ///< board; 0: any

  /// The receiver that is wired to the flight computer, if there is one. Not in_process, and not zynq_qemu over its
  /// UART.
  std::optional<io::WiredReceiver> receiver = std::nullopt;

  /// Budget of a step, beyond which the run fails: instructions on zynq_qemu, cycles on a board; others count neither.
  /// 0: the default of the image.
  std::uint64_t step_budget = 0;

  /// File of the key with which telecommands are authenticated (telecommand_security.h); empty: they are not. The
  /// flight computer of targets zynq_qemu and board has the key already.
  std::string telecommand_key_file = {};

  /// Largest memory of a library, or of a program that is started; 0: no limit.
  std::uint64_t memory_bytes = 0;

  double paced_bits_per_s = 0.0;  ///< serial and pty: limits the rate of the line to this; 0: unlimited
  BarrierTiming timing;
  LinkFaults faults;
};

/// The library, program or image that make_flight_computer would fly; empty for a linked test article and for a board.
/// Throws FlightComputerError if there is no such image.
std::string software_file(const FlightComputerOptions& options);

/// Starts or finds the flight computer and waits until it answers. Throws FlightComputerError, also if one end of the
/// link authenticates telecommands and the other does not.
std::unique_ptr<FlightComputer> make_flight_computer(const FlightComputerOptions& options);

}  // namespace vbar::pil
