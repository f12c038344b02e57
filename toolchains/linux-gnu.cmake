# What the toolchains for Linux on ARM share: Debian's names, and an emulator to run tests with where there is one.
set(CMAKE_C_COMPILER ${planefold_triple}-gcc)
set(CMAKE_CXX_COMPILER ${planefold_triple}-g++)
set(CMAKE_LINKER ${planefold_triple}-ld)
set(CMAKE_OBJCOPY ${planefold_triple}-objcopy)

# Libraries come from the target; Eigen is headers only and comes from the host.
set(CMAKE_FIND_ROOT_PATH /usr/${planefold_triple})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)

find_program(planefold_emulator_path ${planefold_emulator})
if(planefold_emulator_path)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${planefold_emulator_path};-L;/usr/${planefold_triple}")
endif()
