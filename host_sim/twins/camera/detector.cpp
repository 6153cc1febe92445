#include "host_sim/twins/camera/detector.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/pixel_noise.h"

namespace vbar::twins::camera {
namespace {

engine::RandomStream stream_of(std::uint64_t seed, std::string_view camera_name, std::string_view what) {
  return {seed, std::string(camera_name) + "/" + std::string(what)};
}

std::size_t up_to_whole_chunks(std::size_t pixels) {
  return (pixels + kChunk - 1) / kChunk * kChunk;
}

std::span<float, kChunk> chunk_of(std::vector<float>& values, std::size_t chunk) {
  return std::span<float, kChunk>(values.data() + chunk * kChunk, kChunk);
}

}  // namespace

Detector::Detector(const CameraSettings& settings, std::uint64_t seed, std::string_view camera_name)
    : Detector(settings, seed, camera_name, draw_hot_pixels(settings.detector, settings.region, seed, camera_name)) {}

Detector::Detector(const CameraSettings& settings, std::uint64_t seed, std::string_view camera_name,
                   std::span<const HotPixel> hot_pixels)
    : settings_(settings),
      pixels_(static_cast<std::size_t>(settings.region.width) * static_cast<std::size_t>(settings.region.height)),
      noise_key_(stream_of(seed, camera_name, "pixel_noise").bits()),
      hot_pixels_(hot_pixels.begin(), hot_pixels.end()),
      response_(up_to_whole_chunks(pixels_)),
      dark_electrons_(up_to_whole_chunks(pixels_)),
      charge_(up_to_whole_chunks(pixels_)) {
  draw_fixed_pattern(seed, camera_name);
  add_hot_pixels();
}

/// By the position of the pixel on the detector, so that another region shows the same pattern.
void Detector::draw_fixed_pattern(std::uint64_t seed, std::string_view camera_name) {
  const DetectorSettings& detector = settings_.detector;
  const Region& region = settings_.region;
  const engine::RandomStream stream = stream_of(seed, camera_name, "fixed_pattern");
  std::size_t pixel = 0;
  for (int y = region.y; y < region.y + region.height; ++y) {
    for (int x = region.x; x < region.x + region.width; ++x, ++pixel) {
      const auto place = static_cast<std::uint64_t>(y) << 32U | static_cast<std::uint64_t>(x);
      const auto uniform = stream.uniforms_of(place);
      const double response = 1.0 + detector.photo_response_nonuniformity * engine::normal_quantile(uniform[0]);
      const double dark = 1.0 + detector.dark_nonuniformity * engine::normal_quantile(uniform[1]);
      response_[pixel] = static_cast<float>(std::max(0.0, response));
      dark_electrons_[pixel] =
          static_cast<float>(std::max(0.0, dark) * detector.dark_electrons_per_s * settings_.exposure_s);
    }
  }
}

std::vector<HotPixel> draw_hot_pixels(const DetectorSettings& detector, const Region& region, std::uint64_t seed,
                                      std::string_view camera_name) {
  std::vector<HotPixel> hot_pixels;
  engine::RandomStream stream = stream_of(seed, camera_name, "hot_pixels");
  for (int k = 0; k < detector.hot_pixels; ++k) {  // two may fall on one pixel: then it is the hotter
    const int column = std::min(static_cast<int>(stream.uniform(0.0, region.width)), region.width - 1);
    const int row = std::min(static_cast<int>(stream.uniform(0.0, region.height)), region.height - 1);
    const double electrons_per_s = detector.hot_pixel_electrons_per_s * stream.exponential();
    hot_pixels.push_back({region.x + column, region.y + row, electrons_per_s});
  }
  return hot_pixels;
}

void Detector::add_hot_pixels() {
  const Region& region = settings_.region;
  std::erase_if(hot_pixels_, [&](const HotPixel& hot) {
    return hot.x < region.x || hot.y < region.y || hot.x >= region.x + region.width ||
           hot.y >= region.y + region.height;
  });
  for (const HotPixel& hot : hot_pixels_) {
    const auto pixel = static_cast<std::size_t>(hot.y - region.y) * static_cast<std::size_t>(region.width) +
                       static_cast<std::size_t>(hot.x - region.x);
    dark_electrons_[pixel] += static_cast<float>(hot.electrons_per_s * settings_.exposure_s);
  }
}

void Detector::expose(const PhotonImage& image, std::int64_t exposure_number, std::vector<std::uint16_t>& dn,
                      std::optional<double> duration_s) {
  if (image.region != settings_.region || image.electrons.size() != pixels_)
    throw std::invalid_argument("the image is not of the region that the detector reads");
  const auto exposure = static_cast<std::uint64_t>(exposure_number);
  const double dark_share = duration_s ? *duration_s / settings_.exposure_s : 1.0;
  collect(image, exposure, static_cast<float>(dark_share));
  const BloomingSettings blooming{settings_.detector.full_well_electrons, settings_.detector.blooming_fraction};
  drained_electrons_ = bloom(blooming, settings_.region.width, settings_.region.height, charge_);
  read_out(exposure, dn);
}

void Detector::collect(const PhotonImage& image, std::uint64_t exposure, float dark_share) {
  const NoiseKey key{noise_key_, exposure};
  ChunkWords words;
  ChunkFloats means{};
  for (std::size_t chunk = 0; chunk * kChunk < pixels_; ++chunk) {
    const std::size_t begin = chunk * kChunk;
    const std::size_t count = std::min(kChunk, pixels_ - begin);
    for (std::size_t k = 0; k < count; ++k)
      means[k] = image.electrons[begin + k] * response_[begin + k] + dark_share * dark_electrons_[begin + k];
    draw_words(key, NoiseKind::kShot, static_cast<std::uint32_t>(chunk), words);
    poisson_numbers(words, means, chunk_of(charge_, chunk));
  }
}

void Detector::read_out(std::uint64_t exposure, std::vector<std::uint16_t>& dn) const {
  const DetectorSettings& detector = settings_.detector;
  const NoiseKey key{noise_key_, exposure};
  const auto gain = static_cast<float>(detector.gain_dn_per_electron);
  const auto noise_dn = static_cast<float>(detector.gain_dn_per_electron * detector.read_noise_electrons);
  const auto zero = static_cast<float>(detector.offset_dn + 0.5);
  const auto most = static_cast<float>((1 << detector.bits) - 1);
  ChunkWords words;
  ChunkFloats normal;
  dn.resize(pixels_);
  for (std::size_t chunk = 0; chunk * kChunk < pixels_; ++chunk) {
    const std::size_t begin = chunk * kChunk;
    const std::size_t count = std::min(kChunk, pixels_ - begin);
    draw_words(key, NoiseKind::kRead, static_cast<std::uint32_t>(chunk), words);
    normal_numbers(words, normal);
    for (std::size_t k = 0; k < count; ++k) {
      const float level = zero + (gain * charge_[begin + k] + noise_dn * normal[k]);
      const float above = level > 0.0F ? level : 0.0F;
      dn[begin + k] = static_cast<std::uint16_t>(static_cast<std::int32_t>(above < most ? above : most));
    }
  }
}

}  // namespace vbar::twins::camera
