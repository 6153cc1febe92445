# Libraries that every build for this computer has (ci/install.sh fly). Those that it can be without:
# vbar_optional_libraries.cmake. Header-only and without a package of CMake: Random123, LCM's core types, timepps.
find_package(Boost REQUIRED)  # Asio, Endian, odeint, property tree: headers only
find_package(CLI11 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(PNG REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
find_package(charls REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(tomlplusplus REQUIRED)
find_library(VBAR_ASSIMP_LIBRARY assimp REQUIRED)  # its CMake package asks for libraries that only it needs
find_library(VBAR_GEOGRAPHICLIB GeographicLib REQUIRED)
find_path(VBAR_LCM_INCLUDE lcm/lcm.h REQUIRED)
find_path(VBAR_RANDOM123_INCLUDE Random123/philox.h REQUIRED)
find_path(VBAR_TIMEPPS_INCLUDE sys/timepps.h REQUIRED)
find_program(VBAR_LCM_GEN lcm-gen REQUIRED)
