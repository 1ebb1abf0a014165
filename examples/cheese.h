/* cheese.h: the surfaces of the scene swiss_cheese, for it and for the test that holds the scene's counts against the
   exact oracle. Plain arrays; knows nothing of gxfem.h.

   One tetrahedron, corners at the origin and at CHEESE_EDGE on each axis. Three sheets that wave across it in different
   directions and two flat ones, of which one is oblique. Waves run along an axis and are straight along another. */
#ifndef CHEESE_H
#define CHEESE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define CHEESE_EDGE 1.466 /* m: 1.77 m on average over the six edges (GXFEM, Table 1) */

/* Strips across a wave. At the first the oracle is through in seconds: these are the counts that it finds. */
enum { CHEESE_SURFACES = 5, CHEESE_COARSE = 16, CHEESE_FINE = 64, CHEESE_CELLS = 38, CHEESE_COPIES = 152 };

typedef struct cheese_surface {
    double vertices[6 * (CHEESE_FINE + 1)]; /* vertex_count x 3 */
    uint32_t triangles[6 * CHEESE_FINE];    /* triangle_count x 3 */
    size_t vertex_count, triangle_count;
} cheese_surface;

/* A wave about `level` of one axis, which runs along a second and is straight along the third: all in edges */
typedef struct cheese_wave {
    int across, along, straight;
    double level, height, length;
} cheese_wave;

static inline void cheese_fill_wave(cheese_surface *s, const cheese_wave *wave, uint32_t strips) {
    const double turn = 6.283185307179586;
    uint32_t i, k;
    for (i = 0; i <= strips; i++)
        for (k = 0; k < 2; k++) {
            double *x = s->vertices + 3 * (2 * i + k);
            const double along = -0.05 + 1.1 * i / strips;
            x[wave->across] = CHEESE_EDGE * (wave->level + wave->height * sin(turn * along / wave->length));
            x[wave->along] = CHEESE_EDGE * along;
            x[wave->straight] = CHEESE_EDGE * (k ? 1.1 : -0.1);
        }
    for (i = 0; i < strips; i++) {
        uint32_t *t = s->triangles + 6 * i, a = 2 * i;
        t[0] = a;
        t[1] = a + 2;
        t[2] = a + 3;
        t[3] = a;
        t[4] = a + 3;
        t[5] = a + 1;
    }
    s->vertex_count = 2 * (size_t)strips + 2;
    s->triangle_count = 2 * (size_t)strips;
}

/* A triangle, corners in edges */
static inline void cheese_fill_flat(cheese_surface *s, const double corner[9]) {
    uint32_t i;
    for (i = 0; i < 9; i++) s->vertices[i] = CHEESE_EDGE * corner[i];
    for (i = 0; i < 3; i++) s->triangles[i] = i;
    s->vertex_count = 3;
    s->triangle_count = 1;
}

/* strips: CHEESE_COARSE ... CHEESE_FINE */
static inline void cheese_fill(cheese_surface surfaces[CHEESE_SURFACES], uint32_t strips) {
    static const cheese_wave waves[3] = {
        {2, 0, 1, 0.22, 0.09, 0.3}, {0, 1, 2, 0.25, 0.08, 0.4}, {1, 2, 0, 0.2, 0.07, 0.35}};
    static const double level[9] = {-1, -1, 0.21, 3, -1, 0.21, -1, 3, 0.21},
                        oblique[9] = {1.63, -1, 0.02, -1, 1.57, 0.05, -1, -1, 2.6};
    int i;
    for (i = 0; i < 3; i++) cheese_fill_wave(&surfaces[i], &waves[i], strips);
    cheese_fill_flat(&surfaces[3], level);
    cheese_fill_flat(&surfaces[4], oblique);
}

#endif /* CHEESE_H */
