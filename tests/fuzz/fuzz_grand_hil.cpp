// Datagrams of RF generators on arbitrary bytes: Skydel's, SimGEN's, binary and ASCII templates. Promises: a WireError
// or a message of finite numbers, which is the same when it is written and read again.

#include <string>

#include "hil_drivers/grand/wire/simgen.h"
#include "hil_drivers/grand/wire/skydel.h"
#include "hil_drivers/grand/wire/template_format.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::grand;

bool is_same(const TrajectorySample& a, const TrajectorySample& b) {
  return a.time == b.time && a.position_ecef_m == b.position_ecef_m && a.velocity_ecef_mps == b.velocity_ecef_mps &&
         a.acceleration_ecef_mps2 == b.acceleration_ecef_mps2 && a.jerk_ecef_mps3 == b.jerk_ecef_mps3 &&
         a.yaw_pitch_roll == b.yaw_pitch_roll && a.angular_rate == b.angular_rate &&
         a.angular_acceleration == b.angular_acceleration;
}

void read_skydel(std::span<const std::uint8_t> bytes) {
  const wire::SkydelHilMessage message = wire::decode_hil(bytes);
  if (const auto* sample = std::get_if<wire::SkydelSample>(&message)) {
    const auto again = std::get<wire::SkydelSample>(wire::decode_hil(wire::encode_sample(sample->sample)));
    VBAR_FUZZ_EXPECT(is_same(again.sample, sample->sample) && sample->name.size() < bytes.size());
  }
  if (const auto* info = std::get_if<wire::SkydelVehicleInfo>(&message)) {
    const wire::Bytes again = wire::encode_vehicle_info(*info);
    VBAR_FUZZ_EXPECT(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()));
  }
}

void read_simgen(std::span<const std::uint8_t> bytes) {
  const wire::SimgenMotion motion = wire::decode_mot(bytes);
  const wire::SimgenMotion again = wire::decode_mot(wire::encode_mot(motion));
  VBAR_FUZZ_EXPECT(is_same(again.sample, motion.sample) && again.vehicle == motion.vehicle);
}

wire::TemplateFormat binary_format() {
  using wire::FieldType;
  wire::TemplateFormat format;
  format.start_lines = {"GO"};
  format.byte_order = wire::ByteOrder::kMsbFirst;
  format.fields = {{"vehicle", 0.0, FieldType::kU8, 1.0},          {"time_ms", 0.0, FieldType::kU32, 1.0},
                   {"position_ecef_x", 0.0, FieldType::kF64, 1.0}, {"position_ecef_y", 0.0, FieldType::kF32, 1e-3},
                   {"position_ecef_z", 0.0, FieldType::kI64, 1e3}, {"yaw", 0.0, FieldType::kI16, 1e4}};
  return format;
}

wire::TemplateFormat text_format() {
  wire::TemplateFormat format;
  format.start_lines = {"GO"};
  format.text = "{vehicle:d},{time_s:.3f},{position_ecef_x:.4f},{position_ecef_y},{position_ecef_z:g}";
  return format;
}

void read_template(const wire::TemplateCodec& codec, std::span<const std::uint8_t> bytes) {
  const auto received = codec.decode(bytes);
  VBAR_FUZZ_EXPECT(received.vehicle.has_value() && *received.vehicle < 99);
  wire::check_sample(received.sample, "what was decoded");
}

template <class Use>
void tolerant(const Use& use) {
  try {
    use();
  } catch (const wire::WireError& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).size() > 10);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const wire::TemplateCodec kBinary(binary_format());
  static const wire::TemplateCodec kText(text_format());
  const std::span<const std::uint8_t> bytes(data, size);
  tolerant([&] { read_skydel(bytes); });
  tolerant([&] { read_simgen(bytes); });
  tolerant([&] { read_template(kBinary, bytes); });
  tolerant([&] { read_template(kText, bytes); });
  return 0;
}
