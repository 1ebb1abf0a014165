/* All headers, each twice, the lower ones first; implementation of all. */
#define GXFEM_IMPLEMENTATION
#include "gxfem_solve.h"
#include "gxfem_integrate.h"
#include "gxfem_boolean.h"
#include "gxfem.h"
#include "gxfem.h"
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h"
#include "use.h"

int main(void) { return use_all(); }
