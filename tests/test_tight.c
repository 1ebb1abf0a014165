/* test_tight.c - the tests of test_memory.c with arrays that have no room beyond what they need. Each item asks for
   memory, so that memory runs out between any two items, and what is written behind a block shows. */
#define GXP_SPARE(need)  ((need)*0)
#define GXBP_SPARE(need) ((need)*0)
#define GXBP_ARENA       ((size_t)64)
#define STRIDE           7
#include "test_memory.c"
