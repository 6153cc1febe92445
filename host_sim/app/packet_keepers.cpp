#include "host_sim/app/packet_keepers.h"

#include <utility>

#include "host_sim/report/lcm_mirror.h"
#include "host_sim/report/output_hash.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/twins/image_log.h"

namespace vbar::app {
namespace {

/// The packets of a step as records, inputs first.
template <class Take>
void for_each_record(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
                     std::span<const pil::Packet> outputs, const Take& take) {
  for (const pil::Packet& packet : inputs) take(twins::PacketRecord{step, time, true, packet});
  for (const pil::Packet& packet : outputs) take(twins::PacketRecord{step, time, false, packet});
}

}  // namespace

class PacketKeepers::Log final : public RunObserver {
 public:
  Log(const std::filesystem::path& file, mission::ImagesInLog images, twins::EventCheck check)
      : writer_(file, images == mission::ImagesInLog::kTiles ? Tiles::kWhole : Tiles::kAsRuns, std::move(check)) {}
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override {
    for_each_record(step, time, inputs, outputs, [this](const twins::PacketRecord& record) { writer_.write(record); });
    writer_.end_step();
  }
  void on_recipe(fsw::GpsTime time, const twins::LoggedImage& recipe) override { writer_.write_recipe(time, recipe); }
  void on_recording(fsw::GpsTime time, const twins::LoggedImage& recording) override {
    writer_.write_recording(time, recording);
  }
  void finish() { writer_.finish(); }

 private:
  using Tiles = twins::ImageLogWriter::Tiles;
  twins::ImageLogWriter writer_;
};

class PacketKeepers::Hash final : public RunObserver {
 public:
  void on_step(std::uint32_t, fsw::GpsTime, std::span<const pil::Packet>,
               std::span<const pil::Packet> outputs) override {
    for (const pil::Packet& packet : outputs) hash_.add(packet);
  }
  [[nodiscard]] const report::OutputHash& get() const { return hash_; }

 private:
  report::OutputHash hash_;
};

class PacketKeepers::Mirror final : public RunObserver {
 public:
  explicit Mirror(const std::string& url) : mirror_(url) {}
  void on_step(std::uint32_t step, fsw::GpsTime time, std::span<const pil::Packet> inputs,
               std::span<const pil::Packet> outputs) override {
    for_each_record(step, time, inputs, outputs,
                    [this](const twins::PacketRecord& record) { mirror_.publish(record); });
  }

 private:
  report::LcmMirror mirror_;
};

PacketKeepers::PacketKeepers(const mission::Mission& mission, const std::filesystem::path& folder,
                             twins::EventCheck check)
    : hash_(std::make_unique<Hash>()) {
  if (mission.record.packets)
    log_ = std::make_unique<Log>(report::packet_log_file(folder), mission.record.images, std::move(check));
  if (mission.lcm.mirror) mirror_ = std::make_unique<Mirror>(mission.lcm.url);
  if (log_) observers_.push_back(log_.get());
  observers_.push_back(hash_.get());
  if (mirror_) observers_.push_back(mirror_.get());
}

PacketKeepers::~PacketKeepers() = default;

void PacketKeepers::finish() {
  if (log_) log_->finish();
}

std::string PacketKeepers::commands_sha256() const {
  return hash_->get().commands_sha256();
}
std::string PacketKeepers::telemetry_sha256() const {
  return hash_->get().telemetry_sha256();
}

}  // namespace vbar::app
