#pragma once
// Features of a GenICam device by name, set and read back; the errors of Aravis as exceptions.

#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <arv.h>

namespace vbar::gige {

struct ObjectDeleter {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using ObjectPtr = std::unique_ptr<T, ObjectDeleter>;

/// Receives the GError of one call.
class GlibError {
 public:
  GlibError() = default;
  ~GlibError() { g_clear_error(&error_); }
  GlibError(const GlibError&) = delete;
  GlibError& operator=(const GlibError&) = delete;

  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  [[nodiscard]] std::string text() const { return error_ != nullptr ? error_->message : "no reason given"; }

 private:
  GError* error_ = nullptr;
};

/// Reports a feature that a camera rejects, or that reads back other than it was set: one sentence without the address.
class FeatureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Lists the alternatives of a name, the standard's and vendors'.
using Names = std::initializer_list<const char*>;

/// States what a setting means for a camera that does not have it.
enum class Need { kRequired, kIfAvailable };

class Features {
 public:
  explicit Features(ArvDevice* device) : device_(device) {}

  // Set a feature; each throws FeatureError.
  void set_text(Names names, const char* value, Need need) const;
  void set_flag(Names names, bool value, Need need) const;
  void set_integer(Names names, gint64 value, Need need) const;
  /// Reads back within `tolerance`, absolute.
  void set_number(Names names, double value, double tolerance, Need need) const;
  void execute(const char* name) const;
  [[nodiscard]] gint64 integer(const char* name) const;
  [[nodiscard]] std::string text(const char* name) const;
  /// Returns nothing if the camera lacks the feature.
  [[nodiscard]] std::optional<gint64> integer_if_available(const char* name) const;

 private:
  /// Returns the first name that is available; null if none is and none is needed.
  [[nodiscard]] const char* find(Names names, Need need) const;

  ArvDevice* device_;
};

}  // namespace vbar::gige
