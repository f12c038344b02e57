# Man pages of the programs of this build, made from their --help by help2man and installed with them. Left out where there is no help2man
# (Debian: help2man), and where the programs cannot run.
find_program(PLANEFOLD_HELP2MAN help2man)
if(NOT PLANEFOLD_HELP2MAN OR CMAKE_CROSSCOMPILING OR PLANEFOLD_SANITIZE)
  return()
endif()

set(planefold_about_pf-capture "track a camera and map points and planes from images or a camera")
set(planefold_about_pf-calibrate "calibrate a camera from views of a printed board")
set(planefold_about_pf-sim "simulations and Monte Carlo runs of planefold, rendered sequences")
set(planefold_about_pf-eval "compare a run of pf-capture with ground truth")
set(planefold_about_pf-bench "time kernels and whole frames of planefold")

set(planefold_help_pf-eval ${PROJECT_SOURCE_DIR}/tools/pf-eval/pf_eval/options.py)

set(pages "")
foreach(program IN ITEMS pf-capture pf-calibrate pf-sim pf-eval pf-bench)
  if(NOT TARGET ${program})
    continue()
  endif()
  set(page ${CMAKE_BINARY_DIR}/man/${program}.1)
  add_custom_command(
    OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/man
    COMMAND ${PLANEFOLD_HELP2MAN} --no-info --section=1 --manual=planefold --name=${planefold_about_${program}}
            --version-string=${PROJECT_VERSION} --output=${page} ${CMAKE_BINARY_DIR}/bin/${program}
    DEPENDS ${program} ${planefold_help_${program}} VERBATIM)
  list(APPEND pages ${page})
endforeach()
add_custom_target(man ALL DEPENDS ${pages})
install(FILES ${pages} DESTINATION share/man/man1 COMPONENT programs OPTIONAL)
