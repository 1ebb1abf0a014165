/* expect.h - ends a bench whose rows would be wrong. Include it after `#define BENCH "name"`; without one it says
 * bench. */
#ifndef BENCH_EXPECT_H
#define BENCH_EXPECT_H

#include <stdio.h>
#include <stdlib.h>

#ifndef BENCH
#define BENCH "bench"
#endif

static inline void expect(int holds, const char *what) {
    if (holds) return;
    fprintf(stderr, BENCH ": %s\n", what);
    exit(1);
}

/* count x size bytes, zeroed; the caller's to free */
static inline void *memory(size_t count, size_t size) {
    void *room = calloc(count + 1, size);
    expect(room != NULL, "no memory");
    return room;
}

#endif
