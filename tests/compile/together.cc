#include "together.c"
