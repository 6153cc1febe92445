#pragma once
// Ethernet KRL port of an emulated controller. One client at a time, as the controller has it.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/bench_lines/sockets.h"
#include "hil_drivers/tron/eki/wire/documents.h"

namespace vbar::tron::bench {

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
  bench_lines::Connection::Receive accept();
  void receive(bench_lines::Connection& connection, eki::DocumentBuffer& documents, std::string_view bytes);

  Handler handler_;
  std::shared_ptr<bench_lines::Listener> listener_;
  std::weak_ptr<bench_lines::Connection> client_;
  std::weak_ptr<eki::DocumentBuffer> open_documents_;  ///< as long as the client's connection lives
};

}  // namespace vbar::tron::bench
