#include "pil_bridge/arm_image.h"

#include <cstddef>
#include <cstring>
#include <fstream>

#include <elf.h>

namespace vbar::pil {

std::string fault_of_arm_image(const std::string& file, bool is_for_linux) {
  Elf32_Ehdr header{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  const std::string accepted = std::string("; accepted: an ELF executable for 32-bit ARM, little-endian") +
                               (is_for_linux ? ", of Linux" : ", bare metal");
  // The header of another class differs behind the type and the machine, which are read from it here.
  if (stream.gcount() < static_cast<std::streamsize>(offsetof(Elf32_Ehdr, e_version)) ||
      std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0)
    return "found a file that is not an ELF image" + accepted;
  if (header.e_ident[EI_DATA] != ELFDATA2LSB) return "found an ELF image that is big-endian" + accepted;
  if (header.e_ident[EI_CLASS] != ELFCLASS32 || header.e_machine != EM_ARM)
    return "found an ELF image of " + std::string(header.e_ident[EI_CLASS] == ELFCLASS64 ? "64" : "32") +
           " bits for the machine number " + std::to_string(header.e_machine) + accepted;
  if (header.e_type != ET_EXEC && !(is_for_linux && header.e_type == ET_DYN))
    return "found an ELF file of type " + std::to_string(header.e_type) + ", which is not an executable" + accepted;
  return {};
}

}  // namespace vbar::pil
