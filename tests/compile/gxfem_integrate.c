/* The header alone, with its own switch. */
#define GXFEM_INTEGRATE_IMPLEMENTATION
#include "gxfem_integrate.h"

int main(void) { return gxi_monomial_count(3) == 20 ? 0 : 1; }
