# ARMv7 Linux with NEON, with Debian's cross compiler (package g++-arm-linux-gnueabihf).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR armv7-a)
set(planefold_triple arm-linux-gnueabihf)
set(planefold_name armhf)
set(planefold_emulator qemu-arm)
set(CMAKE_C_FLAGS_INIT "-march=armv7-a+fp -mfloat-abi=hard")
set(CMAKE_CXX_FLAGS_INIT "-march=armv7-a+fp -mfloat-abi=hard -Wno-psabi") # notes on what changed in GCC 7
include(${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake)
