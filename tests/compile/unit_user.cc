#include "unit_user.c"
