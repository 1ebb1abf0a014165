/* test_tight.c - the tests of test_memory.c, in which each array that could grow asks whether there is memory, also if
   it has room. So memory runs out between any two items, not just where an array has become full. */
#include <stddef.h>
struct gx_allocator;
static int runs_out(const struct gx_allocator *a);
#define GXP_HAS_ROOM(allocator, need, capacity)  ((need) <= (capacity) && !runs_out(allocator))
#define GXBP_HAS_ROOM(allocator, need, capacity) ((need) <= (capacity) && !runs_out(allocator))
#define TIGHT
#include "test_memory.c"
