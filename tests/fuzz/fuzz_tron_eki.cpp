// A stream of Ethernet KRL with arbitrary contents. Promise: the documents do not depend on how the stream is cut into
// pieces; each decodes to what is the same after encoding and decoding it again, or to one WireError.

#include <string>
#include <vector>

#include "hil_drivers/tron/protocols/eki.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::tron::eki;

/// Documents up to the first error, and whether there was one.
struct Cut {
  std::vector<std::string> documents;
  bool has_failed = false;
};

void take(DocumentBuffer& buffer, Cut& cut) {
  try {
    while (auto document = buffer.next()) cut.documents.push_back(*document);
  } catch (const WireError&) {
    cut.has_failed = true;
  }
}

Cut cut_in_pieces(std::string_view stream, std::size_t piece) {
  Cut cut;
  DocumentBuffer buffer;
  for (std::size_t at = 0; at < stream.size() && !cut.has_failed; at += piece) {
    buffer.append(stream.substr(at, piece));
    take(buffer, cut);
  }
  return cut;
}

void check_command(const std::string& document) {
  const Command command = decode_command(document);
  VBAR_FUZZ_EXPECT(decode_command(encode(command)) == command);
}

void check_reply(const std::string& document) {
  const Reply reply = decode_reply(document);
  if (const auto* state = std::get_if<State>(&reply)) {
    VBAR_FUZZ_EXPECT(decode_reply(encode(*state)) == reply);
    return;
  }
  // The values have four decimals after the first encoding.
  const std::string text = encode(std::get<RobotState>(reply));
  VBAR_FUZZ_EXPECT(encode(std::get<RobotState>(decode_reply(text))) == text);
}

void check_document(const std::string& document) {
  try {
    // The other decoder would refuse its root element.
    if (document.starts_with("<C"))
      check_command(document);
    else
      check_reply(document);
  } catch (const WireError&) {
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view stream(reinterpret_cast<const char*>(data), size);
  if (stream.empty()) return 0;
  const Cut whole = cut_in_pieces(stream, stream.size());
  const Cut pieces = cut_in_pieces(stream, 1 + stream.size() / (1 + stream.size() % 5));
  VBAR_FUZZ_EXPECT(whole.documents == pieces.documents && whole.has_failed == pieces.has_failed);
  for (const std::string& document : whole.documents) check_document(document);
  return 0;
}
