/* A file that has included the headers plainly (through others, say) and then asks for the implementation. */
#include "gxfem.h"
#include "gxfem_boolean.h"
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h"
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"
#include "use.h"

int main(void) { return use_all(); }
