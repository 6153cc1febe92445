#include "hil_drivers/tron/protocols/vicon_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

namespace vbar::tron::vicon {

namespace {

namespace endian = boost::endian;

[[noreturn]] void refuse(std::size_t at, const std::string& what) {
  throw std::invalid_argument(fmt::format("Vicon block, byte {}: {}", at, what));
}

std::uint64_t bits_of(double number) {
  return std::bit_cast<std::uint64_t>(number);
}

void append_number(Bytes& bytes, double number) {
  bytes.resize(bytes.size() + sizeof(double));
  endian::store_little_u64(bytes.data() + bytes.size() - sizeof(double), bits_of(number));
}

void append_object(Bytes& bytes, const TrackedObject& object) {
  if (object.name.empty() || object.name.size() > kNameBytes || object.name.find('\0') != std::string::npos)
    throw std::invalid_argument(fmt::format(
        "the name of an object of motion capture has 1 to {} bytes, none of them zero: '{}'", kNameBytes, object.name));
  bytes.push_back(kObjectKind);
  bytes.resize(bytes.size() + 2);
  endian::store_little_u16(bytes.data() + bytes.size() - 2, kObjectBytes);
  bytes.insert(bytes.end(), object.name.begin(), object.name.end());
  bytes.resize(bytes.size() + kNameBytes - object.name.size());
  for (const double number : object.translation_mm) append_number(bytes, number);
  for (const double number : object.rotation_rad) append_number(bytes, number);
}

std::string decode_name(ByteSpan datagram, std::size_t at) {
  const ByteSpan field = datagram.subspan(at, kNameBytes);
  const auto end = std::ranges::find(field, 0);
  const std::string name(field.begin(), end);
  if (name.empty()) refuse(at, "an object without a name");
  if (!std::ranges::all_of(name, [](char c) { return c >= ' ' && c <= '~'; }))
    refuse(at, "the name of an object is not printable ASCII");
  return name;
}

double decode_number(ByteSpan datagram, std::size_t at) {
  const auto number = std::bit_cast<double>(endian::load_little_u64(datagram.data() + at));
  if (!std::isfinite(number)) refuse(at, "a number of an object is not finite");
  return number;
}

TrackedObject decode_object(ByteSpan datagram, std::size_t at) {
  TrackedObject object;
  object.name = decode_name(datagram, at);
  std::size_t place = at + kNameBytes;
  for (auto* numbers : {&object.translation_mm, &object.rotation_rad})
    for (double& number : *numbers) {
      number = decode_number(datagram, place);
      place += sizeof(double);
    }
  return object;
}

}  // namespace

bool TrackedObject::is_occluded() const {
  const auto is_zero = [](double number) { return number == 0.0; };
  return std::ranges::all_of(translation_mm, is_zero) && std::ranges::all_of(rotation_rad, is_zero);
}

bool TrackedObject::has_same_numbers(const TrackedObject& other) const {
  return std::ranges::equal(translation_mm, other.translation_mm, {}, bits_of, bits_of) &&
         std::ranges::equal(rotation_rad, other.rotation_rad, {}, bits_of, bits_of);
}

const TrackedObject* ObjectBlock::find(std::string_view name) const {
  const auto found = std::ranges::find(objects, name, &TrackedObject::name);
  return found == objects.end() ? nullptr : &*found;
}

std::vector<Bytes> encode_frame(const ObjectBlock& frame, std::size_t block_bytes) {
  if (std::ranges::find(kBlockBytes, block_bytes) == kBlockBytes.end())
    throw std::invalid_argument(fmt::format("a Vicon block of {} bytes; accepted: 0, 256, 512, 1024", block_bytes));
  const bool is_padded = block_bytes > 0;
  const std::size_t capacity = is_padded ? (block_bytes - kHeaderBytes) / kItemBytes : kMaxItems;
  if (!is_padded && frame.objects.size() > capacity)
    throw std::invalid_argument(
        fmt::format("{} objects; an unpadded Vicon block has at most {}", frame.objects.size(), capacity));
  std::vector<Bytes> blocks;
  std::size_t next = 0;
  do {
    const std::size_t count = std::min(capacity, frame.objects.size() - next);
    Bytes& block = blocks.emplace_back(kHeaderBytes);
    endian::store_little_u32(block.data(), frame.frame);
    block[4] = static_cast<std::uint8_t>(count);
    for (std::size_t k = 0; k < count; ++k) append_object(block, frame.objects[next + k]);
    if (is_padded) block.resize(block_bytes);
    next += count;
  } while (next < frame.objects.size());
  return blocks;
}

ObjectBlock decode_block(ByteSpan datagram) {
  if (datagram.size() < kHeaderBytes)
    refuse(0, fmt::format("{} bytes; the header has {}", datagram.size(), kHeaderBytes));
  ObjectBlock block;
  block.frame = endian::load_little_u32(datagram.data());
  std::size_t at = kHeaderBytes;
  for (int item = 0; item < datagram[4]; ++item) {
    if (datagram.size() - at < kItemHeaderBytes) refuse(at, fmt::format("the block ends before item {}", item + 1));
    const std::uint8_t kind = datagram[at];
    const std::size_t size = endian::load_little_u16(datagram.data() + at + 1);
    const std::size_t begin = at + kItemHeaderBytes;
    if (datagram.size() - begin < size) refuse(at, fmt::format("the block ends within item {}", item + 1));
    if (kind == kObjectKind) {
      if (size != kObjectBytes) refuse(at + 1, fmt::format("an object of {} bytes instead of {}", size, kObjectBytes));
      TrackedObject object = decode_object(datagram, begin);
      if (block.find(object.name) != nullptr) refuse(begin, fmt::format("object '{}' is given twice", object.name));
      block.objects.push_back(std::move(object));
    }
    at = begin + size;
  }
  return block;
}

namespace {

std::array<Eigen::Index, 3> axes_of(std::string_view order) {
  if (std::ranges::find(kRotationOrders, order) == kRotationOrders.end())
    throw std::invalid_argument("'" + std::string(order) + "' is not an order of three rotations; one is xyz");
  return {order[0] - 'x', order[1] - 'x', order[2] - 'x'};
}

}  // namespace

fsw::Matrix3 rotation_of(const std::array<double, 3>& angles_rad, std::string_view order) {
  fsw::Matrix3 rotation = fsw::Matrix3::Identity();
  for (const Eigen::Index axis : axes_of(order))
    rotation =
        rotation *
        Eigen::AngleAxisd(angles_rad[static_cast<std::size_t>(axis)], fsw::Vector3::Unit(axis)).toRotationMatrix();
  return rotation;
}

std::array<double, 3> angles_of(const fsw::Matrix3& rotation, std::string_view order) {
  const auto axes = axes_of(order);
  const fsw::Vector3 in_order = rotation.eulerAngles(axes[0], axes[1], axes[2]);
  std::array<double, 3> angles{};
  for (std::size_t k = 0; k < 3; ++k)
    angles[static_cast<std::size_t>(axes[k])] = in_order[static_cast<Eigen::Index>(k)];
  return angles;
}

}  // namespace vbar::tron::vicon
