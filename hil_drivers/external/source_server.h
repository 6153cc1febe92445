#pragma once
// Server of a link (fsw/link/frame.h) in a program that answers batches of packets with batches of packets: a sensor.
// Unlike boards/common it has a heap, so that an answer may have the tiles of an image.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/link/batch.h"
#include "hil_drivers/external/exchange.h"
#include "host_sim/twins/packet_source.h"
#include "pil_bridge/transport.h"

namespace vbar::external {

class BatchServer {
 public:
  using Packet = std::vector<std::uint8_t>;
  /// Returns the answer to a batch, of one packet at least.
  using Serve = std::function<std::vector<Packet>(std::span<const Packet>)>;

  /// Serves on `transport`, which outlives this. `name` stands in messages of the host, ASCII.
  BatchServer(pil::FrameTransport& transport, std::string name, Serve serve)
      : transport_(transport), name_(std::move(name)), serve_(std::move(serve)) {}

  /// Answers the first session until its goodbye. Throws pil::LinkError if the line is closed before it, or brings
  /// nothing for `patience`, and what `serve` throws.
  void run(std::chrono::milliseconds patience);

 private:
  /// Handles a frame; returns false after the goodbye.
  bool take(std::span<const std::uint8_t> frame);
  void on_hello(const fsw::link::FrameView& frame);
  void on_data(const fsw::link::FrameView& frame);
  void on_poll(const fsw::link::FrameHeader& header);
  void send_answer();
  void send(const fsw::link::FrameHeader& header, std::span<const std::uint8_t> payload = {});

  pil::FrameTransport& transport_;
  std::string name_;
  Serve serve_;
  std::optional<std::uint32_t> session_;
  fsw::link::BatchReceiver inputs_;
  fsw::link::BatchSender outputs_;
  std::vector<Packet> batch_, answer_;
  bool has_answer_ = false;  ///< answer_ belongs to the batch of inputs_
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes> frame_{};
};

// Server of a PacketSource of this program at the other end of the exchange: vbar's own twin as a sensor in another
// process.

class ServedSource {
 public:
  /// Makes the source of a name and a seed. Throws std::runtime_error if there is none.
  using Make = std::function<std::unique_ptr<twins::PacketSource>(const Opening&)>;

  explicit ServedSource(Make make) : make_(std::move(make)) {}
  ~ServedSource();
  ServedSource(const ServedSource&) = delete;
  ServedSource& operator=(const ServedSource&) = delete;

  /// Returns the answer to a batch, pending packets included. Throws std::runtime_error for a batch without truth, and
  /// what the source throws.
  std::vector<twins::Packet> answer(const Batch& batch);

 private:
  void start(const Batch& batch);
  [[nodiscard]] Answer measure(const Batch& batch);

  Make make_;
  std::unique_ptr<twins::PacketSource> source_;
};

// Server of a true world of this program at the other end of the exchange: vbar's own truth model as the truth in
// another process.

class ServedTruth {
 public:
  /// Makes the world at the start of the mission.
  using Make = std::function<std::unique_ptr<twins::TrueWorld>()>;

  ServedTruth(Make make, SpacecraftNumbers numbers) : make_(std::move(make)), numbers_(std::move(numbers)) {}

  /// Returns the answer to a batch. Throws std::runtime_error for a batch out of order, and for a start that is not
  /// that of the world, and what the world throws.
  std::vector<twins::Packet> answer(const Batch& batch);

 private:
  void start(const Batch& batch);
  void apply(const Command& command);

  Make make_;
  SpacecraftNumbers numbers_;
  std::unique_ptr<twins::TrueWorld> world_;
};

}  // namespace vbar::external
