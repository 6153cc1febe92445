#include "host_sim/star_images/grey_image.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/core.h>

#include "fsw/vision/imaging/image.h"
#include "host_sim/files/output_file.h"

namespace vbar::star_images {
namespace {

constexpr int kSmallestSide = 64;
constexpr int kLargest12 = 4095;

[[noreturn]] void refuse(const std::string& file, std::string_view found, std::string_view accepted) {
  throw ImageRefused(fmt::format("{}: found {}; accepted: {}", file, found, accepted));
}

/// Checks the size before memory is taken for it.
void take_size(GreyImage& image, std::uint64_t width, std::uint64_t height, const std::string& file) {
  constexpr auto kLargestSide = static_cast<std::uint64_t>(fsw::imaging::kMaxSide);
  if (width < kSmallestSide || height < kSmallestSide || width > kLargestSide || height > kLargestSide)
    refuse(file, fmt::format("{} x {} pixels", width, height),
           fmt::format("{} to {} a side", kSmallestSide, kLargestSide));
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.pixels.reserve(static_cast<std::size_t>(width * height));
}

/// Appends `count` pixels of one or two bytes.
void append(GreyImage& image, std::string_view bytes, std::size_t count, bool two_bytes, bool big_endian) {
  const auto at = [&](std::size_t k) { return static_cast<unsigned>(static_cast<unsigned char>(bytes[k])); };
  for (std::size_t k = 0; k < count; ++k) {
    const unsigned value = !two_bytes   ? at(k)
                           : big_endian ? at(2 * k) << 8U | at(2 * k + 1)
                                        : at(2 * k + 1) << 8U | at(2 * k);
    image.pixels.push_back(static_cast<std::uint16_t>(value));
  }
}

GreyImage finished(GreyImage image, bool two_bytes) {
  image.bits = two_bytes ? 12 : 8;
  if (two_bytes && *std::ranges::max_element(image.pixels) > kLargest12)
    for (std::uint16_t& pixel : image.pixels) pixel = static_cast<std::uint16_t>(pixel >> 4U);
  return image;
}

class Pgm {
 public:
  Pgm(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  GreyImage read() {
    GreyImage image;
    const std::uint64_t width = number("the width");
    take_size(image, width, number("the height"), file_);
    const std::uint64_t largest = number("the largest value");
    if (largest < 1 || largest > 65535) refuse(file_, fmt::format("{} as largest value", largest), "1 to 65535");
    ++at_;  // one blank before the pixels
    const bool two_bytes = largest > 255;
    const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    const std::size_t size = count * (two_bytes ? 2 : 1);
    if (at_ > bytes_.size() || bytes_.size() - at_ < size)
      refuse(file_, fmt::format("{} bytes of pixels", bytes_.size() - std::min(at_, bytes_.size())),
             fmt::format("{} of this size", size));
    append(image, std::string_view(bytes_).substr(at_), count, two_bytes, true);
    return finished(std::move(image), two_bytes);
  }

 private:
  std::uint64_t number(std::string_view what) {
    const auto is_blank = [&] { return std::isspace(static_cast<unsigned char>(bytes_[at_])) != 0; };
    while (at_ < bytes_.size() && (is_blank() || bytes_[at_] == '#')) {
      if (bytes_[at_] == '#')
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      else
        ++at_;
    }
    std::uint64_t value = 0;
    const std::size_t first = at_;
    for (; at_ < bytes_.size() && at_ - first < 8 && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_)
      value = 10 * value + static_cast<std::uint64_t>(bytes_[at_] - '0');
    if (at_ == first || at_ == bytes_.size() || !is_blank())
      refuse(file_, fmt::format("no number for {} at byte {}", what, first), "P5, width, height and largest value");
    return value;
  }

  const std::string& bytes_;
  const std::string& file_;
  std::size_t at_ = 2;
};

/// Baseline TIFF 6.0 (Adobe 1992), the first image of the file.
class Tiff {
 public:
  Tiff(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file), big_endian_(bytes[0] == 'M') {}

  GreyImage read() {
    read_directory();
    if (const std::uint32_t samples = field(kSamples, 1); samples != 1)
      refuse(file_, fmt::format("{} values a pixel", samples), "1 (grey)");
    if (const std::uint32_t method = field(kCompression, 1); method != 1)
      refuse(file_, fmt::format("compression {}", method), "1 (none)");
    const std::uint32_t bits = field(kBits, 1);
    if (bits != 8 && bits != 16) refuse(file_, fmt::format("{} bits a pixel", bits), "8, 16");
    if (const std::uint32_t white = field(kPhotometric, 1); white != 1)
      refuse(file_, fmt::format("photometric interpretation {}", white), "1 (0 is black)");
    GreyImage image;
    take_size(image, field(kWidth, 0), field(kHeight, 0), file_);
    read_strips(image, bits == 16);
    return finished(std::move(image), bits == 16);
  }

