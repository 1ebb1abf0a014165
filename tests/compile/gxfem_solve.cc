#include "gxfem_solve.c"
