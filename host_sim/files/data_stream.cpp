#include "host_sim/files/data_stream.h"

#include <array>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"

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

namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "SHA256SUMS";

struct Registry {
  std::mutex mutex;
  std::map<fs::path, FileRead> files;
};

Registry& registry() {
  static Registry one;
  return one;
}

thread_local int unrecorded_depth = 0;

/// Returns the digest that `manifest` lists for `name`: lines of sha256sum, "digest  ./name" or "digest  name".
std::optional<std::string> listed_in(const fs::path& manifest, const std::string& name) {
  std::ifstream lines(manifest);
  for (std::string line; std::getline(lines, line);) {
    constexpr std::size_t kDigits = 64;
    if (line.size() < kDigits + 3) continue;
    std::string listed = line.substr(kDigits + 2);
    if (listed.starts_with("./")) listed.erase(0, 2);
    if (listed == name) return line.substr(0, kDigits);
  }
  return std::nullopt;
}

/// Data files stand in a folder of the data directory, whose manifest lists them.
void check_manifest(const fs::path& file, const std::string& sha256) {
  const fs::path room = file.parent_path(), data = room.parent_path(), manifest = data / kManifest;
  std::error_code error;
  if (!fs::is_regular_file(manifest, error)) return;
  const auto listed = listed_in(manifest, (room.filename() / file.filename()).string());
  if (listed && *listed != sha256)
    throw std::runtime_error(file.string() + ": differs from what " + manifest.string() +
                             " lists: truncated or changed (ci/data_checksums.sh lists a change that is intended)");
}

}  // namespace

std::vector<FileRead> files_read() {
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  std::vector<FileRead> files;
  for (const auto& [path, file] : all.files) files.push_back(file);
  return files;
}

UnrecordedReads::UnrecordedReads() {
  ++unrecorded_depth;
}

UnrecordedReads::~UnrecordedReads() {
  --unrecorded_depth;
}

void note_file_read(const fs::path& file, std::string_view contents) {
  std::error_code error;
  fs::path absolute = fs::absolute(file, error).lexically_normal();
  FileRead read{absolute, contents.size(), sha256_of(contents)};
  check_manifest(absolute, read.sha256);
  if (unrecorded_depth > 0) return;
  Registry& all = registry();
  const std::lock_guard lock(all.mutex);
  all.files.insert_or_assign(std::move(absolute), std::move(read));
}

DataStream::DataStream(const fs::path& file) {
  std::optional<std::string> contents = contents_of(file);
  if (!contents) {
    setstate(std::ios::failbit);
    return;
  }
  note_file_read(file, *contents);
  str(plain_text(*std::move(contents), file.string()));
}

}  // namespace vbar::files
