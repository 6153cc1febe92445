#include "host_sim/report/text_file.h"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "host_sim/files/remove_link.h"
#include "host_sim/files/write_error.h"

namespace vbar::files {

std::string read_text_file(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) throw std::runtime_error(file.string() + ": cannot be read");
  return text;
}

std::filesystem::path neighbour_of(const std::filesystem::path& file) {
  return file.string() + ".new";
}

void replace_text_file(const std::filesystem::path& file, std::string_view text) {
  const std::filesystem::path neighbour = neighbour_of(file);
  remove_link(neighbour);
  errno = 0;
  std::ofstream stream(neighbour, std::ios::binary | std::ios::trunc);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(neighbour, file, error);
  if (!stream || error) {
    const std::runtime_error reason = write_error(file);
    std::error_code ignored;
    std::filesystem::remove(neighbour, ignored);
    throw reason;
  }
}

}  // namespace vbar::files
