# Flags that every target of a build shares: language levels, build type, output folders, special modes.

set(CMAKE_C_STANDARD 99)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_SYSTEM_NAME STREQUAL Generic)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
set(CMAKE_INTERPROCEDURAL_OPTIMIZATION OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

get_property(planefold_multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT CMAKE_BUILD_TYPE AND NOT planefold_multi_config)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endif()

if(PLANEFOLD_SANITIZE)
  add_compile_options(-fsanitize=${PLANEFOLD_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  if(PLANEFOLD_SANITIZE MATCHES "address")
    # A null pointer that is followed ends in the address sanitizer's report as well; the check costs a fifth of the build.
    add_compile_options(-fno-sanitize=null)
  endif()
  add_link_options(-fsanitize=${PLANEFOLD_SANITIZE})
endif()
if(PLANEFOLD_COVERAGE)
  add_compile_options(--coverage -fprofile-update=atomic)
  add_link_options(--coverage)
endif()

if(PLANEFOLD_UNITY)
  # The compiler otherwise spends a tenth of its time collecting garbage, in memory that it gives back at once.
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1048576>)
endif()

# For programs, platform and tests, which may use the C++ runtime.
add_library(planefold_warnings INTERFACE)
target_compile_options(planefold_warnings INTERFACE -Wall -Wextra -Wshadow
                       $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-array-bounds>
                       $<$<BOOL:${PLANEFOLD_WERROR}>:-Werror>)

# Rooms of platform/ that a program uses where they are part of the build; PLANEFOLD_HAVE_V4L2 and so on tell it which are.
function(planefold_link_rooms program)
  foreach(room IN LISTS ARGN)
    if(TARGET planefold::platform_${room})
      string(TOUPPER ${room} name)
      target_link_libraries(${program} PRIVATE planefold::platform_${room})
      target_compile_definitions(${program} PRIVATE PLANEFOLD_HAVE_${name})
    endif()
  endforeach()
endfunction()
