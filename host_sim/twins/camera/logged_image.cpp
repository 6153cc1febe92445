#include "host_sim/twins/camera/logged_image.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <charls/charls.h>
#include <vbar_host/image_recipe.hpp>
#include <vbar_host/recorded_image.hpp>

#include "fsw/packets/big_endian.h"
#include "host_sim/twins/camera/image_tiles.h"
#include "host_sim/twins/lcm_log.h"

namespace vbar::twins::camera {

namespace {

void write(const fsw::Vector3& vector, double (&field)[3]) {
  std::copy(vector.begin(), vector.end(), field);
}

void write(const Eigen::Quaterniond& q, double (&field)[4]) {
  field[0] = q.w();
  field[1] = q.x();
  field[2] = q.y();
  field[3] = q.z();
}

void write(const std::string& text, std::uint8_t (&field)[kMaxNameBytes + 1]) {
  if (text.size() > kMaxNameBytes)
    throw std::invalid_argument("\"" + text + "\": a camera's objects and models have names of at most " +
                                std::to_string(kMaxNameBytes) + " bytes");
  std::fill(std::copy(text.begin(), text.end(), field), std::end(field), std::uint8_t{0});
}

fsw::Vector3 vector_of(const double (&field)[3]) {
  return {field[0], field[1], field[2]};
}

Eigen::Quaterniond quaternion_of(const double (&field)[4]) {
  return {field[0], field[1], field[2], field[3]};
}

std::string text_of(const std::uint8_t (&field)[kMaxNameBytes + 1]) {
  return {field, std::find(field, std::end(field), std::uint8_t{0})};
}

void write(const ObjectInView& object, vbar_host::object_in_view& message) {
  write(object.name, message.name);
  write(object.model, message.model);
  write(object.position_eci, message.position_eci);
  write(object.velocity_eci, message.velocity_eci);
  write(object.q_body_eci, message.q_body_eci);
  message.sunlit = object.sunlit;
}

ObjectInView object_of(const vbar_host::object_in_view& message) {
  return {text_of(message.name),
          text_of(message.model),
          vector_of(message.position_eci),
          vector_of(message.velocity_eci),
          quaternion_of(message.q_body_eci),
          message.sunlit};
}

}  // namespace

std::vector<std::uint8_t> bytes_of(const ImageRecipe& recipe) {
  const Exposure& exposure = recipe.exposure;
  if (exposure.objects.size() > kMaxObjectsInView)
    throw std::invalid_argument("a camera has at most " + std::to_string(kMaxObjectsInView) + " objects in view, not " +
                                std::to_string(exposure.objects.size()));
  vbar_host::image_recipe message{};
  message.spacecraft = recipe.spacecraft;
  message.unit = recipe.unit;
  message.gps_time_ns = exposure.time.ns;
  message.number = exposure.number;
  message.duration_s = exposure.duration_s.value_or(0.0);
  write(exposure.q_camera_eci, message.q_camera_eci);
  write(exposure.rate_camera, message.rate_camera);
  write(exposure.camera_position_eci, message.camera_position_eci);
  write(exposure.camera_velocity_eci, message.camera_velocity_eci);
  write(exposure.earth_velocity_bcrs, message.earth_velocity_bcrs);
  write(exposure.sun_eci, message.sun_eci);
  write(exposure.moon_eci, message.moon_eci);
  message.years_since_j2000 = exposure.years_since_j2000;
  message.count = static_cast<std::int32_t>(exposure.objects.size());
  for (std::size_t k = 0; k < exposure.objects.size(); ++k) write(exposure.objects[k], message.objects[k]);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

std::optional<ImageRecipe> recipe_of(std::span<const std::uint8_t> bytes) {
  vbar_host::image_recipe message{};
  const auto size = static_cast<std::size_t>(message.getEncodedSize());
  if (bytes.size() != size || message.decode(bytes.data(), 0, static_cast<int>(size)) < 0) return std::nullopt;
  const bool is_good = message.count >= 0 && message.count <= static_cast<std::int32_t>(kMaxObjectsInView) &&
                       fits_header(message.spacecraft) && fits_header(message.unit);
  if (!is_good) return std::nullopt;
  ImageRecipe recipe;
  recipe.spacecraft = static_cast<std::uint8_t>(message.spacecraft);
  recipe.unit = static_cast<std::uint8_t>(message.unit);
  Exposure& exposure = recipe.exposure;
  exposure.time = {message.gps_time_ns};
  exposure.number = message.number;
  if (message.duration_s > 0.0) exposure.duration_s = message.duration_s;
  exposure.q_camera_eci = quaternion_of(message.q_camera_eci);
  exposure.rate_camera = vector_of(message.rate_camera);
  exposure.camera_position_eci = vector_of(message.camera_position_eci);
  exposure.camera_velocity_eci = vector_of(message.camera_velocity_eci);
  exposure.earth_velocity_bcrs = vector_of(message.earth_velocity_bcrs);
  exposure.sun_eci = vector_of(message.sun_eci);
  exposure.moon_eci = vector_of(message.moon_eci);
  exposure.years_since_j2000 = message.years_since_j2000;
  for (std::int32_t k = 0; k < message.count; ++k) exposure.objects.push_back(object_of(message.objects[k]));
  return recipe;
}

namespace {

constexpr std::int8_t kJpegLs = 1;
// Sizes of the fields of the encoded message: type hash, spacecraft, unit, time, number, exposure, region, bits,
// coding.
constexpr std::size_t kSizeAt = 8 + 2 * 2 + 3 * 8 + 4 * 4 + 2 * 1;
constexpr std::size_t kDataAt = kSizeAt + 4;

std::size_t pixels_in(const Region& region) {
  return static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
}

/// JPEG-LS of samples of one type.
template <class Sample>
std::vector<std::uint8_t> encoded(const charls::frame_info& frame, const std::vector<Sample>& samples) {
  charls::jpegls_encoder encoder;
  encoder.frame_info(frame);
  // The estimate is the size of the samples; noise of all bits takes somewhat more.
  std::vector<std::uint8_t> bytes(2 * encoder.estimated_destination_size());
  encoder.destination(bytes);
  bytes.resize(encoder.encode(samples));
  return bytes;
}

std::vector<std::uint8_t> encoded(const ImageHeader& header, std::span<const std::uint16_t> dn) {
  const charls::frame_info frame{static_cast<std::uint32_t>(header.region.width),
                                 static_cast<std::uint32_t>(header.region.height), header.bits, 1};
  if (header.bits > 8) return encoded(frame, std::vector<std::uint16_t>(dn.begin(), dn.end()));
  std::vector<std::uint8_t> bytes(dn.size());
  std::ranges::transform(dn, bytes.begin(), [](std::uint16_t value) { return static_cast<std::uint8_t>(value); });
  return encoded(frame, bytes);
}

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error("holds damaged JPEG-LS data: " + what);
}

template <class Sample>
std::vector<std::uint16_t> decoded(const charls::jpegls_decoder& decoder, const ImageHeader& header) {
  std::vector<Sample> samples(pixels_in(header.region));
  decoder.decode(samples);
  return {samples.begin(), samples.end()};
}

void check_frame(const charls::jpegls_decoder& decoder, const ImageHeader& header) {
  const charls::frame_info& frame = decoder.frame_info();
  const std::string size = std::to_string(frame.width) + " x " + std::to_string(frame.height);
  if (frame.width != static_cast<std::uint32_t>(header.region.width) ||
      frame.height != static_cast<std::uint32_t>(header.region.height))
    fail("they are " + size + " pixels, the record states " + std::to_string(header.region.width) + " x " +
         std::to_string(header.region.height));
  if (frame.bits_per_sample != header.bits)
    fail("they have " + std::to_string(frame.bits_per_sample) + " bits a pixel, the record states " +
         std::to_string(header.bits));
  if (frame.component_count != 1)
    fail("they have " + std::to_string(frame.component_count) + " components; accepted: 1");
  if (decoder.near_lossless(0) != 0) fail("their coding is not lossless");
}

/// CharLS 2.4.1 searches data that are cut for seconds before it rejects them.
void check_end(const std::vector<std::uint8_t>& data) {
  const bool has_end = data.size() >= 2 && data[data.size() - 2] == 0xFF && data.back() == 0xD9;
  if (!has_end) fail("they do not end with the marker of the end of an image");
}

/// The message without its data; empty if the bytes are not exactly one.
std::optional<vbar_host::recorded_image> message_of(std::span<const std::uint8_t> bytes) {
  // The generated decoder allocates the claimed size before it checks that the bytes exist.
  if (bytes.size() < kDataAt || fsw::packets::read_big_endian<std::uint32_t>(bytes, kSizeAt) != bytes.size() - kDataAt)
    return std::nullopt;
  vbar_host::recorded_image message;
  const auto size = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, size) != size) return std::nullopt;
  return message;
}

