#pragma once
// An XML file of a controller's configuration. Errors are mission::MissionError with file and line.

#include <filesystem>
#include <string>
#include <string_view>

#include <pugixml.hpp>

namespace vbar::tron::xml {

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
