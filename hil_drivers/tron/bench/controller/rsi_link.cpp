#include "hil_drivers/tron/bench/controller/rsi_link.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/wire/bytes.h"

namespace vbar::tron::bench {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;
using WallClock = std::chrono::steady_clock;

}  // namespace

RsiLink::RsiLink(asio::io_context& context, const rsi::EthernetXml& ethernet, const std::string& address, int precision,
                 std::function<void()> on_datagram)
    : ethernet_(ethernet),
      precision_(precision),
      on_datagram_(std::move(on_datagram)),
      socket_(context),
      decoder_(ethernet),
      buffer_(rsi::kMaxDatagramBytes + 1) {
  error_code error;
  computer_ = udp::endpoint(asio::ip::make_address_v4(ethernet.address, error), ethernet.port);
  if (error) throw std::runtime_error(fmt::format("'{}' is not an IPv4 address of a computer", ethernet.address));
  const auto local = asio::ip::make_address_v4(address, error);
  if (!error) socket_.open(udp::v4(), error);
  if (!error) socket_.bind(udp::endpoint(local, 0), error);
  if (!error) socket_.non_blocking(true, error);
  if (error) throw std::runtime_error(fmt::format("RSI from {}: {}", address, error.message()));
  wait_for_datagrams();
}

RsiLink::~RsiLink() = default;

void RsiLink::wait_for_datagrams() {
  // Only readiness is asynchronous: end_cycle() reads as well.
  socket_.async_wait(udp::socket::wait_read, [this](const error_code& error) {
    if (error == asio::error::operation_aborted) return;
    drain();
    wait_for_datagrams();
    on_datagram_();
  });
}

void RsiLink::send(const rsi::Rob& rob) {
  if (!rsi::encode(rob, ethernet_, precision_, datagram_)) throw std::logic_error("the state of a robot is not finite");
  ipoc_ = rob.ipoc.text;
  waits_ = true;
  has_answer_ = was_reached_ = false;
  sent_at_ = WallClock::now();
  error_code ignored;  // no listener: no answer will come
  socket_.send_to(asio::buffer(datagram_), computer_, 0, ignored);
}

const rsi::Sen* RsiLink::end_cycle() {
  if (waits_) drain();
  const bool has_answer = has_answer_;
  waits_ = was_reached_ = has_answer_ = false;
  ipoc_.clear();  // what comes from now on is late
  return has_answer ? &answer_ : nullptr;
}

void RsiLink::drain() {
  // As many as a flood may hold the event loop for.
  constexpr int kAtATime = 256;
  for (int count = 0; count < kAtATime; ++count) {
    udp::endpoint sender;
    error_code error;
    const std::size_t size = socket_.receive_from(asio::buffer(buffer_), sender, 0, error);
    if (error == asio::error::would_block) return;
    if (!error && sender == computer_) judge({buffer_.data(), size});
  }
}

void RsiLink::judge(std::string_view datagram) {
  was_reached_ = true;
  const auto refuse = [this](std::string reason) {
    ++counts_.bad;
    counts_.last_bad = std::move(reason);
  };
  if (!decoder_.decode(datagram, received_)) return refuse(decoder_.problem());
  if (received_.type != ethernet_.sen_type)
    return refuse(fmt::format("Type \"{}\"; accepted: \"{}\"", wire::printable(received_.type), ethernet_.sen_type));
  if (received_.ipoc != ipoc_)
    return refuse(
        fmt::format("IPOC {}; accepted: {}", wire::printable(received_.ipoc), ipoc_.empty() ? "none" : ipoc_));
  if (!waits_) {
    ++counts_.repeated;
    return;
  }
  std::swap(answer_, received_);
  has_answer_ = true;
  waits_ = false;
  const double time_s = std::chrono::duration<double>(WallClock::now() - sent_at_).count();
  if (time_s <= 1e-3) ++counts_.within_1ms;
  counts_.max_time_s = std::max(counts_.max_time_s, time_s);
}

}  // namespace vbar::tron::bench
