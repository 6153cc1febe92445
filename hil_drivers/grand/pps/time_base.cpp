#include "hil_drivers/grand/pps/time_base.h"

#include <bit>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/datagram_protocol.hpp>
#include <fmt/format.h>
#include <sys/time.h>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

namespace {

namespace asio = boost::asio;
using asio::local::datagram_protocol;
using boost::system::error_code;
using Span = engine::WallClock::Span;

struct SockSample {
  timeval time;   ///< time of the system's clock
  double offset;  ///< reference minus system, s
  int pulse;      ///< 1: the second is not known; such a source needs another one to number its seconds
  int leap;
  int padding;
  int magic;
};
static_assert(sizeof(SockSample) == kChronySampleBytes);
constexpr int kMagic = 0x534F434B;

Span realtime_at(Span monotonic) {
  const Span realtime = std::chrono::system_clock::now().time_since_epoch();
  return realtime - (Span(std::chrono::steady_clock::now().time_since_epoch()) - monotonic);
}

}  // namespace

std::array<std::uint8_t, kChronySampleBytes> chrony_sample(Span realtime) {
  const auto stamp = std::chrono::floor<std::chrono::microseconds>(realtime);
  const auto second = std::chrono::floor<std::chrono::seconds>(stamp);
  SockSample sample{};
  sample.time.tv_sec = second.count();
  sample.time.tv_usec = std::chrono::microseconds(stamp - second).count();
  // The offset is that of the edge; between it and the stamp lies less than a microsecond.
  sample.offset = std::chrono::duration<double>(std::chrono::round<std::chrono::seconds>(realtime) - realtime).count();
  sample.magic = kMagic;
  return std::bit_cast<std::array<std::uint8_t, kChronySampleBytes>>(sample);
}

struct ChronyOutput::State {
  explicit State(const std::string& path) : socket(context), consumer(path) {
    socket.open(datagram_protocol());
    socket.non_blocking(true);
  }
  asio::io_context context;
  datagram_protocol::socket socket;
  datagram_protocol::endpoint consumer;
};

ChronyOutput::ChronyOutput(const std::string& path) {
  try {
    state_ = std::make_unique<State>(path);
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(fmt::format("chrony socket {}: {}", path, error.code().message()));
  }
}

ChronyOutput::~ChronyOutput() = default;

void ChronyOutput::forward(const Edge& edge) {
  const auto bytes = chrony_sample(realtime_at(edge.monotonic));
  error_code error;
  state_->socket.send_to(asio::buffer(bytes), state_->consumer, 0, error);
  if (!error) ++sent_;
}

namespace {

constexpr std::chrono::seconds kFirstEdge{10};

}  // namespace

TimeBase::TimeBase(fsw::GpsTime start, const std::string& pps, const std::string& chrony) : start_(start) {
  if (pps == "none") return;
  EdgeClockSettings settings;
  if (!chrony.empty()) {
    chrony_.emplace(chrony);
    settings.on_edge = [this](const Edge& edge) { chrony_->forward(edge); };
  }
  edges_ = std::make_unique<EdgeClock>(make_edge_source(pps), std::make_unique<engine::SteadyWallClock>(), settings);
}

void TimeBase::begin(std::optional<std::chrono::steady_clock::time_point> host_start) {
  const auto at_host = host_start ? std::chrono::duration_cast<Span>(host_start->time_since_epoch()) : host_.now();
  if (!edges_) {
    start_of_run_ = at_host;
    return;
  }
  edges_->wait_for_edges(1, kFirstEdge);
  if (const auto labelled = edges_->at_gps(start_)) {
    start_of_run_ = *labelled;
  } else if (host_start) {
    start_of_run_ = edges_->at(at_host);
  } else {
    throw std::runtime_error("the start of the generator is unknown: neither its edges nor its answers contain it");
  }
}

std::optional<double> TimeBase::last_edge_s() const {
  if (!edges_) return std::nullopt;
  const auto edge = edges_->last_edge();
  if (!edge) return std::nullopt;
  return std::chrono::duration<double>(*edge - start_of_run_).count();
}

}  // namespace vbar::grand
