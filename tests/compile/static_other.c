/* The second file: its own copy of everything. */
#define GXFEM_STATIC
#define GXFEM_IMPLEMENTATION
#include "gxfem.h"
#include "use.h"

#ifdef __cplusplus
extern "C"
#endif
    int
    use_elsewhere(void);
int use_elsewhere(void) { return use_all(); }
