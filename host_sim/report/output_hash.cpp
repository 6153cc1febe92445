#include "host_sim/report/output_hash.h"

#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/packet.h"

namespace vbar::report {
namespace {

using fsw::packets::Apid;

struct ContextFreer {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
using Context = std::unique_ptr<EVP_MD_CTX, ContextFreer>;

void check(bool good) {
  if (!good) throw std::runtime_error("SHA-256 cannot be computed: OpenSSL refuses it");
}

Context new_context() {
  Context context(EVP_MD_CTX_new());
  check(context != nullptr);
  return context;
}

}  // namespace

struct OutputHash::Digest {
  Context context = new_context();

  Digest() { check(EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1); }

  void add(std::span<const std::uint8_t> bytes) {
    check(EVP_DigestUpdate(context.get(), bytes.data(), bytes.size()) == 1);
  }

  // A copy is finished, so that more can be added afterwards.
  [[nodiscard]] std::string hexadecimal() const {
    const Context copy = new_context();
    std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    check(EVP_MD_CTX_copy_ex(copy.get(), context.get()) == 1);
    check(EVP_DigestFinal_ex(copy.get(), digest.data(), &size) == 1);
    return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
  }
};

OutputHash::OutputHash() : commands_(std::make_unique<Digest>()), telemetry_(std::make_unique<Digest>()) {}
OutputHash::~OutputHash() = default;
OutputHash::OutputHash(OutputHash&&) noexcept = default;
OutputHash& OutputHash::operator=(OutputHash&&) noexcept = default;

void OutputHash::add(std::span<const std::uint8_t> packet) {
  if (packet.size() < 2) return;
  constexpr std::uint16_t kApidBits = 0x07FF;
  const auto apid = static_cast<Apid>(fsw::packets::read_big_endian<std::uint16_t>(packet, 0) & kApidBits);
  if (apid == Apid::kManeuverCommand) commands_->add(packet);
  if (fsw::packets::is_telemetry(apid)) telemetry_->add(packet);
}

std::string OutputHash::commands_sha256() const {
  return commands_->hexadecimal();
}
std::string OutputHash::telemetry_sha256() const {
  return telemetry_->hexadecimal();
}

}  // namespace vbar::report
