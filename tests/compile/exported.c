/* A shared library: the functions carry what the user's GXFEM_API says, whatever GXFEM_STATIC says. */
#if defined(__GNUC__) && !defined(_WIN32)
#define GXFEM_API __attribute__((visibility("default")))
#else
#define GXFEM_API extern
#endif
#define GXFEM_STATIC
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"

#if GXFEM_VERSION < 200 || GXFEM_VERSION / 10000 != GXFEM_VERSION_MAJOR
#error "the version's number does not follow from its parts"
#endif
