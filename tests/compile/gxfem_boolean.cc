#include "gxfem_boolean.c"
