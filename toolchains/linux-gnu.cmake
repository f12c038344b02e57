# What the toolchains for Linux on ARM share: Debian's names, libraries of the target, and an emulator to run tests
# with.
#
# The library and its tests need the cross compiler alone. Programs need libraries for the target:
# toolchains/make_sysroot.sh unpacks them into build/sysroot/NAME, which is used where it exists; PLANEFOLD_SYSROOT
# names another place, such as the root of your device's image.
set(CMAKE_C_COMPILER ${planefold_triple}-gcc)
set(CMAKE_CXX_COMPILER ${planefold_triple}-g++)
set(CMAKE_LINKER ${planefold_triple}-ld)
set(CMAKE_OBJCOPY ${planefold_triple}-objcopy)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)

list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PLANEFOLD_SYSROOT)
set(PLANEFOLD_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/sysroot/${planefold_name} CACHE PATH
    "Libraries of the target for the programs; toolchains/make_sysroot.sh makes it")
get_filename_component(planefold_sysroot ${PLANEFOLD_SYSROOT} REALPATH)
if(EXISTS ${planefold_sysroot}/usr/include)
  set(CMAKE_SYSROOT ${planefold_sysroot})
  set(CMAKE_LIBRARY_ARCHITECTURE ${planefold_triple})
  set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
  set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
  set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
  set(ENV{PKG_CONFIG_SYSROOT_DIR} ${planefold_sysroot})
  set(ENV{PKG_CONFIG_LIBDIR}
      ${planefold_sysroot}/usr/lib/${planefold_triple}/pkgconfig:${planefold_sysroot}/usr/share/pkgconfig)
  set(planefold_target_root ${planefold_sysroot})
else()
  # Eigen is headers only and comes from the host; nothing else may.
  set(CMAKE_FIND_ROOT_PATH /usr/${planefold_triple})
  set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
  set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)
  set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
  set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/${planefold_triple}/pkgconfig)
  set(planefold_target_root /usr/${planefold_triple})
endif()

find_program(planefold_emulator_path NAMES ${planefold_emulator} ${planefold_emulator}-static)
if(planefold_emulator_path)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${planefold_emulator_path};-L;${planefold_target_root}")
endif()
