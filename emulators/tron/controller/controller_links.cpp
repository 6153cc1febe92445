#include "emulators/tron/controller/controller_links.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/wire/bytes.h"

namespace vbar::tron::bench {

namespace {

boost::asio::ip::address_v4 parse(const std::string& address) {
  boost::system::error_code error;
  const auto parsed = boost::asio::ip::make_address_v4(address, error);
  if (error) throw std::runtime_error("'" + address + "' is not an IPv4 address of a controller");
  return parsed;
}

/// The stream of a controller is cut anywhere; a client that expects whole documents fails here as well.
void send_in_pieces(emulators::Connection& connection, std::string_view document) {
  const std::size_t middle = document.size() / 2;
  connection.send(document.substr(0, middle));
  connection.send(document.substr(middle));
}

}  // namespace

EkiServer::EkiServer(boost::asio::io_context& context, const std::string& address, std::uint16_t port, Handler handler)
    : handler_(std::move(handler)), listener_(std::make_shared<emulators::Listener>(context, port, parse(address))) {
  listener_->start([this] { return accept(); });
}

EkiServer::~EkiServer() {
  listener_->close();
}

emulators::Connection::Receive EkiServer::accept() {
  if (!open_documents_.expired()) return {};
  const auto documents = std::make_shared<eki::DocumentBuffer>();
  open_documents_ = documents;
  return [this, documents](emulators::Connection& connection, std::span<const std::uint8_t> bytes) {
    receive(connection, *documents, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
}

void EkiServer::receive(emulators::Connection& connection, eki::DocumentBuffer& documents, std::string_view bytes) {
  client_ = connection.weak_from_this();
  documents.append(bytes);
  try {
    while (const auto document = documents.next()) {
      const eki::Reply reply = handler_(eki::decode_command(*document));
      send_in_pieces(connection, std::visit([](const auto& answer) { return eki::encode(answer); }, reply));
    }
  } catch (const eki::WireError&) {
    connection.close();  // as a controller does whose parser has failed
  }
}

void EkiServer::send(const eki::State& state) {
  if (const auto client = client_.lock()) send_in_pieces(*client, eki::encode(state));
}

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
