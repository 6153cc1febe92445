#include "hil_drivers/tron/protocols/kuka_xml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/wire/bytes.h"
#include "host_sim/files/output_file.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::tron::xml {

namespace {

constexpr std::array<std::string_view, 5> kEntities{"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
constexpr std::string_view kBlanks = " \t\r\n";

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

bool begins_with_entity(std::string_view text) {
  for (const std::string_view entity : kEntities)
    if (text.starts_with(entity)) return true;
  return false;
}

/// The first attribute of the element that occurs twice, or nullptr.
const char* repeated_attribute(const pugi::xml_node& element) {
  for (pugi::xml_attribute attribute : element.attributes())
    for (pugi::xml_attribute other = attribute.next_attribute(); other; other = other.next_attribute())
      if (std::string_view(attribute.name()) == other.name()) return attribute.name();
  return nullptr;
}

}  // namespace

bool Document::refuse(std::string problem) {
  problem_ = std::move(problem);
  return false;
}

bool Document::check_characters(std::string_view text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if ((c < 0x20 && c != '\t' && c != '\r' && c != '\n') || c == 0x7f)
      return refuse(fmt::format("byte {} is not printable ASCII", k));
    if (c == '<' && k + 1 < text.size() && (text[k + 1] == '!' || text[k + 1] == '?'))
      return refuse(fmt::format("byte {} begins a declaration or comment, which are not accepted", k));
    if (c == '&' && !begins_with_entity(text.substr(k)))
      return refuse(fmt::format("byte {} begins an entity, which is not accepted", k));
  }
  return true;
}

bool Document::check_elements(int max_depth) {
  // The tree is walked without recursion: its depth is the sender's choice.
  pugi::xml_node node = root();
  for (int depth = 0; node;) {
    if (node.type() == pugi::node_element) {
      if (depth > max_depth)
        return refuse(fmt::format("element <{}> is nested too deeply", wire::printable(node.name())));
      if (const char* name = repeated_attribute(node))
        return refuse(fmt::format("<{}> has attribute {} twice", wire::printable(node.name()), wire::printable(name)));
    }
    if (node.first_child()) {
      node = node.first_child();
      ++depth;
      continue;
    }
    while (depth > 0 && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    if (depth == 0) return true;
    node = node.next_sibling();
  }
  return true;
}

bool Document::parse(std::string_view text, std::size_t max_bytes, int max_depth) {
  if (text.size() > max_bytes) return refuse(fmt::format("{} bytes; accepted: up to {}", text.size(), max_bytes));
  text = without_blanks(text);
  if (text.empty()) return refuse("the document is empty");
  if (!check_characters(text)) return false;
  if (text.front() != '<' || text.back() != '>') return refuse("characters around the root element");
  buffer_.assign(text.begin(), text.end());
  const pugi::xml_parse_result result = document_.load_buffer_inplace(
      buffer_.data(), buffer_.size(), pugi::parse_minimal | pugi::parse_escapes, pugi::encoding_utf8);
  if (!result) return refuse(fmt::format("byte {}: {}", result.offset, result.description()));
  if (document_.first_child() != document_.last_child()) return refuse("more than one root element");
  return check_elements(max_depth);
}

std::optional<double> finite_number(std::string_view text) {
  text = without_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> unsigned_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool append_decimal(std::string& text, double value, int decimals) {
  constexpr std::array<std::uint64_t, 10> kPowers{1,       10,        100,        1000,        10000,
                                                  100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};
  if (!(std::abs(value) <= 1e9) || decimals < 0 || decimals > 9) return false;
  const std::uint64_t power = kPowers[static_cast<std::size_t>(decimals)];
  const auto scaled = static_cast<std::uint64_t>(std::llround(std::abs(value) * static_cast<double>(power)));
  if (value < 0.0 && scaled > 0) text += '-';
  std::array<char, 24> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), scaled / power).ptr);
  if (decimals == 0) return true;
  text += '.';
  const auto fraction = std::to_chars(digits.data(), digits.data() + digits.size(), scaled % power);
  text.append(static_cast<std::size_t>(decimals) - static_cast<std::size_t>(fraction.ptr - digits.data()), '0');
  text.append(digits.data(), fraction.ptr);
  return true;
}

void append_escaped(std::string& document, std::string_view text) {
  for (const char c : text) {
    switch (c) {
      case '&':
        document += "&amp;";
        break;
      case '<':
        document += "&lt;";
        break;
      case '>':
        document += "&gt;";
        break;
      case '"':
        document += "&quot;";
        break;
      case '\'':
        document += "&apos;";
        break;
      default:
        document += (c >= 0x20 && c < 0x7f) ? c : '?';
    }
  }
}

namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;

}  // namespace

File::File(const std::filesystem::path& file, std::string_view root_name) : file_(file) {
  std::optional<std::string> text = files::contents_of(file);
  if (!text) throw mission::MissionError(file.string(), "", "a file that cannot be read", "a readable file");
  text_ = *std::move(text);
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
