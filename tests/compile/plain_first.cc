#include "plain_first.c"
