/* The implementation, then plain inclusion again. */
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"
#undef GXFEM_IMPLEMENTATION
#include "gxfem.h"
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h"
#include "use.h"

int main(void) { return use_all(); }
