#include "gxfem.c"
