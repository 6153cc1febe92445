#pragma once
// A receiver on a synthetic sky, a host on COM1, and the flight decoder on what comes back.

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/grand/receiver/receiver.h"
#include "fsw/gnss/receiver_decoder.h"
#include "tests/support/synthetic_sky.h"

namespace vbar::grand::bench::test {

class ReceiverSession {
 public:
  explicit ReceiverSession(const ReceiverSettings& settings = {}, std::uint64_t seed = 1,
                           const fsw::Vector3& offset_rtn_m = fsw::Vector3::Zero())
      : sky(constellation(), offset_rtn_m), receiver(settings, constellation(), seed, "servicer") {
    receiver.power(true);
    settle();
  }

  static const std::shared_ptr<const twins::gnss::Constellation>& constellation() {
    static const auto sky_of_all = vbar::test::constellation(1);
    return sky_of_all;
  }

  /// Sends a line and lets the answer come, before the generator runs.
  std::string command(std::string_view line, int port = 0) {
    send(std::string(line) + "\r\n", port);
    return settle(port);
  }
  void send(std::string_view text, int port = 0) {
    receiver.listen(port, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, receiver.baud(port));
  }
  std::string settle(int port = 0) {
    std::string said;
    for (int k = 0; k < 1000; ++k) {
      const bool more = receiver.busy();
      if (more) receiver.idle(fsw::Duration{10'000'000});
      for (int p = 0; p < kReceiverPorts; ++p) {
        const auto bytes = receiver.speak(p);
        if (p == port) said.append(bytes.begin(), bytes.end());
      }
      if (!more) break;
    }
    return said;
  }

  /// Flies blocks until `until_s` after the start; what COM1 and COM2 say is kept in heard[].
  void fly(double until_s) {
    for (; static_cast<double>(blocks) * 0.1 < until_s - 1e-9; ++blocks) {
      receiver.advance(rf ? sky.block(blocks) : dark(blocks));
      for (int port = 0; port < kReceiverPorts; ++port) {
        const auto bytes = receiver.speak(port);
        heard[port].insert(heard[port].end(), bytes.begin(), bytes.end());
      }
    }
  }

  /// As the driver asks for its logs.
  void ask_for_logs(double period_s, double offset_s) {
    for (const char* log : {"RANGEB", "BESTXYZB", "TIMEB"})
      command("LOG " + std::string(log) + " ONTIME " + std::to_string(period_s) + " " + std::to_string(offset_s));
    for (const char* log : {"RAWEPHEMB", "GALEPHEMERISB", "BDSEPHEMERISB", "IONUTCB"})
      command("LOG " + std::string(log) + " ONCHANGED");
  }
  void warm_start(double latitude_deg = 0.0, double longitude_deg = 0.0) {
    const auto week = twins::gnss::week_time(twins::gnss::System::kGps, vbar::test::kGnssStart);
    command("SETAPPROXTIME " + std::to_string(week.week) + " " + std::to_string(week.seconds_of_week()));
    command("SETAPPROXPOS " + std::to_string(latitude_deg) + " " + std::to_string(longitude_deg) + " 709000");
  }

  vbar::test::SyntheticSky sky;
  Receiver receiver;
  std::int64_t blocks = 0;
  bool rf = true;
  std::map<int, std::vector<std::uint8_t>> heard;

 private:
  static RfBlock dark(std::int64_t number) {
    RfBlock block;
    block.begin = vbar::test::kGnssStart + fsw::Duration{number * RfBlock::kLength.ns};
    return block;
  }
};

/// All that the flight decoder reads of a line.
struct Decoded {
  std::vector<fsw::gnss::ObservationEpoch> epochs;
  std::vector<fsw::gnss::ReceiverPosition> positions;
  std::vector<fsw::gnss::ReceiverClock> clocks;
  std::map<fsw::gnss::SatelliteId, double> ephemeris_at_s;  ///< first arrival, by the index of its byte
  int ephemerides = 0, ionospheres = 0;
  fsw::gnss::ReceiverCounters counters;
  fsw::gnss::OemStreamCounters stream;
  std::uint64_t skipped = 0;
};

inline Decoded decode(const std::vector<std::uint8_t>& bytes) {
  using fsw::gnss::ReceiverUpdate;
  Decoded decoded;
  const auto decoder = std::make_unique<fsw::gnss::ReceiverDecoder>();
  for (const std::uint8_t byte : bytes) {
    switch (decoder->push(byte)) {
      case ReceiverUpdate::kNone:
        break;
      case ReceiverUpdate::kObservations:
        decoded.epochs.push_back(decoder->observations());
        break;
      case ReceiverUpdate::kEphemeris:
        ++decoded.ephemerides;
        break;
      case ReceiverUpdate::kIonosphere:
        ++decoded.ionospheres;
        break;
      case ReceiverUpdate::kClock:
        decoded.clocks.push_back(decoder->receiver_clock());
        break;
      case ReceiverUpdate::kPosition:
        decoded.positions.push_back(decoder->position());
        break;
    }
  }
  decoded.counters = decoder->counters();
  decoded.stream = decoder->stream().counters();
  decoded.skipped = decoder->stream().skipped_bytes();
  return decoded;
}

}  // namespace vbar::grand::bench::test
