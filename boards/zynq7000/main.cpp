// The flight image: frames from UART0 or Ethernet to the flight executive, answers to the peer of the session. A
// cyclic executive: one activity at a time, waiting for interrupts in between.

#include <algorithm>
#include <array>
#include <optional>

#include "boards/common/flight_executive.h"
#include "boards/zynq7000/clocks.h"
#include "boards/zynq7000/console.h"
#include "boards/zynq7000/cpu.h"
#include "boards/zynq7000/ethernet.h"
#include "boards/zynq7000/interrupts.h"
#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/network_settings.h"
#include "boards/zynq7000/reset.h"
#include "boards/zynq7000/semihosting.h"
#include "boards/zynq7000/session_guard.h"
#include "boards/zynq7000/stack_meter.h"
#include "boards/zynq7000/telecommand_key.h"
#include "boards/zynq7000/timer.h"
#include "boards/zynq7000/uart.h"
#include "boards/zynq7000/udp_endpoint.h"
#include "boards/zynq7000/watchdog.h"
#include "fsw/link/frame.h"
#include "fsw/messaging/vbar_gnc.h"

namespace vbar::boards::zynq7000 {
namespace {

constexpr std::uint32_t kLinkBaud = 921'600;
constexpr std::uint32_t kMinReceiverBaud = 2'400;
constexpr std::uint64_t kSilence = timer_span_ms(5'000);
constexpr std::uint64_t kLinkPoll = timer_span_ms(500);
// For a host that states no budget: 250 million instructions, at 4 cycles each and at 64 ns each (icount shift 6).
constexpr std::uint64_t kStepBudgetCycles = 1'000'000'000;
constexpr std::uint64_t kStepBudgetTicks = 1'600'000'000;
constexpr std::uint64_t kMinWatchdogSpan = timer_span_ms(500);  // to start the flight software

/// Flight computer of this board: both interfaces, the session guard and the executive.
class FlightBoard {
 public:
  explicit FlightBoard(const Restart& restart)
      : restart_(restart),
        security_(telecommand_security(kTelecommandKeySettings, restart.has_record ? sequence_of(restart.record) : 0)),
        executive_(platform()) {
    record_.telecommand_sequence = halves_of(security_ ? security_->sequence : 0);
  }

  [[noreturn]] void run();

 private:
  Platform platform();
  void open();
  void report_restart();
  bool serve_serial();
  bool serve_ethernet();
  void await_link();
  void deliver(const Sender& sender, std::span<const std::uint8_t> frame);
  void goodbye();
  void print_counters() const;
  void wait_for_input() const;
  void set_uart_rate(std::uint32_t baud);

  static void session_begins(void* self, std::uint32_t session, std::uint64_t step_budget);
  static void step_begins(void* self, std::uint32_t step);
  static void telecommands_accepted(void* self, std::uint64_t sequence);
  static void step_ends(void* self, bool within_budget);
  static bool open_receiver(void* self, std::uint32_t baud);
  static std::size_t read_receiver(void* self, std::span<std::uint8_t> out);
  static void send(void* self, std::span<const std::uint8_t> frame);
  void send_serial(std::span<const std::uint8_t> frame);
  void send_datagram(const UdpPeer& to, std::span<const std::uint8_t> frame);

  Uart uart_{kUart0, kInterruptUart0};  ///< the link, or the line of the receiver while the link is Ethernet
  std::uint32_t uart_baud_ = kLinkBaud;
  Ethernet ethernet_;
  UdpEndpoint endpoint_{kNetworkSettings.mac, kNetworkSettings.address, kNetworkSettings.udp_port()};
  fsw::link::CobsDecoder decoder_;
  std::uint32_t decoder_rejected_ = 0;
  SessionGuard guard_{kSilence};
  std::uint64_t link_asked_ = 0;
  std::array<std::uint8_t, kMaxEthernetFrameBytes> received_{};
  std::array<std::uint8_t, kMaxEthernetFrameBytes> transmitted_{};
  std::array<std::uint8_t, fsw::link::kMaxCobsFrameBytes> coded_{};
  Restart restart_;
  std::array<char, 120> restart_text_{};
  std::optional<fsw::packets::TelecommandSecurity> security_;
  FlightRecord record_;  ///< record of this flight, as it is retained
  FlightExecutive executive_;
};

void print_address(const NetworkSettings& settings) {
  for (std::size_t i = 0; i < settings.address.size(); ++i) {
    print(i == 0 ? "" : ".");
    print_decimal(settings.address[i]);
  }
  print(":");
  print_decimal(settings.udp_port());
}

bool counts_cycles() {
  return cost_counter_unit() == CounterUnit::kCycles;
}

/// Twice the budget of a step, in ticks of the global timer, of which one is two cycles.
std::uint64_t watchdog_span(std::uint64_t step_budget) {
  const std::uint64_t budget = std::min(step_budget, kWatchdogMaxSpan / 2U);
  return std::max(counts_cycles() ? budget : 2U * budget, kMinWatchdogSpan);
}

Platform FlightBoard::platform() {
  Platform platform;
  platform.context = this;
  platform.name =
      restart_.by_watchdog ? "vbar zynq7000, bare metal, reset by its watchdog" : "vbar zynq7000, bare metal";
  platform.send = &FlightBoard::send;
  platform.counter = [](void*) { return cost_counter(); };
  platform.stack_high_water = [](void*) { return stack_high_water(); };
  platform.counter_unit = cost_counter_unit();
  platform.step_budget = counts_cycles() ? kStepBudgetCycles : kStepBudgetTicks;
  platform.session_begins = &FlightBoard::session_begins;
  platform.step_begins = &FlightBoard::step_begins;
  platform.step_ends = &FlightBoard::step_ends;
  platform.open_receiver = &FlightBoard::open_receiver;
  platform.read_receiver = &FlightBoard::read_receiver;
  platform.telecommand_security = security_ ? &*security_ : nullptr;
  platform.telecommands_accepted = &FlightBoard::telecommands_accepted;
  return platform;
}

void FlightBoard::open() {
  uart_.open(uart_baud_);
  ethernet_.open(kNetworkSettings.mac);
  link_asked_ = global_timer();
  print("vbar zynq7000: ");
  print(vbar_gnc_name());
  print("\ncost in ");
  print(counts_cycles() ? "processor cycles" : "ticks of the emulated timer");
  print("\nlink on UART0 and on UDP ");
  print_address(kNetworkSettings);
  print(security_ ? ", telecommands authenticated" : "");
  print(", Ethernet ");
  print(ethernet_.waits_for_link() ? "waits for a link" : "up");
  print("\nready\n");
}

// The host of the session that the watchdog ended receives the reason as soon as it asks.
void FlightBoard::report_restart() {
  if (!restart_.by_watchdog) {
    return;
  }
  print("\nreset by the watchdog\n");
  if (restart_.has_record) {
    describe_reset(restart_.record, restart_text_);
    guard_.resume(peer_of(restart_.record), global_timer());
    executive_.lose_session(restart_.record.session, restart_text_.data());
    print(restart_text_.data());
    print("\n");
  }
}

void FlightBoard::run() {
  report_restart();
  open();
  watchdog_start(watchdog_span(counts_cycles() ? kStepBudgetCycles : kStepBudgetTicks));
  detail::unmask_interrupts();
  for (;;) {
    watchdog_feed();
    const bool serial = serve_serial();
    const bool datagram = serve_ethernet();
    if (!serial && !datagram) {
      wait_for_input();
    }
  }
}

// One frame per call, so that neither interface starves the other.
bool FlightBoard::serve_serial() {
  if (executive_.has_receiver()) {
    executive_.read_receiver();
    return false;
  }
  std::uint8_t byte = 0;
  while (uart_.read(byte)) {
    const bool complete = decoder_.push(byte);
    executive_.count_rejected(decoder_.rejected() - decoder_rejected_);
    decoder_rejected_ = decoder_.rejected();
    if (complete) {
      deliver({Interface::kSerial, {}}, decoder_.frame());
      return true;
    }
  }
  return false;
}

bool FlightBoard::serve_ethernet() {
  if (ethernet_.waits_for_link()) {
    await_link();
    return true;  // a connected cable raises no interrupt that would end the wait
  }
  const std::size_t size = ethernet_.receive(received_);
  if (size == 0) {
    return false;
  }
  const UdpReceived received = endpoint_.receive(std::span(received_).first(size), transmitted_);
  switch (received.event) {
    case UdpEvent::kNothing:
      break;
    case UdpEvent::kReply:
      ethernet_.send(received.bytes);
      break;
    case UdpEvent::kDatagram:
      deliver({Interface::kEthernet, received.from}, received.bytes);
      break;
  }
  return true;
}

void FlightBoard::await_link() {
  const std::uint64_t now = global_timer();
  if (now - link_asked_ < kLinkPoll) {
    return;
  }
  link_asked_ = now;
  if (ethernet_.link_came_up()) {
    print("Ethernet up\n");
  }
}

void FlightBoard::deliver(const Sender& sender, std::span<const std::uint8_t> frame) {
  if (!guard_.admits(sender, frame, global_timer())) {
    executive_.count_rejected(1);
    return;
  }
  // Peripherals wait while flight code runs, so that an arriving byte costs the step no time; the FIFO and the DMA ring
  // hold what arrives, and the link retransmits what they cannot. send() serves them.
  const PeripheralsDeferred deferred;
  if (executive_.on_frame(frame) == Activity::kGoodbye) {
    goodbye();
  }
}

void FlightBoard::goodbye() {
  guard_.end_session();
  print("goodbye\n");
  print_counters();
  semihosting_exit(static_cast<std::uint32_t>(ExitCode::kDone));
  // Without an emulator this is a bench board. It waits for the next hello.
}

// Number of bytes and frames lost or rejected by the interfaces since start-up. The step report counts those of the
// executive.
void FlightBoard::print_counters() const {
  const UdpCounters& udp = endpoint_.counters();
  const struct {
    const char* name;
    std::uint32_t value;
  } counters[] = {
      {"uart overruns", uart_.overruns()},
      {"uart bytes dropped", uart_.bytes_dropped()},
      {"uart writes stalled", uart_.writes_stalled()},
      {"ethernet receive overruns", ethernet_.receive_overruns()},
      {"ethernet frames broken", ethernet_.frames_broken()},
      {"ethernet sends dropped", ethernet_.sends_dropped()},
      {"datagrams", udp.datagrams},
      {"packets malformed", udp.malformed},
      {"packets for others", udp.not_for_us},
  };
  for (const auto& counter : counters) {
    print(counter.name);
    print(" ");
    print_decimal(counter.value);
    print("\n");
  }
}

void FlightBoard::session_begins(void* self, std::uint32_t session, std::uint64_t step_budget) {
  auto* const board = static_cast<FlightBoard*>(self);
  // Through a reset before the first step of this session, telecommands of the one before stay refused.
  const auto telecommand_sequence = board->record_.telecommand_sequence;
  board->record_ = {};
  board->record_.session = session;
  board->record_.telecommand_sequence = telecommand_sequence;
  set_peer(board->record_, board->guard_.peer());
  retain(board->record_);
  watchdog_start(watchdog_span(step_budget));
}

void FlightBoard::step_begins(void* self, std::uint32_t step) {
  auto* const board = static_cast<FlightBoard*>(self);
  board->record_.step = step;
  board->record_.in_step = 1;
  retain(board->record_);
}

void FlightBoard::telecommands_accepted(void* self, std::uint64_t sequence) {
  auto* const board = static_cast<FlightBoard*>(self);
  board->record_.telecommand_sequence = halves_of(sequence);
  retain(board->record_);
}

void FlightBoard::step_ends(void* self, bool within_budget) {
  auto* const board = static_cast<FlightBoard*>(self);
  board->record_.in_step = 0;
  retain(board->record_);
  if (!within_budget) {
    print("step ");
    print_decimal(board->record_.step);
    print(" exceeded its budget\n");
  }
}

// Sets the rate, also on the emulator, which passes it on to the terminal that is UART0 there.
void FlightBoard::set_uart_rate(std::uint32_t baud) {
  if (baud != uart_baud_) {
    uart_baud_ = baud;
    uart_.open(baud);
  }
}

// UART0 is the receiver's only if the host uses Ethernet.
bool FlightBoard::open_receiver(void* self, std::uint32_t baud) {
  auto* const board = static_cast<FlightBoard*>(self);
  if (baud == 0) {
    board->set_uart_rate(kLinkBaud);
    return true;
  }
  if (board->guard_.peer().interface != Interface::kEthernet || baud < kMinReceiverBaud || baud > kLinkBaud) {
    return false;
  }
  board->set_uart_rate(baud);
  std::uint8_t discarded = 0;
  for (std::size_t i = 0; i < Uart::kRingBytes && board->uart_.read(discarded); ++i) {
  }
  return true;
}

std::size_t FlightBoard::read_receiver(void* self, std::span<std::uint8_t> out) {
  Uart& uart = static_cast<FlightBoard*>(self)->uart_;
  {
    const PeripheralsDeferred deferred;
    uart.take_received();  // a count of received bytes includes those below the trigger level of the FIFO
  }
  std::size_t count = 0;
  while (count < out.size() && uart.read(out[count])) {
    ++count;
  }
  return count;
}

void FlightBoard::wait_for_input() const {
  const InterruptsMasked masked;  // a byte that arrives after the last check is pending, and ends the wait at once
  if (!uart_.has_input() && !ethernet_.has_input()) {
    watchdog_before_wait();
    wait_for_interrupt();
    watchdog_after_wait();
  }
}

void FlightBoard::send(void* self, std::span<const std::uint8_t> frame) {
  const PeripheralsServed served;
  auto* const board = static_cast<FlightBoard*>(self);
  const Sender& peer = board->guard_.peer();
  switch (peer.interface) {
    case Interface::kSerial:
      board->send_serial(frame);
      break;
    case Interface::kEthernet:
      board->send_datagram(peer.peer, frame);
      break;
  }
}

void FlightBoard::send_serial(std::span<const std::uint8_t> frame) {
  const auto size = fsw::link::cobs_encode(frame, coded_);
  if (size.ok()) {
    uart_.write(std::span(coded_).first(size.value()));
  }
}

void FlightBoard::send_datagram(const UdpPeer& to, std::span<const std::uint8_t> frame) {
  const auto size = endpoint_.write_datagram(to, frame, transmitted_);
  if (size.ok()) {
    ethernet_.send(std::span(transmitted_).first(size.value()));
  }
}

}  // namespace
}  // namespace vbar::boards::zynq7000

int main() {
  using namespace vbar::boards::zynq7000;
  clocks_enable_peripherals();
  timers_initialize();
  console_open();
  interrupts_initialize();
  static FlightBoard board(
      find_restart());  // constructed here, not before main: its executive selects the cost counter
  board.run();
}
