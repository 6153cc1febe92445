#include "host_sim/report/provenance.h"

#include <array>
#include <utility>

#include <nlohmann/json.hpp>

#include "host_sim/files/sha256.h"

namespace vbar::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, std::string Provenance::*>, 9> kTexts{
    {{"vbar_version", &Provenance::vbar_version},
     {"commit", &Provenance::commit},
     {"compiler", &Provenance::compiler},
     {"build_type", &Provenance::build_type},
     {"program_sha256", &Provenance::program_sha256},
     {"host", &Provenance::host},
     {"started_utc", &Provenance::started_utc},
     {"epoch_utc", &Provenance::epoch_utc},
     {"mission_sha256", &Provenance::mission_sha256}}};

Json json_of(const FileDigest& digest) {
  return {{"file", digest.file}, {"bytes", digest.bytes}, {"sha256", digest.sha256}};
}

Json json_of(const std::optional<FileDigest>& digest) {
  return digest ? json_of(*digest) : Json(nullptr);
}

FileDigest digest_from(const Json& json) {
  return {json.at("file").get<std::string>(), json.at("bytes").get<std::uint64_t>(),
          json.at("sha256").get<std::string>()};
}

std::optional<FileDigest> optional_digest(const Json& json, const char* key) {
  if (!json.contains(key) || json.at(key).is_null()) return std::nullopt;
  return digest_from(json.at(key));
}

}  // namespace

std::optional<FileDigest> digest_of(const std::filesystem::path& file) {
  auto sha256 = files::sha256_of_file(file);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (!sha256 || error) return std::nullopt;
  return FileDigest{file.string(), bytes, std::move(*sha256)};
}

Json json_of(const Provenance& provenance) {
  Json json = Json::object();
  for (const auto& [key, text] : kTexts) json[key] = provenance.*text;
  json["overrides"] = provenance.overrides;
  json["flight_software"] = json_of(provenance.flight_software);
  json["data"] = Json::array();
  for (const FileDigest& file : provenance.data) json["data"].push_back(json_of(file));
  json["packet_log"] = json_of(provenance.packet_log);
  return json;
}

Provenance provenance_from(const Json& json) {
  Provenance provenance;
  if (!json.is_object()) return provenance;
  for (const auto& [key, text] : kTexts) provenance.*text = json.value(key, std::string());
  provenance.overrides = json.value("overrides", std::vector<std::string>());
  provenance.flight_software = optional_digest(json, "flight_software");
  if (json.contains("data"))
    for (const Json& file : json.at("data")) provenance.data.push_back(digest_from(file));
  provenance.packet_log = optional_digest(json, "packet_log");
  return provenance;
}

}  // namespace vbar::report
