#include "implementation_first.c"
