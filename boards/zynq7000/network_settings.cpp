#include "boards/zynq7000/network_settings.h"

namespace vbar::boards::zynq7000 {

const NetworkSettings kNetworkSettings{.label = {'v', 'b', 'a', 'r', 'n', 'e', 't', '1'},
                                       .mac = {0x02, 0x76, 0x62, 0x61, 0x72, 0x15},  // locally administered
                                       .address = {10, 0, 2, 15},
                                       .port = {5000U >> 8U, 5000U & 0xFFU}};

}  // namespace vbar::boards::zynq7000
