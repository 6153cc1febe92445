#include "host_sim/twins/camera/recorded_image.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <charls/charls.h>
#include <vbar_host/recorded_image.hpp>

#include "fsw/packets/big_endian.h"
#include "host_sim/twins/camera/image_recipe.h"

namespace vbar::twins::camera {
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

}  // namespace vbar::twins::camera
