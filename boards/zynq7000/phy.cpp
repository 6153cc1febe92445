#include "boards/zynq7000/phy.h"

#include "boards/zynq7000/memory_map.h"

namespace vbar::boards::zynq7000 {
namespace {

// Registers of the controller.
constexpr std::uintptr_t kNetworkStatus = 0x08;
constexpr std::uintptr_t kPhyMaintenance = 0x34;
constexpr std::uint32_t kManagementIdle = 1U << 2;
constexpr std::uint32_t kClause22 = (1U << 30) | (2U << 16);
constexpr std::uint32_t kRead = kClause22 | (2U << 28);
constexpr std::uint32_t kWrite = kClause22 | (1U << 28);

// Registers of the PHY (802.3 table 22-6).
constexpr std::uint32_t kControl = 0;
constexpr std::uint32_t kStatus = 1;
constexpr std::uint32_t kIdentifier = 2;
constexpr std::uint32_t kAdvertised = 4;
constexpr std::uint32_t kPartner = 5;
constexpr std::uint32_t kGigabitAdvertised = 9;
constexpr std::uint32_t kGigabitPartner = 10;

}  // namespace

std::optional<Phy> Phy::find(std::uintptr_t controller) {
  constexpr std::uint32_t kAddresses = 32;
  constexpr std::uint16_t kNobody = 0xFFFF;  // undriven bus: no PHY at this address
  constexpr std::uint16_t kNegotiate = (1U << 12) | (1U << 9);
  for (std::uint32_t address = 0; address < kAddresses; ++address) {
    const Phy phy(controller, address);
    const std::uint16_t identifier = phy.read(kIdentifier);
    if (identifier != kNobody && identifier != 0) {
      if (!phy.link()) {
        phy.write(kControl, kNegotiate);
      }
      return phy;
    }
  }
  return std::nullopt;
}

std::optional<PhyLink> Phy::link() const {
  constexpr unsigned kLinkUp = 1U << 2;
  constexpr unsigned kNegotiated = 1U << 5;
  static_cast<void>(read(kStatus));  // the first reading is latched after a loss of link
  const unsigned status = read(kStatus);
  if ((status & kLinkUp) == 0U || (status & kNegotiated) == 0U) {
    return std::nullopt;
  }
  // Abilities common to both ends, best first; the partner's gigabit abilities are two bits higher than our own.
  const unsigned gigabit = read(kGigabitAdvertised) & (static_cast<unsigned>(read(kGigabitPartner)) >> 2U);
  if ((gigabit & (1U << 9)) != 0U) return PhyLink{LineRate::k1000Mbps, true};
  if ((gigabit & (1U << 8)) != 0U) return PhyLink{LineRate::k1000Mbps, false};
  const unsigned common = static_cast<unsigned>(read(kAdvertised)) & static_cast<unsigned>(read(kPartner));
  if ((common & (1U << 8)) != 0U) return PhyLink{LineRate::k100Mbps, true};
  if ((common & (1U << 7)) != 0U) return PhyLink{LineRate::k100Mbps, false};
  return PhyLink{LineRate::k10Mbps, (common & (1U << 6)) != 0U};
}

std::uint16_t Phy::read(std::uint32_t number) const {
  transfer(kRead | (address_ << 23) | (number << 18));
  return static_cast<std::uint16_t>(reg(controller_ + kPhyMaintenance) & 0xFFFFU);
}

void Phy::write(std::uint32_t number, std::uint16_t value) const {
  transfer(kWrite | (address_ << 23) | (number << 18) | value);
}

void Phy::transfer(std::uint32_t command) const {
  reg(controller_ + kPhyMaintenance) = command;
  for (int i = 0; i < 1'000'000 && (reg(controller_ + kNetworkStatus) & kManagementIdle) == 0U; ++i) {
  }
}

}  // namespace vbar::boards::zynq7000
