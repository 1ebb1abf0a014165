/* The header alone, with its own switch. */
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"

int main(void) {
    gx_body_destroy(NULL);
    return gx_body_create(NULL, NULL, NULL) == GX_ERROR_ARGUMENT ? 0 : 1;
}
