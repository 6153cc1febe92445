#pragma once
// Register memory of the emulated camera: bootstrap registers, features and the GenICam description. Writes from
// the network are checked here; their effects are the device's.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/gige/device/features.h"
#include "hil_drivers/gige/wire/gvcp.h"

namespace vbar::gige {

class Registers {
 public:
  /// Throws std::invalid_argument if the description does not fit: text too long, a sensor without pixels, bits out of
  /// range. `ip_address` as a number.
  Registers(const Description& description, std::uint32_t ip_address);

  // Access by address, from the network.
  struct Read {
    wire::Status status = wire::Status::kSuccess;
    wire::Bytes bytes;
  };
  [[nodiscard]] Read read(std::uint32_t address, std::size_t count) const;
  struct Written {
    wire::Status status = wire::Status::kSuccess;
    std::optional<FeatureId> feature;  ///< empty for a bootstrap register
  };
  Written write(std::uint32_t address, wire::ByteSpan bytes);

  // Access by the device.
  [[nodiscard]] std::uint32_t word(std::uint32_t address) const;
  void set_word(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] double value(FeatureId id) const;
  [[nodiscard]] std::uint32_t integer(FeatureId id) const;

  void lock_for_acquisition(bool locked) { is_acquiring_ = locked; }
  void refuse_region(bool refused) { region_is_refused_ = refused; }
  /// Overwrites a part of the GenICam description, or restores it.
  void damage_xml(bool damaged);

 private:
  void put_text(std::uint32_t address, std::size_t size, const std::string& text, const char* what);
  void put_bootstrap(const Description& description, std::uint32_t ip_address);
  void put(const Feature& feature, double value);
  void update_dependent();
  [[nodiscard]] const Feature& feature(FeatureId id) const { return features_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] const Feature* feature_at(std::uint32_t address) const;
  [[nodiscard]] wire::Status check(const Feature& feature, double value) const;
  Written write_feature(const Feature& feature, wire::ByteSpan bytes);
  wire::Status write_bootstrap(std::uint32_t address, std::uint32_t value);

  std::vector<Feature> features_;
  std::string xml_;
  wire::Bytes memory_;
  bool is_acquiring_ = false;
  bool region_is_refused_ = false;
};

}  // namespace vbar::gige
