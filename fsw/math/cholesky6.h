#pragma once

#include "fsw/core/types.h"
#include "fsw/math/cholesky.h"

namespace vbar::fsw::math {

using Cholesky6 = Cholesky<6>;

}  // namespace vbar::fsw::math
