/* test_tight_boolean.c - the tests of test_surface_boolean.c in which memory runs out, with arrays that have no room
   beyond what they need: memory runs out between any two items. */
#define _POSIX_C_SOURCE  200112L /* setenv */
#define GXBP_SPARE(need) ((need)*0)
#define STRIDE           7
#define main             all_tests
#include "test_surface_boolean.c"
#undef main

int main(void) {
    if (setenv("CK_RUN_CASE", "memory", 1) != 0) return EXIT_FAILURE;
    return all_tests();
}
