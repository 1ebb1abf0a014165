/* replay.h - a scene's run as a file (--trace of the scenes, examples/scene.h): mesh, material, state at the start,
   held regions, and the cuts of each frame. Methods repeat what is read here. A file of another kind ends the
   program. Include after gxfem.h. */
#ifndef GXFEM_BENCH_REPLAY_H
#define GXFEM_BENCH_REPLAY_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REPLAY_THICKNESS 1e-4 /* GXFEM's Table 1, except for the single tetrahedron */

/* Before a frame's step: the triangles from `first` on cut. Those before it are the earlier part of the same blade's
   path. */
typedef struct replay_cut {
    size_t frame, first;
    gx_surface path;
} replay_cut;

typedef struct replay {
    double young, poisson, density; /* Pa, -, kg/m3 */
    double dt, gravity[3];          /* s, m/s2 */
    unsigned long newton_iterations;
    size_t node_count, element_count, region_count, frames, cut_count;
    double *positions, *displacement, *velocity; /* node_count x 3 */
    uint32_t *elements;                          /* element_count x 4 */
    gx_region *regions;
    replay_cut *cuts;
    double sever_below;  /* see gx_cut_desc; not in files: 0 */
    double affine_below; /* see gx_body_desc; not in files: 0 */
    /* of sheets, for methods that need solids, m; not in files: REPLAY_THICKNESS */
    double thickness;
    const char *name; /* of the file */
    FILE *stream;     /* while it is read */
} replay;

static inline void replay_expect(const replay *r, int holds) {
    if (holds) return;
    fprintf(stderr, "%s: not a trace of a scene, or cut short\n", r->name);
    exit(2);
}

static inline double replay_number(const replay *r) {
    double x;
    replay_expect(r, fscanf(r->stream, "%lf", &x) == 1);
    return x;
}

static inline size_t replay_count(const replay *r) {
    unsigned long n;
    replay_expect(r, fscanf(r->stream, "%lu", &n) == 1);
    return n;
}

static inline void replay_word(const replay *r, const char *expected) {
    char word[32];
    replay_expect(r, fscanf(r->stream, "%31s", word) == 1 && strcmp(word, expected) == 0);
}

static inline void *replay_array(const replay *r, void *old, size_t count, size_t size) {
    void *memory = realloc(old, count * size + 1);
    if (memory) return memory;
    fprintf(stderr, "%s: no memory\n", r->name);
    exit(1);
}

static inline double *replay_numbers(const replay *r, size_t count) {
    double *x = (double *)replay_array(r, NULL, count, sizeof *x);
    size_t i;
    for (i = 0; i < count; i++) x[i] = replay_number(r);
    return x;
}

static inline uint32_t *replay_indices(const replay *r, size_t count, size_t below) {
    uint32_t *x = (uint32_t *)replay_array(r, NULL, count, sizeof *x);
    size_t i;
    for (i = 0; i < count; i++) {
        const size_t n = replay_count(r);
        replay_expect(r, n < below);
        x[i] = (uint32_t)n;
    }
    return x;
}

static inline void replay_read_mesh(replay *r) {
    double *all;
    size_t i;
    replay_word(r, "nodes");
    r->node_count = replay_count(r);
    all = replay_numbers(r, 9 * r->node_count);
    r->positions = (double *)replay_array(r, NULL, 3 * r->node_count, sizeof(double));
    r->displacement = (double *)replay_array(r, NULL, 3 * r->node_count, sizeof(double));
    r->velocity = (double *)replay_array(r, NULL, 3 * r->node_count, sizeof(double));
    for (i = 0; i < r->node_count; i++) {
        memcpy(r->positions + 3 * i, all + 9 * i, 3 * sizeof(double));
        memcpy(r->displacement + 3 * i, all + 9 * i + 3, 3 * sizeof(double));
        memcpy(r->velocity + 3 * i, all + 9 * i + 6, 3 * sizeof(double));
    }
    free(all);
    replay_word(r, "elements");
    r->element_count = replay_count(r);
    r->elements = replay_indices(r, 4 * r->element_count, r->node_count);
}

