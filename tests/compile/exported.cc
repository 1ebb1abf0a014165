#include "exported.c"
