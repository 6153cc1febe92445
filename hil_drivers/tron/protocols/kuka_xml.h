#pragma once
// XML documents on a line to a robot: they are flat, ASCII and small, and have no declarations,
// comments, entities of their own or document types. Parsed by pugixml; nothing here throws.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

namespace vbar::tron::xml {

/// Parses one document after the other in the same memory.
class Document {
 public:
  /// Returns false if the text is rejected: problem() is one sentence. Rejected are more than `max_bytes`, characters
  /// other than printable ASCII and blanks, "<!", "<?", entities other than the five of XML, a second root, text around
  /// the root, an attribute that occurs twice, elements nested more than `max_depth` below the root, and what pugixml
  /// rejects.
  [[nodiscard]] bool parse(std::string_view text, std::size_t max_bytes, int max_depth = 1);
  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Returns false, with a problem of the caller.
  bool refuse(std::string problem);

 private:
  bool check_characters(std::string_view text);
  bool check_elements(int max_depth);

  pugi::xml_document document_;
  std::vector<char> buffer_;
  std::string problem_;
};

/// Reads a finite decimal number, blanks around it ignored.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);
/// Reads decimal digits only.
[[nodiscard]] std::optional<std::uint64_t> unsigned_number(std::string_view text);

/// Reads attributes `names` of `element` into `values`. The name of the first one that is missing or not finite, or
/// empty.
template <std::size_t kCount>
[[nodiscard]] std::string_view read_attributes(const pugi::xml_node& element,
                                               const std::array<std::string_view, kCount>& names,
                                               std::array<double, kCount>& values) {
  std::array<bool, kCount> found{};
  for (const pugi::xml_attribute attribute : element.attributes())
    for (std::size_t k = 0; k < kCount; ++k) {
      if (names[k] != attribute.name()) continue;
      const auto number = finite_number(attribute.value());
      if (!number) return names[k];
      values[k] = *number;
      found[k] = true;
    }
  for (std::size_t k = 0; k < kCount; ++k)
    if (!found[k]) return names[k];
  return {};
}

/// Appends `value` with `decimals` (0 to 9) as KUKA writes it: no exponent, no negative zero. Returns false if it is
/// not finite, or beyond 1e9.
[[nodiscard]] bool append_decimal(std::string& text, double value, int decimals);
/// Appends `text` with the characters that XML reserves replaced by entities.
void append_escaped(std::string& document, std::string_view text);

inline constexpr std::array<std::string_view, 6> kCartesianNames{"X", "Y", "Z", "A", "B", "C"};
inline constexpr std::array<std::string_view, 6> kAxisNames{"A1", "A2", "A3", "A4", "A5", "A6"};
inline constexpr std::array<std::string_view, 6> kExternalNames{"E1", "E2", "E3", "E4", "E5", "E6"};

// An XML file of a controller's configuration. Errors are mission::MissionError with file and line.

class File {
 public:
  /// Throws mission::MissionError; `root` is the name that its root element must have.
  File(const std::filesystem::path& file, std::string_view root);
  ~File() = default;
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }
  /// Returns the only element `name` in `parent`.
  [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const;
  [[nodiscard]] std::string attribute(const pugi::xml_node& element, const char* name) const;
  [[nodiscard]] double number(const pugi::xml_node& element, const char* attribute, double lower, double upper) const;
  [[nodiscard]] int integer(const pugi::xml_node& element, const char* attribute, int lower, int upper) const;
  [[noreturn]] void refuse(const pugi::xml_node& at, const std::string& found, const std::string& accepted) const;

 private:
  std::filesystem::path file_;
  std::string text_;
  pugi::xml_document document_;
};

}  // namespace vbar::tron::xml
