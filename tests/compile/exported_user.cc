#include "exported_user.c"
