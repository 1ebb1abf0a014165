/* The header alone, with its own switch. */
#define GXFEM_SOLVE_IMPLEMENTATION
#include "gxfem_solve.h"

int main(void) {
    gxs_solver_destroy(NULL);
    return gxs_solver_create(NULL, NULL, NULL) == GX_ERROR_ARGUMENT ? 0 : 1;
}
