#include "static_other.c"
