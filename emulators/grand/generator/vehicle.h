#pragma once
// Interface of a receiver at an RF output of the generator: a receiver with serial ports. The emulated OEM628
// (../receiver) is one; gnss-sdr behind baseband samples is another.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "emulators/common/host_line.h"
#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/radio_field/sky.h"
#include "emulators/grand/radio_field/vehicle_motion.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

class ReceiverEnd {
 public:
  ReceiverEnd() = default;
  ReceiverEnd(const ReceiverEnd&) = delete;
  ReceiverEnd& operator=(const ReceiverEnd&) = delete;
  virtual ~ReceiverEnd() = default;

  /// Advances the receiver by the 100 ms of the block.
  virtual void advance(const RfBlock& block) = 0;
  /// Advances the receiver by `span` without a generator.
  virtual void idle(fsw::Duration span) = 0;
  /// Returns true while an answer or a restart is under way.
  [[nodiscard]] virtual bool busy() const = 0;
  virtual void listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud) = 0;
  /// Returns the bytes that have left the port by now, as a host at `host_baud` receives them.
  [[nodiscard]] virtual std::vector<std::uint8_t> speak(std::size_t port, unsigned host_baud) = 0;
  [[nodiscard]] virtual unsigned baud(std::size_t port) const = 0;
  virtual void power(bool on) = 0;
  virtual void set_cn0_offset_db(double offset_db) = 0;
};

/// Makes the receiver of the vehicle with this index. The constellation is that of the run's start time from the first
/// block on.
using ReceiverFactory = std::function<std::unique_ptr<ReceiverEnd>(
    std::size_t vehicle, std::shared_ptr<const twins::gnss::Constellation> constellation)>;

// Damage to the bytes of one serial line, in both directions.

class LineImpairment {
 public:
  enum Kind : std::size_t { kGarbage, kHalfMessages, kFlood, kUnanswered, kRefuses };
  static constexpr std::size_t kKinds = 5;

  /// Random bytes come from the stream "grand/line/<name>".
  LineImpairment(std::uint64_t seed, std::string_view name);

  void set(Kind kind, bool is_on) { on_[kind] = is_on; }
  /// Number of bytes added, changed or removed so far.
  [[nodiscard]] std::uint64_t count(Kind kind) const { return counts_[kind]; }

  /// Returns the impaired bytes; called every 100 ms with the bytes that the receiver sent.
  [[nodiscard]] std::vector<std::uint8_t> to_host(std::vector<std::uint8_t> bytes);
  [[nodiscard]] std::vector<std::uint8_t> from_host(std::span<const std::uint8_t> bytes);

 private:
  [[nodiscard]] std::uint8_t random_byte() { return static_cast<std::uint8_t>(stream_.bits() >> 56U); }
  void add_random(std::vector<std::uint8_t>& bytes, std::size_t count, Kind kind);

  engine::RandomStream stream_;
  std::array<bool, kKinds> on_{};
  std::array<std::uint64_t, kKinds> counts_{};
  std::uint64_t position_ = 0;  ///< position of the next byte for the host
};

// Vehicle of the emulator: its motion, the radio field at its antenna, the receiver in that field, and the receiver's
// serial lines.

class Vehicle {
 public:
  /// The lines are DIR/<name>.com1, DIR/<name>.com2. Throws std::runtime_error.
  Vehicle(boost::asio::io_context& context, const std::filesystem::path& directory, std::string name,
          std::size_t com_ports, std::uint64_t seed, std::unique_ptr<ReceiverEnd> receiver);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] VehicleMotion& motion() { return motion_; }
  [[nodiscard]] const VehicleMotion& motion() const { return motion_; }
  [[nodiscard]] ReceiverEnd& receiver() { return *receiver_; }

  struct Port {
    std::unique_ptr<emulators::HostLine> line;
    LineImpairment impairment;
  };
  [[nodiscard]] std::vector<Port>& ports() { return ports_; }

  /// Discards the motion; the receiver and its lines continue.
  void reset(fsw::Duration join);
  /// Starts the motion: blocks are from now on in this field.
  void start(std::unique_ptr<Sky> sky);

  /// Moves the vehicle up to `time` since start, block by block; bytes that leave the receiver are written to its
  /// lines.
  void fly(fsw::Duration time);
  /// Time up to which the vehicle has moved by whole blocks.
  [[nodiscard]] fsw::Duration blocks_end() const { return {next_block_ * RfBlock::kLength.ns}; }
  [[nodiscard]] const RfBlock& last_block() const { return block_; }

  /// Advances the receiver by `span`, before the run and after it.
  void idle(fsw::Duration span);
  /// Selects immediate answers. While they are on, time passes for the receiver whenever it has something to answer,
  /// until it has: for a generator in lock-step that does not run, so that no wall clock is needed.
  void answer_at_once(bool is_on);

  /// Passes the bytes that the host has written to the receiver.
  void poll_lines();

  void set_outage(bool is_on) { outage_ = is_on; }
  /// Time since the last snap, s, on its own time, at most 1e9.
  [[nodiscard]] double seconds_since_snap() const;

 private:
  void listen(std::size_t port, std::span<const std::uint8_t> bytes, unsigned host_baud);
  void speak();
  void settle();

  std::string name_;
  VehicleMotion motion_;
  std::unique_ptr<ReceiverEnd> receiver_;
  std::vector<Port> ports_;
  std::unique_ptr<Sky> sky_;
  RfBlock block_;
  std::int64_t next_block_ = 0;
  std::int64_t last_snap_block_ = INT64_MIN;
  bool outage_ = false;
  bool answers_at_once_ = false;
};

}  // namespace vbar::grand::bench
