/* One of two translation units: the one that has the implementation. */
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"

#ifdef __cplusplus
extern "C"
#endif
    int
    unit_implements(void);
int unit_implements(void) { return gx_body_create(NULL, NULL, NULL) == GX_ERROR_ARGUMENT ? 0 : 1; }
