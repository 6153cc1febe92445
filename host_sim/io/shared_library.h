#pragma once
// A shared library that is loaded when it is first needed, rather than when the program starts: it may bring many
// others with it, or be absent.

#include <string>

namespace vbar::io {

/// Stays loaded: what such a library leaves at its end (threads, thread-local data) is not to outlive its code.
class SharedLibrary {
 public:
  /// `file` as the system's loader searches it, "liblcm.so.1". Throws std::runtime_error: "liblcm.so.1: ...; PURPOSE
  /// (Debian package PACKAGE)".
  SharedLibrary(const std::string& file, const std::string& purpose, const std::string& package);

  /// Sets `function` to the function `name` of the library's C interface. Throws as the constructor does.
  template <class Function>
  void find(const char* name, Function*& function) const {
    function = reinterpret_cast<Function*>(address_of(name));
  }

 private:
  [[nodiscard]] void* address_of(const char* name) const;
  [[noreturn]] void fail(const std::string& reason) const;

  std::string file_, needed_;
  void* handle_ = nullptr;
};

}  // namespace vbar::io
