#pragma once
// Vehicle of the emulator: its motion, the radio field at its antenna, the receiver in that field, and the receiver's
// serial lines.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/bench_lines/host_line.h"
#include "hil_drivers/grand/bench/generator/line_impairment.h"
#include "hil_drivers/grand/bench/generator/receiver_end.h"
#include "hil_drivers/grand/bench/generator/sky.h"
#include "hil_drivers/grand/bench/generator/vehicle_motion.h"

namespace vbar::grand::bench {

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
    std::unique_ptr<bench_lines::HostLine> line;
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
