/* The version of the programs, as text for --version: "0.1.0". */
#ifndef PLANEFOLD_PLATFORM_VERSION_H
#define PLANEFOLD_PLATFORM_VERSION_H

#include <planefold/planefold.h>

#define PF_VERSION_TEXT_OF(major, minor, patch) #major "." #minor "." #patch
#define PF_VERSION_TEXT_FROM(major, minor, patch) PF_VERSION_TEXT_OF(major, minor, patch)
#define PF_VERSION_TEXT PF_VERSION_TEXT_FROM(PF_VERSION_MAJOR, PF_VERSION_MINOR, PF_VERSION_PATCH)

#endif