 private:
  static constexpr int kWidth = 256, kHeight = 257, kBits = 258, kCompression = 259, kPhotometric = 262;
  static constexpr int kStripOffsets = 273, kSamples = 277, kRowsOfStrip = 278;
  struct Field {
    std::uint32_t type = 0, count = 0, place = 0;  ///< place: of its values, or of its offset, in the file
  };

  [[nodiscard]] std::uint32_t integer(std::uint64_t at, int size) const {
    if (at + static_cast<std::uint64_t>(size) > bytes_.size())
      refuse(file_, fmt::format("{} bytes", bytes_.size()),
             fmt::format("a file that reaches byte {}", at + static_cast<std::uint64_t>(size)));
    std::uint32_t value = 0;
    for (int k = 0; k < size; ++k) {
      const int place = big_endian_ ? k : size - 1 - k;
      value = value << 8U | static_cast<unsigned char>(bytes_[at + static_cast<std::uint64_t>(place)]);
    }
    return value;
  }

  void read_directory() {
    const std::uint64_t directory = integer(4, 4);
    const std::uint32_t entries = integer(directory, 2);
    for (std::uint32_t k = 0; k < entries; ++k) {
      const std::uint64_t entry = directory + 2 + 12 * std::uint64_t{k};
      fields_[static_cast<int>(integer(entry, 2))] = {integer(entry + 2, 2), integer(entry + 4, 4),
                                                      static_cast<std::uint32_t>(entry + 8)};
    }
  }

  [[nodiscard]] std::uint32_t element(const Field& field, std::uint32_t index) const {
    const int size = field.type == 3 ? 2 : 4;
    if (field.type != 3 && field.type != 4) refuse(file_, fmt::format("type {} of a field", field.type), "3, 4");
    const bool is_inside = std::uint64_t{field.count} * static_cast<std::uint64_t>(size) <= 4;
    const std::uint64_t values = is_inside ? field.place : integer(field.place, 4);
    return integer(values + std::uint64_t{index} * static_cast<std::uint64_t>(size), size);
  }

  [[nodiscard]] std::uint32_t field(int tag, std::uint32_t otherwise) const {
    const auto found = fields_.find(tag);
    return found == fields_.end() ? otherwise : element(found->second, 0);
  }

  void read_strips(GreyImage& image, bool two_bytes) const {
    const auto offsets = fields_.find(kStripOffsets);
    if (offsets == fields_.end()) refuse(file_, "no strips", "an image in strips");
    const auto height = static_cast<std::uint32_t>(image.height);
    const std::uint32_t rows = std::clamp(field(kRowsOfStrip, height), std::uint32_t{1}, height);
    if (const std::uint32_t strips = (height + rows - 1) / rows; offsets->second.count != strips)
      refuse(file_, fmt::format("{} strips", offsets->second.count), fmt::format("{} of this height", strips));
    for (std::uint32_t strip = 0; strip * rows < height; ++strip) {
      const std::size_t count =
          std::size_t{std::min(rows, height - strip * rows)} * static_cast<std::size_t>(image.width);
      const std::uint64_t at = element(offsets->second, strip);
      const std::uint64_t size = count * (two_bytes ? 2U : 1U);
      if (at > bytes_.size() || bytes_.size() - at < size)
        refuse(file_, fmt::format("{} bytes", bytes_.size()), fmt::format("a file that reaches byte {}", at + size));
      append(image, std::string_view(bytes_).substr(at, size), count, two_bytes, big_endian_);
    }
  }

  const std::string& bytes_;
  const std::string& file_;
  bool big_endian_;
  std::map<int, Field> fields_;
};

}  // namespace

GreyImage grey_image_of(const std::string& bytes, const std::string& file) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("P5")) return Pgm(bytes, file).read();
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return Tiff(bytes, file).read();
  refuse(file, "another format", "PGM (P5), TIFF; ImageMagick converts: convert IMAGE image.pgm");
}

GreyImage read_grey_image(const std::filesystem::path& file) {
  const std::optional<std::string> bytes = files::contents_of(file);
  if (!bytes) throw ImageRefused(file.string() + ": cannot be read");
  return grey_image_of(*bytes, file.string());
}

}  // namespace vbar::star_images
