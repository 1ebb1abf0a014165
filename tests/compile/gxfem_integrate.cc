#include "gxfem_integrate.c"
