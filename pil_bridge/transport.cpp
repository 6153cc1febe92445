#include "pil_bridge/transport.h"

#include <utility>

#include "fsw/link/frame.h"
#include "host_sim/io/udp_socket.h"

namespace vbar::pil {

void StreamTransport::send(std::span<const std::uint8_t> frame) {
  // A zero before the very first frame terminates bytes that were on the line before this program opened it.
  const std::size_t lead = first_ ? 1 : 0;
  coded_[0] = 0;
  const auto size = fsw::link::cobs_encode(frame, std::span(coded_).subspan(lead));
  if (!size.ok()) throw LinkError("a frame of " + std::to_string(frame.size()) + " bytes is too long for the link");
  const auto coded = std::span(coded_).first(lead + size.value());
  channel_->write(coded, Clock::now() + kWritePatience);
  first_ = false;
  counters_.bytes_sent += coded.size();
}

std::span<const std::uint8_t> StreamTransport::receive(Clock::time_point deadline) {
  for (bool overdue = false;;) {
    while (!undecoded_.empty()) {
      const std::uint8_t byte = undecoded_.front();
      undecoded_ = undecoded_.subspan(1);
      if (decoder_.push(byte)) return decoder_.frame();
    }
    if (overdue) return {};  // a line that sends bytes without a frame does not extend the wait
    overdue = Clock::now() >= deadline;
    undecoded_ = channel_->read(deadline);
    counters_.bytes_received += undecoded_.size();
    if (undecoded_.empty()) return {};
  }
}

TransportCounters StreamTransport::counters() const {
  TransportCounters counters = counters_;
  counters.frames_rejected = decoder_.rejected();
  return counters;
}

namespace {

class UdpTransport final : public FrameTransport {
 public:
  template <class... Arguments>
  explicit UdpTransport(Arguments&&... arguments) : socket_(std::forward<Arguments>(arguments)...) {}

  void send(std::span<const std::uint8_t> frame) override {
    socket_.send(frame);
    counters_.bytes_sent += frame.size();
  }

  std::span<const std::uint8_t> receive(Clock::time_point deadline) override {
    // A flood of datagrams that are not frames does not extend the wait.
    for (bool overdue = false; !overdue;) {
      overdue = Clock::now() >= deadline;
      const auto datagram = socket_.receive(deadline);
      if (!datagram) return {};
      counters_.bytes_received += datagram->size();
      if (!datagram->empty() && datagram->size() <= fsw::link::kMaxFrameBytes) return *datagram;
      ++counters_.frames_rejected;
    }
    return {};
  }

  [[nodiscard]] TransportCounters counters() const override {
    TransportCounters counters = counters_;
    counters.foreign_datagrams = socket_.foreign_datagrams();
    return counters;
  }

  [[nodiscard]] std::string description() const override { return socket_.description(); }

 private:
  io::UdpSocket socket_;
  TransportCounters counters_;
};

}  // namespace

std::unique_ptr<FrameTransport> make_udp_transport(const std::string& peer_address, std::uint16_t peer_port,
                                                   std::uint16_t local_port) {
  return std::make_unique<UdpTransport>(peer_address, peer_port, local_port, fsw::link::kMaxFrameBytes);
}

std::unique_ptr<FrameTransport> make_udp_transport(io::FileDescriptor bound_socket, const std::string& peer_address,
                                                   std::uint16_t peer_port) {
  return std::make_unique<UdpTransport>(std::move(bound_socket), peer_address, peer_port, fsw::link::kMaxFrameBytes);
}

}  // namespace vbar::pil
