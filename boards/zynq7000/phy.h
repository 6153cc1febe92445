#pragma once
// Ethernet PHY of any type on the controller's management bus (IEEE 802.3 clause 22).

#include <cstdint>
#include <optional>

#include "boards/zynq7000/clocks.h"

namespace vbar::boards::zynq7000 {

struct PhyLink {
  LineRate rate = LineRate::k1000Mbps;
  bool full_duplex = true;
};

/// PHY at an address on the management bus of the controller at `controller`.
class Phy {
 public:
  /// Finds the PHY with the lowest address, if there is one, and starts negotiation.
  static std::optional<Phy> find(std::uintptr_t controller);

  /// Returns the negotiated rate; no value without a link.
  [[nodiscard]] std::optional<PhyLink> link() const;

 private:
  Phy(std::uintptr_t controller, std::uint32_t address) : controller_(controller), address_(address) {}
  [[nodiscard]] std::uint16_t read(std::uint32_t number) const;
  void write(std::uint32_t number, std::uint16_t value) const;
  void transfer(std::uint32_t command) const;

  std::uintptr_t controller_;
  std::uint32_t address_;
};

}  // namespace vbar::boards::zynq7000
