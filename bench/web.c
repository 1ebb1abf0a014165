/* web.c - the page's jelly (examples/web/jelly.c) as a native program: the other side of what web.mjs measures.

   make bench-web builds and runs it. It reads calls from stdin, one on a line: the name of a function without "jelly_",
   its integer, and what goes into jelly_numbers before. `step 1` is a step that is measured. Prints two lines: the
   milliseconds of the steps that were measured, each with the skin after it; then fragments, vertices and two sums, of
   the topology and of the bits of all positions. */
#define _POSIX_C_SOURCE 200112L
#define BENCH           "web"
#include "../examples/web/jelly.c"
#include "clock.h"
#include "expect.h"
#include <stdio.h>

/* FNV-1a by words of 32 bits */
static uint32_t add_words(uint32_t sum, const void *words, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        uint32_t word;
        memcpy(&word, (const char *)words + i * sizeof word, sizeof word);
        sum = (sum ^ word) * 16777619u;
    }
    return sum;
}

static int call(const char *name, int integer) {
    if (strcmp(name, "new") == 0) return jelly_new(integer, numbers[0]);
    if (strcmp(name, "stroke") == 0) return jelly_stroke(integer);
    expect(strcmp(name, "step") == 0, "stdin has a call that there is not");
    return jelly_step();
}

int main(void) {
    char line[512], name[16];
    const uint32_t *triangles;
    uint32_t topology = 2166136261u;
    while (fgets(line, sizeof line, stdin)) {
        int integer = 0, at = 0, n;
        double start;
        char *rest, *end;
        expect(sscanf(line, "%15s %d%n", name, &integer, &at) == 2, "stdin has a line that is no call");
        for (n = 0, rest = line + at; n < NUMBERS; n++, rest = end) {
            const double number = strtod(rest, &end);
            if (end == rest) break;
            numbers[n] = number;
        }
        start = seconds(NULL);
        expect(call(name, integer) == GX_OK, "a call failed");
        if (strcmp(name, "step") != 0 || !integer) continue;
        printf("%.4f ", 1e3 * (seconds(NULL) - start));
        expect(jelly_draw() == GX_OK, "no skin");
        printf("%.4f ", 1e3 * (seconds(NULL) - start));
    }
    triangles = jelly_triangles();
    expect(triangles != NULL && jelly_draw() == GX_OK, "no skin");
    topology = add_words(topology, triangles, 3 * jelly_triangle_count());
    topology = add_words(topology, jelly_fragments(), jelly_triangle_count());
    jelly_ids();
    printf("\n%.0f %u %u %u\n", numbers[0], (unsigned)jelly_vertex_count(), (unsigned)topology,
           (unsigned)add_words(2166136261u, positions, 3 * jelly_vertex_count()));
    drop();
    return 0;
}
