/* The header alone, with its own switch. */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "gxfem_boolean.h"

int main(void) {
    const double a[2] = {0, 0}, b[2] = {1, 0}, c[2] = {0, 1};
    return gxb_orient2d(a, b, c) == 1 ? 0 : 1;
}
