/* The other: includes plainly, calls across. */
#include "gxfem.h"
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h"
#include "use.h"

#ifdef __cplusplus
extern "C"
#endif
    int
    unit_implements(void);

int main(void) { return use_all() + unit_implements(); }
