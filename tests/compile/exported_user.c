/* A program that calls the shared library. */
#define GXFEM_API extern
#include "gxfem.h"
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h"
#include "use.h"

int main(void) { return use_all(); }
