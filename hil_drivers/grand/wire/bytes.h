#pragma once
// Names of the common byte formats, for the formats of this testbed.

#include "hil_drivers/wire/bytes.h"

namespace vbar::grand::wire {

using vbar::wire::ByteOrder;
using vbar::wire::ByteReader;
using vbar::wire::Bytes;
using vbar::wire::bytes_of;
using vbar::wire::ByteWriter;
using vbar::wire::LineBuffer;
using vbar::wire::printable;
using vbar::wire::WireError;
using vbar::wire::WireNumber;

}  // namespace vbar::grand::wire