std::optional<ImageHeader> header_of(const vbar_host::recorded_image& message) {
  const ImageHeader header{{{message.gps_time_ns},
                            message.number,
                            static_cast<std::uint8_t>(message.spacecraft),
                            static_cast<std::uint8_t>(message.unit),
                            message.exposure_s},
                           {message.x, message.y, message.width, message.height},
                           message.bits};
  const bool is_good = fits_header(message.spacecraft) && fits_header(message.unit) && message.number >= 0 &&
                       message.exposure_s >= 0.0 && std::isfinite(message.exposure_s) && message.coding == kJpegLs &&
                       number_of_tiles(header.region, header.bits).has_value();
  return is_good ? std::optional(header) : std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> recorded_image_of(const ImageHeader& header, std::span<const std::uint16_t> dn) {
  if (!number_of_tiles(header.region, header.bits) || dn.size() != pixels_in(header.region))
    throw std::invalid_argument("the image to be recorded is not of the region that is sent");
  const int limit = 1 << header.bits;
  if (std::ranges::any_of(dn, [limit](std::uint16_t value) { return value >= limit; }))
    throw std::invalid_argument("a pixel of the image to be recorded has more than " + std::to_string(header.bits) +
                                " bits");
  vbar_host::recorded_image message;
  message.spacecraft = header.label.spacecraft;
  message.unit = header.label.unit;
  message.gps_time_ns = header.label.time.ns;
  message.number = header.label.number;
  message.exposure_s = header.label.exposure_s;
  message.x = header.region.x;
  message.y = header.region.y;
  message.width = header.region.width;
  message.height = header.region.height;
  message.bits = static_cast<std::int8_t>(header.bits);
  message.coding = kJpegLs;
  message.data = encoded(header, dn);
  message.size = static_cast<std::int32_t>(message.data.size());
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

std::optional<ImageHeader> header_of_recorded_image(std::span<const std::uint8_t> recorded_image) {
  const auto message = message_of(recorded_image);
  return message ? header_of(*message) : std::nullopt;
}

std::vector<std::uint16_t> pixels_of_recorded_image(std::span<const std::uint8_t> recorded_image) {
  const auto message = message_of(recorded_image);
  const auto header = message ? header_of(*message) : std::nullopt;
  if (!header) throw std::runtime_error("is a damaged record");
  check_end(message->data);
  std::vector<std::uint16_t> dn;
  try {
    const charls::jpegls_decoder decoder(message->data, true);
    check_frame(decoder, *header);
    dn = header->bits > 8 ? decoded<std::uint16_t>(decoder, *header) : decoded<std::uint8_t>(decoder, *header);
  } catch (const charls::jpegls_error& error) {
    fail(error.what());
  }
  const int limit = 1 << header->bits;
  if (std::ranges::any_of(dn, [limit](std::uint16_t value) { return value >= limit; }))
    fail("a pixel has more than " + std::to_string(header->bits) + " bits");
  return dn;
}

namespace {

ImageKey key_of(const ImageRecipe& recipe) {
  return {recipe.spacecraft, recipe.unit, image_number_on_link(recipe.exposure.number)};
}

}  // namespace

TileRestorer::TileRestorer(ImagesOfLog&& images, MakeImage make_image)
    : log_(std::move(images)), make_image_(std::move(make_image)) {
  for (std::size_t k = 0; k < log_.recipes.size(); ++k) add_recipe(k);
  for (std::size_t k = 0; k < log_.recordings.size(); ++k) add_recording(k);
}

void TileRestorer::add_recipe(std::size_t place) {
  const auto recipe = recipe_of(log_.recipes[place]);
  if (!recipe) throw DamagedLog(log_.file.string() + ": a recipe of an image is damaged");
  images_[key_of(*recipe)].recipe = place;
  keys_[recipe->exposure.time] = key_of(*recipe);
}

void TileRestorer::add_recording(std::size_t place) {
  const ImagesOfLog::Recording& recording = log_.recordings[place];
  const auto header = header_of_recorded_image(recording.bytes);
  if (!header)
    throw DamagedLog(log_.file.string() + ": byte " + std::to_string(recording.offset) +
                     ": a damaged record of an image");
  images_[header->key()].recording = place;
  keys_[header->label.time] = header->key();
}

void TileRestorer::fail(const TileRun& run, const std::string& what) const {
  throw std::runtime_error(log_.file.string() + ": image " + std::to_string(run.image) + ", tiles from " +
                           std::to_string(run.first_tile) + " on: " + what);
}

std::vector<Packet> TileRestorer::packets_of(const TileRun& run) {
  const ImageKey key = run.key();
  if (made_ != key) {
    made_.reset();
    packets_ = all_packets_of(run);
    made_ = key;
  }
  const auto begin = static_cast<std::size_t>(run.first_tile), count = static_cast<std::size_t>(run.tiles);
  if (begin + count > packets_.size())
    fail(run, "the restored image has " + std::to_string(packets_.size()) + " tiles only");
  std::vector<Packet> packets(packets_.begin() + run.first_tile, packets_.begin() + run.first_tile + run.tiles);
  if (checksum_of(packets) == run.checksum) return packets;
  fail(run, images_.at(key).recording
                ? "the recorded image is not the image that was flown"
                : "made again it is not the image that was flown; images are the same to the last bit only with the "
                  "same mission, data, program and kind of processor");
}

std::vector<Packet> TileRestorer::all_packets_of(const TileRun& run) const {
  const auto image = images_.find(run.key());
  if (image == images_.end()) fail(run, "the log holds neither recipe nor pixels of it");
  if (image->second.recording) return recorded_packets(*image->second.recording, run);
  return make_image_(*recipe_of(log_.recipes[*image->second.recipe]));
}

std::vector<Packet> TileRestorer::recorded_packets(std::size_t recording, const TileRun& run) const {
  const std::vector<std::uint8_t>& bytes = log_.recordings[recording].bytes;
  const ImageHeader header = *header_of_recorded_image(bytes);
  try {
    return image_tiles(header.label, header.region, header.bits, pixels_of_recorded_image(bytes));
  } catch (const std::exception& error) {
    throw DamagedLog(log_.file.string() + ": image " + std::to_string(run.image) + ", at byte " +
                     std::to_string(log_.recordings[recording].offset) + ", " + error.what());
  }
}

std::vector<fsw::GpsTime> TileRestorer::exposures() const {
  std::vector<fsw::GpsTime> times;
  times.reserve(keys_.size());
  for (const auto& [time, key] : keys_) times.push_back(time);
  return times;
}

const TileRestorer::Image* TileRestorer::find(fsw::GpsTime exposure) const {
  const auto key = keys_.find(exposure);
  return key == keys_.end() ? nullptr : &images_.at(key->second);
}

std::optional<LoggedImage> TileRestorer::recipe_at(fsw::GpsTime exposure) const {
  const Image* const image = find(exposure);
  if (image == nullptr || !image->recipe) return std::nullopt;
  return LoggedImage{keys_.at(exposure), log_.recipes[*image->recipe]};
}

std::optional<LoggedImage> TileRestorer::recording_at(fsw::GpsTime exposure) const {
  const Image* const image = find(exposure);
  if (image == nullptr || !image->recording) return std::nullopt;
  return LoggedImage{keys_.at(exposure), log_.recordings[*image->recording].bytes};
}

}  // namespace vbar::twins::camera
