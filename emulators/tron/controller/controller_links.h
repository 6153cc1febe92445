#pragma once
// RSI socket of an emulated controller: a client of UDP with an ephemeral port. It sends the state of a cycle and
// accepts one answer to it.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "emulators/common/sockets.h"
#include "hil_drivers/tron/protocols/eki.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"

namespace vbar::tron::bench {

// Ethernet KRL port of an emulated controller. One client at a time, as the controller has it.

class EkiServer {
 public:
  using Handler = std::function<eki::Reply(const eki::Command&)>;

  /// Listens on `port`; 0: any free one. Throws std::runtime_error.
  EkiServer(boost::asio::io_context& context, const std::string& address, std::uint16_t port, Handler handler);
  ~EkiServer();
  EkiServer(const EkiServer&) = delete;
  EkiServer& operator=(const EkiServer&) = delete;

  /// Sends to the client, if there is one that has sent a document.
  void send(const eki::State& state);
  [[nodiscard]] std::uint16_t port() const { return listener_->port(); }

 private:
  emulators::Connection::Receive accept();
  void receive(emulators::Connection& connection, eki::DocumentBuffer& documents, std::string_view bytes);

  Handler handler_;
  std::shared_ptr<emulators::Listener> listener_;
  std::weak_ptr<emulators::Connection> client_;
  std::weak_ptr<eki::DocumentBuffer> open_documents_;  ///< as long as the client's connection lives
};

struct AnswerCounts {
  std::uint64_t bad = 0;       ///< broken, wrong Type or IPOC
  std::uint64_t repeated = 0;  ///< answers to a cycle that was answered before
  std::uint64_t within_1ms = 0;
  double max_time_s = 0.0;  ///< wall clock from request to answer
  std::string last_bad;     ///< why it did not count
};

class RsiLink {
 public:
  /// Binds to `address`; sends to the computer of `ethernet`. `on_datagram` is called after a datagram was judged.
  /// Throws std::runtime_error.
  RsiLink(boost::asio::io_context& context, const rsi::EthernetXml& ethernet, const std::string& address, int precision,
          std::function<void()> on_datagram);
  RsiLink(const RsiLink&) = delete;
  RsiLink& operator=(const RsiLink&) = delete;
  ~RsiLink();

  /// Sends the state; its answer is awaited from now on.
  void send(const rsi::Rob& rob);
  /// Ends the cycle: returns the answer, or nullptr. Datagrams that arrived until now count.
  const rsi::Sen* end_cycle();
  /// Judges the datagrams that have arrived.
  void drain();

  /// Returns true if a state was sent and has no valid answer yet.
  [[nodiscard]] bool waits() const { return waits_; }
  /// Returns true if a datagram has arrived in this cycle, valid or not.
  [[nodiscard]] bool was_reached() const { return was_reached_; }
  [[nodiscard]] const AnswerCounts& counts() const { return counts_; }

 private:
  void wait_for_datagrams();
  void judge(std::string_view datagram);

  rsi::EthernetXml ethernet_;
  int precision_;
  std::function<void()> on_datagram_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint computer_;
  rsi::Decoder decoder_;
  rsi::Sen received_, answer_;
  std::vector<char> buffer_;
  std::string datagram_, ipoc_;
  std::chrono::steady_clock::time_point sent_at_;
  bool waits_ = false, has_answer_ = false, was_reached_ = false;
  AnswerCounts counts_;
};

}  // namespace vbar::tron::bench
