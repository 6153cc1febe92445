// The COBS decoder and parse_frame on an arbitrary byte stream. Promises: no frame is longer than allowed, what parses
// is written back to the same bytes, and every byte string survives COBS.

#include <algorithm>
#include <array>
#include <span>

#include "fsw/link/frame.h"
#include "fsw/packets/crc.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace link = vbar::fsw::link;
using Frame = std::array<std::uint8_t, link::kMaxFrameBytes>;

void try_frame(std::span<const std::uint8_t> bytes) {
  VBAR_FUZZ_EXPECT(bytes.size() <= link::kMaxFrameBytes);
  const vbar::fsw::Result<link::FrameView> frame = link::parse_frame(bytes);
  if (!frame.ok()) return;
  Frame again{};
  const auto size = link::write_frame(frame.value().header, frame.value().payload, again);
  VBAR_FUZZ_EXPECT(size.ok() && size.value() == bytes.size());
  VBAR_FUZZ_EXPECT(std::equal(bytes.begin(), bytes.end(), again.begin()));
}

void try_stream(std::span<const std::uint8_t> stream) {
  link::CobsDecoder decoder;
  for (const std::uint8_t byte : stream) {
    if (decoder.push(byte)) try_frame(decoder.frame());
  }
}

/// The input with a CRC that fits, which a fuzzer does not guess.
void try_signed(std::span<const std::uint8_t> bytes) {
  Frame frame{};
  const std::size_t size = std::min(bytes.size(), frame.size() - link::kFrameCrcBytes);
  std::copy_n(bytes.begin(), size, frame.begin());
  const std::uint32_t crc = vbar::fsw::packets::crc32_ieee(std::span(frame).first(size));
  for (std::size_t i = 0; i < link::kFrameCrcBytes; ++i) frame[size + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  try_frame(std::span(frame).first(size + link::kFrameCrcBytes));
}

void expect_survives_cobs(std::span<const std::uint8_t> bytes) {
  const auto data = bytes.first(std::min(bytes.size(), link::kMaxFrameBytes));
  std::array<std::uint8_t, link::kMaxCobsFrameBytes> code{};
  const auto size = link::cobs_encode(data, code);
  VBAR_FUZZ_EXPECT(size.ok());
  link::CobsDecoder decoder;
  for (std::size_t i = 0; i < size.value(); ++i) {
    const bool complete = decoder.push(code[i]);
    VBAR_FUZZ_EXPECT(complete == (i + 1 == size.value()));
  }
  VBAR_FUZZ_EXPECT(std::equal(data.begin(), data.end(), decoder.frame().begin(), decoder.frame().end()));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  try_stream(bytes);
  try_signed(bytes);
  expect_survives_cobs(bytes);
  return 0;
}
