/* Everything private to this file, most of it unused; linked with a second such file. */
#define GXFEM_STATIC
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"
#include "use.h"

#ifdef __cplusplus
extern "C"
#endif
    int
    use_elsewhere(void);

int main(void) { return use_all() + use_elsewhere(); }
