# 64-bit ARM Linux, with Debian's cross compiler (package g++-aarch64-linux-gnu).
#
# PLANEFOLD_TUNE names the core to schedule for, such as cortex-a53 or cortex-a72; the code runs on all of them all
# the same.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(planefold_triple aarch64-linux-gnu)
set(planefold_name aarch64)
set(planefold_emulator qemu-aarch64)
if(PLANEFOLD_TUNE)
  set(CMAKE_C_FLAGS_INIT "-mtune=${PLANEFOLD_TUNE}")
  set(CMAKE_CXX_FLAGS_INIT "-mtune=${PLANEFOLD_TUNE}")
endif()
include(${CMAKE_CURRENT_LIST_DIR}/linux-gnu.cmake)
