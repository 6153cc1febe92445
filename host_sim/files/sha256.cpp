#include "host_sim/files/sha256.h"

#include <array>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <openssl/evp.h>

namespace vbar::files {
namespace {

struct ContextFreer {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
using Handle = std::unique_ptr<EVP_MD_CTX, ContextFreer>;

void check(bool good) {
  if (!good) throw std::runtime_error("SHA-256 cannot be computed: OpenSSL refuses it");
}

Handle new_handle() {
  Handle handle(EVP_MD_CTX_new());
  check(handle != nullptr);
  return handle;
}

}  // namespace

struct Sha256::Context {
  Handle handle = new_handle();
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  check(EVP_DigestInit_ex(context_->handle.get(), EVP_sha256(), nullptr) == 1);
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::add(std::span<const std::uint8_t> bytes) {
  check(EVP_DigestUpdate(context_->handle.get(), bytes.data(), bytes.size()) == 1);
}

void Sha256::add(std::string_view bytes) {
  check(EVP_DigestUpdate(context_->handle.get(), bytes.data(), bytes.size()) == 1);
}

std::string Sha256::hexadecimal() const {
  const Handle copy = new_handle();
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  check(EVP_MD_CTX_copy_ex(copy.get(), context_->handle.get()) == 1);
  check(EVP_DigestFinal_ex(copy.get(), digest.data(), &size) == 1);
  return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
}

std::string sha256_of(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.hexadecimal();
}

std::optional<std::string> sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file)) return std::nullopt;
  Sha256 hash;
  std::array<char, 65536> block{};
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    hash.add(std::string_view(block.data(), static_cast<std::size_t>(stream.gcount())));
  if (stream.bad()) return std::nullopt;
  return hash.hexadecimal();
}

}  // namespace vbar::files
