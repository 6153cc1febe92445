#pragma once
// Fields of one message in Protocol Buffers wire format (protobuf.dev, "Encoding"), read within bounds from foreign
// datagrams: nothing is allocated, and a malformed field ends the message.

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/twins/gnss/navigation_message.h"

namespace vbar::grand::bench {

class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  /// Field of one of the four wire types that are in use; `number` is that of a varint or a fixed number, `bytes` those
  /// of a string or a message.
  struct Field {
    enum class Type : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
    std::uint64_t tag = 0;
    Type type = Type::kVarint;
    std::uint64_t number = 0;
    std::span<const std::uint8_t> bytes;

    [[nodiscard]] double as_double() const { return type == Type::kFixed64 ? std::bit_cast<double>(number) : 0.0; }
    [[nodiscard]] bool is_varint() const { return type == Type::kVarint; }
  };

  /// Returns the next field; nothing at the end or where the bytes are malformed.
  std::optional<Field> next();
  /// Returns true if the end was reached without a malformed field.
  [[nodiscard]] bool complete() const { return !malformed_ && rest_.empty(); }

 private:
  std::optional<std::uint64_t> varint();
  std::optional<std::uint64_t> fixed(std::size_t count);

  std::span<const std::uint8_t> rest_;
  bool malformed_ = false;
};

// Datagrams of gnss-sdr by UDP: the observables of its block Monitor (gnss_synchro.proto) and the subframes of its
// block NavDataMonitor (nav_message.proto), as far as they are used here. Field numbers are those of gnss-sdr 0.0.17.

/// Observables of one channel at one instant of the receiver's clock.
struct Observable {
  int channel = 0;
  int prn = 0;             ///< 0: the channel has no satellite
  double rx_time_s = 0.0;  ///< time of the GPS week, by the receiver's clock; 0 until it has been set
  bool valid = false;      ///< pseudorange and phase are valid
  double pseudorange_m = 0.0;
  double carrier_phase_cycles = 0.0;  ///< grows with the range
  double doppler_hz = 0.0;
  double cn0_dbhz = 0.0;
};

/// Decodes a datagram of the Monitor. Nothing for one that is malformed, has more than 64 observables, or a number that
/// is not finite or not plausible; signals other than GPS L1 C/A are left out.
std::optional<std::vector<Observable>> read_observables(std::span<const std::uint8_t> datagram);

struct ReceivedSubframe {
  int prn = 0;
  std::int64_t tow_ms = 0;  ///< time of week that gnss-sdr reports with it
  twins::gnss::TransmittedSubframe words{};
};

/// Decodes a datagram of the NavDataMonitor. Nothing for one that is malformed, of another signal, or not of 300 bits.
std::optional<ReceivedSubframe> read_subframe(std::span<const std::uint8_t> datagram);

// Collection of the observables of channels, which come one by one, into epochs.

/// Epoch of the receiver's clock with all its valid observables, in order of satellite.
struct ObservableEpoch {
  std::int64_t rx_time_ms = 0;  ///< time of the GPS week
  struct Satellite {
    Observable observable;
    std::int64_t locked_ms = 0;         ///< begin of the lock without interruption
    double carrier_phase_cycles = 0.0;  ///< near the pseudorange: a whole number of cycles has been added at lock
  };
  std::vector<Satellite> satellites;
};

class ObservableEpochs {
 public:
  /// `channels` send an observable each, every `interval_ms` of the receiver's clock.
  ObservableEpochs(int channels, int interval_ms) : channels_(channels), interval_ms_(interval_ms) {}

  void take(const Observable& observable);
  /// Returns the next epoch that is complete: every channel has sent, or half a second of later epochs has come. Epochs
  /// come in order; observables of an epoch that has passed are ignored.
  std::optional<ObservableEpoch> next();

 private:
  struct Pending {
    int received = 0;
    std::map<int, Observable> by_satellite;
  };
  struct Lock {
    std::int64_t since_ms = 0, last_ms = 0;
    int channel = 0;
    double added_cycles = 0.0;
  };
  ObservableEpoch finished(std::int64_t rx_time_ms, const Pending& pending);

  int channels_;
  int interval_ms_;
  std::map<std::int64_t, Pending> pending_;
  std::map<int, Lock> locks_;
  std::int64_t newest_ms_ = 0;
  std::int64_t last_ms_ = 0;
};

}  // namespace vbar::grand::bench
