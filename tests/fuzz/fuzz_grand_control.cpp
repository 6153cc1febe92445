// Control connections of RF generators on arbitrary bytes. The first byte chooses: Skydel frames, executed by the
// emulated instances; SimGEN lines and replies; a pattern of a template and a text. Promises: a WireError or a message,
// every command is answered, and what was read can be written and read again.

#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "emulators/grand/control/skydel_commands.h"
#include "hil_drivers/grand/wire/simgen.h"
#include "hil_drivers/grand/wire/template_format.h"
#include "hil_drivers/wire/bytes.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace fsw = vbar::fsw;
using namespace vbar::grand;

class IdleEngine final : public bench::Engine {
 public:
  [[nodiscard]] std::size_t vehicles() const override { return 2; }
  [[nodiscard]] bench::EngineState state() const override { return state_; }
  [[nodiscard]] std::string error() const override { return {}; }
  void reset() override {}
  std::string set_start_time(fsw::GpsTime time) override {
    VBAR_FUZZ_EXPECT(time.ns >= 0);
    return {};
  }
  std::string set_join(fsw::Duration join) override {
    VBAR_FUZZ_EXPECT(join.ns > 0);
    return {};
  }
  std::string arm() override {
    state_ = bench::EngineState::kArmed;
    return {};
  }
  std::string start(fsw::Duration delay) override {
    VBAR_FUZZ_EXPECT(delay.ns >= 0 && state_ == bench::EngineState::kArmed);
    state_ = bench::EngineState::kStreaming;
    return {};
  }
  void stop() override { state_ = bench::EngineState::kStopped; }
  void sample(std::size_t, const TrajectorySample&) override {}
  [[nodiscard]] bench::VehicleReport report(std::size_t) const override { return {}; }
  [[nodiscard]] TrajectorySample flown(std::size_t, fsw::Duration) const override { return {}; }
  [[nodiscard]] std::int64_t system_time_at_pps0_ms() const override { return 1; }

 private:
  bench::EngineState state_ = bench::EngineState::kIdle;
};

void run_frames(std::span<const std::uint8_t> bytes) {
  IdleEngine engine;
  bench::SkydelCommands commands(engine, {}, {1, 2});
  wire::SkydelFrames frames;
  // In two pieces, so that frames are cut.
  frames.append(bytes.first(bytes.size() / 2));
  for (int half = 0; half < 2; ++half) {
    while (const auto frame = frames.next()) {
      if (frame->kind != wire::SkydelFrameKind::kCommand) continue;
      for (const auto& edge : std::exchange(engine.on_next_edge, {})) edge();
      for (const std::size_t instance : {0U, 1U}) {
        const auto result = commands.execute(instance, frame->json, [](const wire::Json&) {});
        if (!result) continue;
        wire::SkydelFrames again;
        again.append(wire::encode_result(*result));
        VBAR_FUZZ_EXPECT(again.next().has_value());
      }
    }
    frames.append(bytes.subspan(bytes.size() / 2, half == 0 ? bytes.size() - bytes.size() / 2 : 0));
  }
}

void read_line(const std::string& line) {
  const wire::SimgenCommand command = wire::parse_simgen_command(line);
  VBAR_FUZZ_EXPECT(!command.name.empty() && (!command.time || command.time->ns >= 0));
  if (command.name == "START_TIME") VBAR_FUZZ_EXPECT(wire::start_of(command).time.ns >= 0);
  if (command.name != "MOT") return;
  const wire::SimgenMotion motion = wire::motion_of(command);
  VBAR_FUZZ_EXPECT(motion.vehicle >= 1 && motion.sample.position_ecef_m.allFinite());
  const wire::SimgenMotion again = wire::motion_of(wire::parse_simgen_command(wire::mot_line(motion)));
  VBAR_FUZZ_EXPECT(again.sample.position_ecef_m == motion.sample.position_ecef_m);
}

template <class Use>
void tolerant(const Use& use) {
  try {
    use();
  } catch (const wire::WireError&) {
  }
}

void run_lines(std::span<const std::uint8_t> bytes) {
  wire::LineBuffer lines;
  lines.append(bytes);
  while (const auto line = lines.next()) {
    tolerant([&] { read_line(*line); });
    tolerant([&] { static_cast<void>(wire::time_of_data(wire::parse_reply(*line).data)); });
    tolerant([&] { VBAR_FUZZ_EXPECT(wire::reply_length(*line) <= line->size()); });
  }
}

void run_pattern(std::string_view text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const wire::TextPattern pattern(text.substr(0, end), wire::control_values());
  const wire::NamedValues values = pattern.parse(text.substr(std::min(end + 1, text.size())));
  for (const auto& [name, value] : values) VBAR_FUZZ_EXPECT(std::isfinite(value));
  tolerant([&] { static_cast<void>(wire::start_time_of(values)); });
  tolerant([&] { VBAR_FUZZ_EXPECT(pattern.format(values).size() < 100'000); });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes = std::span(data, size).subspan(1);
  tolerant([&] {
    switch (data[0] % 3) {
      case 0:
        return run_frames(bytes);
      case 1:
        return run_lines(bytes);
      default:
        return run_pattern({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
  });
  return 0;
}
