#include "boards/zynq7000/telecommand_key.h"

namespace vbar::boards::zynq7000 {

const TelecommandKeySettings kTelecommandKeySettings{
    .label = {'v', 'b', 'a', 'r', 'k', 'e', 'y', '1'}, .index = {}, .sequence = {}, .key = {}};

}  // namespace vbar::boards::zynq7000
