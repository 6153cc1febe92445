#include "hil_drivers/tron/xml/file.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "hil_drivers/tron/xml/document.h"
#include "hil_drivers/wire/bytes.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::xml {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;

}  // namespace

File::File(const std::filesystem::path& file, std::string_view root_name) : file_(file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw mission::MissionError(file.string(), "", "a file that cannot be read", "a readable file");
  text_.assign(std::istreambuf_iterator<char>(stream), {});
  if (text_.size() > kMaxFileBytes)
    throw mission::MissionError(file.string(), "", fmt::format("{} bytes", text_.size()), "up to 1 MiB");
  const pugi::xml_parse_result result =
      document_.load_buffer(text_.data(), text_.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    const auto end = text_.begin() + std::min(result.offset, static_cast<std::ptrdiff_t>(text_.size()));
    throw mission::MissionError(fmt::format("{}:{}", file.string(), 1 + std::count(text_.begin(), end, '\n')), "",
                                result.description(), "a well-formed XML document");
  }
  for (const pugi::xml_node node : document_.children())
    if (node.type() == pugi::node_doctype) refuse(node, "a document type", "none");
  if (root_name != root().name())
    refuse(root(), fmt::format("root element <{}>", wire::printable(root().name())), fmt::format("<{}>", root_name));
}

void File::refuse(const pugi::xml_node& at, const std::string& found, const std::string& accepted) const {
  const std::ptrdiff_t offset =
      std::clamp<std::ptrdiff_t>(at.offset_debug(), 0, static_cast<std::ptrdiff_t>(text_.size()));
  const auto line = 1 + std::count(text_.begin(), text_.begin() + offset, '\n');
  throw mission::MissionError(fmt::format("{}:{}", file_.string(), line), wire::printable(at.name()), found, accepted);
}

pugi::xml_node File::child(const pugi::xml_node& parent, const char* name) const {
  const pugi::xml_node found = parent.child(name);
  if (!found) refuse(parent, fmt::format("no element <{}>", name), "one");
  if (found.next_sibling(name)) refuse(found.next_sibling(name), fmt::format("a second <{}>", name), "one");
  return found;
}

std::string File::attribute(const pugi::xml_node& element, const char* name) const {
  const pugi::xml_attribute found = element.attribute(name);
  if (!found) refuse(element, fmt::format("no attribute {}", name), "one");
  return found.value();
}

double File::number(const pugi::xml_node& element, const char* name, double lower, double upper) const {
  const std::string text = attribute(element, name);
  const auto value = finite_number(text);
  if (!value || *value < lower || *value > upper)
    refuse(element, fmt::format("{} \"{}\"", name, wire::printable(text)), fmt::format("{} to {}", lower, upper));
  return *value;
}

int File::integer(const pugi::xml_node& element, const char* name, int lower, int upper) const {
  const double value = number(element, name, lower, upper);
  if (value != static_cast<int>(value))
    refuse(element, fmt::format("{} {}", name, value), fmt::format("an integer from {} to {}", lower, upper));
  return static_cast<int>(value);
}

}  // namespace vbar::tron::xml