static inline void replay_read_regions(replay *r) {
    size_t i;
    replay_word(r, "regions");
    r->region_count = replay_count(r);
    r->regions = (gx_region *)replay_array(r, NULL, r->region_count, sizeof *r->regions);
    for (i = 0; i < r->region_count; i++) {
        const uint32_t axis = (uint32_t)replay_count(r);
        const int side = (int)replay_number(r);
        r->regions[i] = gx_region_half_space(axis, side, replay_number(r));
        replay_expect(r, r->regions[i].axis < 3);
    }
}

static inline void replay_read_cut(replay *r) {
    replay_cut *cut;
    r->cuts = (replay_cut *)replay_array(r, r->cuts, r->cut_count + 1, sizeof *r->cuts);
    cut = &r->cuts[r->cut_count++];
    memset(cut, 0, sizeof *cut);
    cut->frame = replay_count(r);
    cut->path.vertex_count = replay_count(r);
    cut->path.triangle_count = replay_count(r);
    cut->first = replay_count(r);
    replay_expect(r, cut->first < cut->path.triangle_count);
    cut->path.vertices = replay_numbers(r, 3 * cut->path.vertex_count);
    cut->path.triangles = replay_indices(r, 3 * cut->path.triangle_count, cut->path.vertex_count);
}

static inline replay replay_read(const char *name) {
    replay r;
    char word[32];
    int k;
    memset(&r, 0, sizeof r);
    r.name = name;
    r.thickness = REPLAY_THICKNESS;
    r.stream = fopen(name, "r");
    if (!r.stream) {
        perror(name);
        exit(2);
    }
    replay_word(&r, "gxfem-trace");
    replay_expect(&r, replay_count(&r) == 1);
    replay_word(&r, "material");
    r.young = replay_number(&r);
    r.poisson = replay_number(&r);
    r.density = replay_number(&r);
    replay_word(&r, "step");
    r.dt = replay_number(&r);
    for (k = 0; k < 3; k++) r.gravity[k] = replay_number(&r);
    r.newton_iterations = replay_count(&r);
    replay_read_mesh(&r);
    replay_read_regions(&r);
    replay_word(&r, "frames");
    r.frames = replay_count(&r);
    while (fscanf(r.stream, "%31s", word) == 1) {
        replay_expect(&r, strcmp(word, "cut") == 0);
        replay_read_cut(&r);
    }
    fclose(r.stream);
    r.stream = NULL;
    return r;
}

/* SCENE=TRACE on the command line: the scene's name, and the trace. Another word ends the program. */
static inline replay replay_argument(const char *program, const char *argument, char name[32]) {
    const char *file = strchr(argument, '=');
    if (!file || file - argument >= 32) {
        fprintf(stderr, "usage: %s FILE SCENE=TRACE...\n", program);
        exit(2);
    }
    memcpy(name, argument, (size_t)(file - argument));
    name[file - argument] = 0;
    return replay_read(file + 1);
}

static inline void replay_free(replay *r) {
    size_t i;
    for (i = 0; i < r->cut_count; i++) {
        free((void *)(uintptr_t)r->cuts[i].path.vertices);
        free((void *)(uintptr_t)r->cuts[i].path.triangles);
    }
    free(r->cuts);
    free(r->positions);
    free(r->displacement);
    free(r->velocity);
    free(r->elements);
    free(r->regions);
    memset(r, 0, sizeof *r);
}

/* Is a node at a held place? */
static inline int replay_is_held(const replay *r, size_t node) {
    size_t i;
    for (i = 0; i < r->region_count; i++) {
        const gx_region *g = &r->regions[i];
        const double x = r->positions[3 * node + g->axis];
        if (g->side < 0 ? x < g->value : x > g->value) return 1;
    }
    return 0;
}

/* The triangles of the cut that are new; borrowed */
static inline gx_surface replay_strip(const replay_cut *cut) {
    gx_surface strip = cut->path;
    strip.triangles += 3 * cut->first;
    strip.triangle_count -= cut->first;
    return strip;
}

#endif
