/* smallest.c - the smallest program with the kernel: one Boolean, a tetrahedron less the half-space above a plane.
   make bench-smallest prints its compile time and its size. */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include <stdio.h>

int main(void) {
    const double a[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1},
                 b[12] = {-1, -1, 0.25, 9, -1, 0.25, -1, 9, 0.25, -1, -1, 9};
    const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const gxb_operand operands[2] = {{a, 4, triangles, 4, GXB_UNION, GXB_NONZERO, 0},
                                     {b, 4, triangles, 4, GXB_DIFFERENCE, GXB_NONZERO, 0}};
    gxb_boolean *boolean = NULL;
    gxb_boolean_result r = {0};
    gx_result result = gxb_boolean_create(NULL, &boolean, NULL);
    for (int i = 0; i < 2 && result == GX_OK; i++) result = gxb_boolean_add(boolean, &operands[i], NULL);
    if (result == GX_OK) result = gxb_boolean_evaluate(boolean, &r, NULL);
    printf("%lu triangles\n", (unsigned long)r.triangle_count);
    gxb_boolean_destroy(boolean);
    return result != GX_OK;
}
