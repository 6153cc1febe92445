#include "hil_drivers/tron/bench/controller/eki_server.h"

#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace vbar::tron::bench {
namespace {

boost::asio::ip::address_v4 parse(const std::string& address) {
  boost::system::error_code error;
  const auto parsed = boost::asio::ip::make_address_v4(address, error);
  if (error) throw std::runtime_error("'" + address + "' is not an IPv4 address of a controller");
  return parsed;
}

/// The stream of a controller is cut anywhere; a client that expects whole documents fails here as well.
void send_in_pieces(bench_lines::Connection& connection, std::string_view document) {
  const std::size_t middle = document.size() / 2;
  connection.send(document.substr(0, middle));
  connection.send(document.substr(middle));
}

}  // namespace

EkiServer::EkiServer(boost::asio::io_context& context, const std::string& address, std::uint16_t port, Handler handler)
    : handler_(std::move(handler)), listener_(std::make_shared<bench_lines::Listener>(context, port, parse(address))) {
  listener_->start([this] { return accept(); });
}

EkiServer::~EkiServer() {
  listener_->close();
}

bench_lines::Connection::Receive EkiServer::accept() {
  if (!open_documents_.expired()) return {};
  const auto documents = std::make_shared<eki::DocumentBuffer>();
  open_documents_ = documents;
  return [this, documents](bench_lines::Connection& connection, std::span<const std::uint8_t> bytes) {
    receive(connection, *documents, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
}

void EkiServer::receive(bench_lines::Connection& connection, eki::DocumentBuffer& documents, std::string_view bytes) {
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

}  // namespace vbar::tron::bench
