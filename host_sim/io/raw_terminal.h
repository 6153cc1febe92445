#pragma once
// Settings that all serial lines of this library share. For its own files.

#include <string>

namespace vbar::io {

/// 8N1, no echo, no translation, no flow control, modem lines ignored. Throws ChannelError that begins with
/// `description`.
void set_raw(int terminal, const std::string& description);

}  // namespace vbar::io
