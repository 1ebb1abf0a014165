/* test_chains.c - chains of Booleans with every step evaluated. Three Booleans hold the same operands: one whose result
   is retained, one whose result is made anew in each step, and one made of all operands at once. The first two show the
   same triangles. All three have the same vertices to the last bit and the same components. A copy that only the
   reported ranges change stays equal to the retained result. Operands are those of the fuzzer, on one lattice, with
   repetitions. Some steps run out of memory, are read off coarsely, or in another precision. Operands are taken out,
   too: the Boolean of those that are left, made anew, has the same components, and the same corners once coplanar
   faces are merged. Those that are left are arranged anew in each such step, in some of them, or never. */
#include <stdint.h>

static uint32_t dead_share = 4; /* one such part dead: what is left is arranged anew */
#define GXBP_HOLDS_MUCH_DEAD(dead, all) ((dead) > (all) / dead_share)
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include "fuzz_cases.h"
#include "runner.h"
#include "scarce.h"

#include <math.h>
#include <stdio.h>

enum { CHAIN = 16, CHAINS = 240 };

static int same_bits(const void *a, const void *b, size_t size) { return size == 0 || memcmp(a, b, size) == 0; }

/* ---- chains ---- */

typedef struct chain {
    case_operand operand[CHAIN];
    size_t count;
    uint64_t state;
    int by_function; /* a function of all winding numbers decides */
    int failed;      /* memory ran out: the retained Boolean has arranged all operands at once */
    int removes;     /* operands are taken out on the way */
    int removed[CHAIN];
    uint32_t index[CHAIN]; /* of each operand that was added, in the Booleans that keep all */
} chain;

static uint32_t chance(chain *c, uint32_t n) { return (uint32_t)(splitmix64(&c->state) % n); }

/* Inside an odd number of operands */
static int odd_sum(void *user, const int32_t *winding, size_t count) {
    size_t i;
    uint32_t sum = 0;
    (void)user;
    for (i = 0; i < count; i++) sum += winding[i] != 0;
    return sum % 2 != 0;
}

static void make_chain(chain *c, uint64_t seed) {
    static test_case made;
    uint8_t bytes[256];
    uint32_t style, length, i;
    memset(c, 0, sizeof *c);
    c->state = seed;
    style = chance(c, CASE_STYLES);
    length = 3 + chance(c, CHAIN - 3);
    c->by_function = chance(c, 8) == 0;
    while (c->count < length) {
        case_fill(splitmix64(&c->state), bytes, sizeof bytes);
        bytes[0] = (uint8_t)(7 << 5 | (bytes[0] & 8));
        bytes[1] = (uint8_t)style;
        case_decode(bytes, sizeof bytes, &made);
        for (i = 0; i < made.operands && c->count < length; i++) {
            const int again = c->count > 0 && chance(c, 4) == 0;
            c->operand[c->count] = again ? c->operand[chance(c, (uint32_t)c->count)] : made.operand[i];
            /* few intersections, which leave little */
            if (c->operand[c->count].operation == GXB_INTERSECTION && chance(c, 3) > 0)
                c->operand[c->count].operation = GXB_UNION;
            if (again) c->operand[c->count].operation = chance(c, 2) ? GXB_DIFFERENCE : GXB_UNION;
            c->count++;
        }
    }
}

static gxb_boolean *start(const chain *c, int retained, memory *m) {
    gxb_boolean_desc desc;
    gxb_boolean *b = NULL;
    memset(&desc, 0, sizeof desc);
    if (c->by_function) desc.inside = odd_sum;
    if (m != NULL) desc.allocator = allocator_of(m);
    ck_assert_int_eq(gxb_boolean_create(&desc, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_fine(b, 1, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_retained(b, retained, NULL), GX_OK);
    return b;
}

static gx_result add(gxb_boolean *b, const case_operand *operand) {
    gxb_operand o;
    memset(&o, 0, sizeof o);
    o.vertices = &operand->mesh.x[0][0];
    o.vertex_count = operand->mesh.vertices;
    o.triangles = &operand->mesh.t[0][0];
    o.triangle_count = operand->mesh.triangles;
    o.operation = operand->operation;
    o.rule = operand->rule;
    return gxb_boolean_add(b, &o, NULL);
}

/* ---- results in an order of their own ---- */

typedef struct corner {
    double x[3];
} corner;
typedef struct facet { /* the least corner first */
    corner corner[3];
    uint32_t operand, source, reversed, none; /* none: 0, so that facets are equal in all bytes */
} facet;
typedef struct part {
    double volume;
    int32_t euler;
} part;
typedef struct picture {
    corner *corners; /* each once */
    facet *facets;
    part *parts;
    size_t corner_count, facet_count, part_count;
} picture;

static int by_bytes(const void *a, const void *b, size_t size) { return memcmp(a, b, size); }
static int by_corner(const void *a, const void *b) { return by_bytes(a, b, sizeof(corner)); }
static int by_facet(const void *a, const void *b) { return by_bytes(a, b, sizeof(facet)); }
static int by_part(const void *a, const void *b) {
    const part *p = (const part *)a, *q = (const part *)b;
    if (p->euler != q->euler) return p->euler < q->euler ? -1 : 1;
    return p->volume < q->volume ? -1 : p->volume > q->volume;
}

static facet facet_of(const gxb_boolean_result *r, size_t t) {
    facet f;
    size_t least = 0, k;
    corner x[3];
    memset(&f, 0, sizeof f);
    for (k = 0; k < 3; k++) {
        ck_assert_uint_lt(r->triangles[3 * t + k], r->vertex_count);
        memcpy(x[k].x, r->vertices + 3 * (size_t)r->triangles[3 * t + k], sizeof x[k].x);
        if (by_corner(&x[k], &x[least]) < 0) least = k;
    }
    for (k = 0; k < 3; k++) f.corner[k] = x[(least + k) % 3];
    f.operand = r->triangle_operand[t];
    f.source = r->triangle_source[t];
    f.reversed = r->triangle_reversed[t];
    return f;
}

static picture picture_of(gxb_boolean *b, const gxb_boolean_result *r) {
    gxb_components c;
    picture p;
    size_t i, k, n = 0;
    memset(&p, 0, sizeof p);
    ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_OK);
    p.corners = (corner *)malloc((3 * r->triangle_count + 1) * sizeof *p.corners);
    p.facets = (facet *)malloc((r->triangle_count + 1) * sizeof *p.facets);
    p.parts = (part *)malloc((c.count + 1) * sizeof *p.parts);
    for (i = 0; i < r->triangle_count; i++) {
        p.facets[i] = facet_of(r, i);
        for (k = 0; k < 3; k++) p.corners[3 * i + k] = p.facets[i].corner[k];
    }
    qsort(p.corners, 3 * r->triangle_count, sizeof *p.corners, by_corner);
    for (i = 0; i < 3 * r->triangle_count; i++)
        if (n == 0 || by_corner(&p.corners[i], &p.corners[n - 1]) != 0) p.corners[n++] = p.corners[i];
    p.corner_count = n;
    p.facet_count = r->triangle_count;
    qsort(p.facets, p.facet_count, sizeof *p.facets, by_facet);
    for (i = 0; i < c.count; i++) {
        p.parts[i].volume = c.volume[i];
        p.parts[i].euler = c.euler[i];
    }
    p.part_count = c.count;
    qsort(p.parts, p.part_count, sizeof *p.parts, by_part);
    return p;
}

static void drop_picture(picture *p) {
    free(p->corners);
    free(p->facets);
    free(p->parts);
}

static void check_parts(const picture *p, const picture *q, uint64_t seed, size_t step) {
    size_t i;
    ck_assert_msg(p->part_count == q->part_count, "seed %llu, step %zu: %zu components, or %zu",
                  (unsigned long long)seed, step, p->part_count, q->part_count);
    for (i = 0; i < p->part_count; i++)
        ck_assert_msg(p->parts[i].euler == q->parts[i].euler &&
                          fabs(p->parts[i].volume - q->parts[i].volume) <= 1e-12 * p->parts[i].volume,
                      "seed %llu, step %zu: component %zu", (unsigned long long)seed, step, i);
}

static void check_corners(const picture *p, const picture *q, uint64_t seed, size_t step) {
    ck_assert_msg(
        p->corner_count == q->corner_count && same_bits(p->corners, q->corners, p->corner_count * sizeof *p->corners),
        "seed %llu, step %zu: %zu corners, or %zu", (unsigned long long)seed, step, p->corner_count, q->corner_count);
    ck_assert_msg(p->facet_count == q->facet_count, "seed %llu, step %zu: %zu triangles, or %zu",
                  (unsigned long long)seed, step, p->facet_count, q->facet_count);
}

/* Triangulations depend on the order of operands; corners and components do not. */
static void check_same(const picture *p, const picture *q, int facets, uint64_t seed, size_t step) {
    check_corners(p, q, seed, step);
    ck_assert_msg(!facets || same_bits(p->facets, q->facets, p->facet_count * sizeof *p->facets),
                  "seed %llu, step %zu: other triangles", (unsigned long long)seed, step);
    check_parts(p, q, seed, step);
}

/* What an operand divided that was taken out does not show in the faces' outlines. */
static void check_merged(gxb_boolean *a, gxb_boolean *b, uint64_t seed, size_t step) {
    gxb_boolean *both[2];
    picture p[2];
    int i;
    both[0] = a;
    both[1] = b;
    for (i = 0; i < 2; i++) {
        gxb_boolean_result r;
        ck_assert_int_eq(gxb_boolean_set_triangulation(both[i], GXB_MERGED, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(both[i], &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_triangulation(both[i], GXB_DIVIDED, NULL), GX_OK);
        p[i] = picture_of(both[i], &r);
    }
    check_corners(&p[0], &p[1], seed, step);
    drop_picture(&p[0]);
    drop_picture(&p[1]);
}

/* ---- a copy that follows the reported ranges ---- */

typedef struct copy {
    double *vertices;
    gxb_origin *origins;
    uint32_t *triangles, *operands, *sources;
    uint8_t *reversed;
} copy;

static void *enlarged(void *memory, size_t bytes) {
    void *larger = realloc(memory, bytes + 1);
    ck_assert(larger != NULL);
    return larger;
}

#define COPY_RANGE(to, from, width, range)                                                                             \
    memcpy((to) + (width) * (range).first, (from) + (width) * (range).first, (width) * (range).count * sizeof *(to))

static void check_ranges(const gxb_range *range, size_t count, size_t end) {
    size_t i;
    for (i = 0; i < count; i++) {
        ck_assert_uint_gt(range[i].count, 0);
        ck_assert_uint_le(range[i].first + range[i].count, end);
        ck_assert(i == 0 || range[i].first > range[i - 1].first + range[i - 1].count);
    }
}

/* A vertex that no triangle has may keep what it was. */
static void follow(copy *c, gxb_boolean *b, const gxb_boolean_result *r) {
    gxb_changes changes;
    size_t i, k;
    ck_assert_int_eq(gxb_boolean_changes(b, &changes, NULL), GX_OK);
    check_ranges(changes.vertices, changes.vertex_range_count, r->vertex_count);
    check_ranges(changes.triangles, changes.triangle_range_count, r->triangle_count);
    c->vertices = (double *)enlarged(c->vertices, 3 * r->vertex_count * sizeof *c->vertices);
    c->origins = (gxb_origin *)enlarged(c->origins, r->vertex_count * sizeof *c->origins);
    c->triangles = (uint32_t *)enlarged(c->triangles, 3 * r->triangle_count * sizeof *c->triangles);
    c->operands = (uint32_t *)enlarged(c->operands, r->triangle_count * sizeof *c->operands);
    c->sources = (uint32_t *)enlarged(c->sources, r->triangle_count * sizeof *c->sources);
    c->reversed = (uint8_t *)enlarged(c->reversed, r->triangle_count);
    for (i = 0; i < changes.vertex_range_count; i++) {
        COPY_RANGE(c->vertices, r->vertices, 3, changes.vertices[i]);
        COPY_RANGE(c->origins, r->vertex_origin, 1, changes.vertices[i]);
    }
    for (i = 0; i < changes.triangle_range_count; i++) {
        COPY_RANGE(c->triangles, r->triangles, 3, changes.triangles[i]);
        COPY_RANGE(c->operands, r->triangle_operand, 1, changes.triangles[i]);
        COPY_RANGE(c->sources, r->triangle_source, 1, changes.triangles[i]);
        COPY_RANGE(c->reversed, r->triangle_reversed, 1, changes.triangles[i]);
    }
    ck_assert(same_bits(c->triangles, r->triangles, 3 * r->triangle_count * sizeof *c->triangles));
    ck_assert(same_bits(c->operands, r->triangle_operand, r->triangle_count * sizeof *c->operands));
    ck_assert(same_bits(c->sources, r->triangle_source, r->triangle_count * sizeof *c->sources));
    ck_assert(same_bits(c->reversed, r->triangle_reversed, r->triangle_count));
    for (i = 0; i < 3 * r->triangle_count; i++) {
        k = r->triangles[i];
        ck_assert(same_bits(c->vertices + 3 * k, r->vertices + 3 * k, 3 * sizeof *c->vertices));
        ck_assert(same_bits(&c->origins[k], &r->vertex_origin[k], sizeof *c->origins));
    }
}

static void drop_copy(copy *c) {
    free(c->vertices);
    free(c->origins);
    free(c->triangles);
    free(c->operands);
    free(c->sources);
    free(c->reversed);
}

/* ---- the chains ---- */

/* Evaluates. Memory may run out on the way; the second time there is enough. */
static void evaluate(chain *c, gxb_boolean *b, gxb_boolean_result *r, memory *m) {
    const size_t fail_at = chance(c, 4) == 0 ? chance(c, 12) : SIZE_MAX;
    gx_result result;
    if (fail_at != SIZE_MAX) fail_from(m, fail_at, 0);
    result = gxb_boolean_evaluate(b, r, NULL);
    never_fail(m);
    if (result == GX_ERROR_MEMORY) {
        ck_assert_uint_ne(fail_at, SIZE_MAX);
        c->failed = 1;
        result = gxb_boolean_evaluate(b, r, NULL);
    }
    ck_assert_int_eq(result, GX_OK);
}

/* Reads the retained result off in another way, now and then. */
static void look_elsewhere(chain *c, gxb_boolean *b) {
    gxb_boolean_result r;
    switch (chance(c, 16)) {
    case 0:
        ck_assert_int_eq(gxb_boolean_set_triangulation(b, 1 + chance(c, 2), NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_triangulation(b, GXB_DIVIDED, NULL), GX_OK);
        break;
    case 1:
        ck_assert_int_eq(gxb_boolean_set_fine(b, 0, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_fine(b, 1, NULL), GX_OK);
        break;
    case 2: ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK); break; /* nothing is new */
    default: break;
    }
}

static size_t compared; /* evaluations */

static void check_step(chain *c, gxb_boolean *retained, gxb_boolean *anew, copy *mirror, memory *m, uint64_t seed,
                       size_t step) {
    gxb_boolean *fresh = start(c, 0, NULL);
    gxb_boolean_result r;
    picture p[3];
    size_t i;
    for (i = 0; i <= step; i++)
        if (!c->removed[i]) (void)add(fresh, &c->operand[i]);
    evaluate(c, retained, &r, m);
    follow(mirror, retained, &r);
    p[0] = picture_of(retained, &r);
    ck_assert_int_eq(gxb_boolean_evaluate(anew, &r, NULL), GX_OK);
    p[1] = picture_of(anew, &r);
    ck_assert_int_eq(gxb_boolean_evaluate(fresh, &r, NULL), GX_OK);
    p[2] = picture_of(fresh, &r);
    compared++;
    if (!c->failed) check_same(&p[0], &p[1], 1, seed, step);
    if (!c->removes)
        check_same(&p[0], &p[2], 0, seed, step);
    else {
        check_parts(&p[0], &p[2], seed, step);
        check_merged(anew, fresh, seed, step);
    }
    for (i = 0; i < 3; i++) drop_picture(&p[i]);
    gxb_boolean_destroy(fresh);
    look_elsewhere(c, retained);
}

/* Takes an operand out of both. Memory may run out the first time. Some have been added since the last evaluation. */
static void remove_one(chain *c, gxb_boolean *retained, gxb_boolean *anew, size_t step, memory *m) {
    const size_t i = chance(c, (uint32_t)step + 1);
    gx_result result;
    if (c->removed[i] || c->index[i] == UINT32_MAX) return;
    if (chance(c, 4) == 0) fail_from(m, chance(c, 3), 0);
    result = gxb_boolean_remove(retained, c->index[i], NULL);
    never_fail(m);
    if (result == GX_ERROR_MEMORY) result = gxb_boolean_remove(retained, c->index[i], NULL);
    ck_assert_int_eq(result, GX_OK);
    ck_assert_int_eq(gxb_boolean_remove(anew, c->index[i], NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_remove(anew, c->index[i], NULL), GX_ERROR_INDEX);
    c->removed[i] = 1;
}

static size_t count_left(const chain *c, size_t step) {
    size_t i, left = 0;
    for (i = 0; i <= step; i++) left += !c->removed[i] && c->index[i] != UINT32_MAX;
    return left;
}

static void check_chain_of(uint64_t seed, int removes) {
    static const uint32_t shares[] = {4, 1, UINT32_MAX};
    static chain c;
    memory m = plenty();
    copy mirror;
    gxb_boolean *retained, *anew;
    size_t step, added = 0;
    make_chain(&c, seed);
    c.removes = removes;
    dead_share = shares[seed / 2 % 3];
    memset(&mirror, 0, sizeof mirror);
    retained = start(&c, 1, &m);
    anew = start(&c, 0, NULL);
    for (step = 0; step < c.count; step++) {
        const gx_result result = add(retained, &c.operand[step]);
        ck_assert_int_eq(add(anew, &c.operand[step]), result);
        c.index[step] = result == GX_OK ? (uint32_t)added : UINT32_MAX;
        added += result == GX_OK;
        while (removes && chance(&c, 3) == 0) remove_one(&c, retained, anew, step, &m);
        if (count_left(&c, step) > 0 && chance(&c, 5) > 0) check_step(&c, retained, anew, &mirror, &m, seed, step);
    }
    drop_copy(&mirror);
    gxb_boolean_destroy(retained);
    gxb_boolean_destroy(anew);
    ck_assert(m.blocks == NULL && !m.wrong && !m.overrun);
}

static void check_chain(uint64_t seed) { check_chain_of(seed, 0); }

static uint64_t seeds[2]; /* given by the caller: the first, and the end */

START_TEST(given_chains) {
    uint64_t seed;
    for (seed = seeds[0]; seed < seeds[1]; seed++) check_chain_of(seed, (int)(seed & 1));
    printf("%zu evaluations compared\n", compared);
}
END_TEST

START_TEST(retained_results_are_those_of_a_fresh_boolean) {
    int i;
    for (i = 0; i < CHAINS / 10 / FEWER; i++) check_chain((uint64_t)(CHAINS / 10 * _i + i));
}
END_TEST

START_TEST(operands_are_taken_out) {
    int i;
    for (i = 0; i < CHAINS / 20 / FEWER; i++) check_chain_of((uint64_t)(CHAINS / 20 * _i + i), 1);
}
END_TEST

/* Chains that once failed: a triangle stays when the other side of a sheet appears behind it, and bears the sheet's
 * name; a component is so thin that 180 bits do not tell its volume. */
START_TEST(chains_that_failed) {
    check_chain(1000824);
    check_chain(6036544);
}
END_TEST

static int is_all(const gxb_range *ranges, size_t count, size_t all) {
    return count == (all > 0) && (all == 0 || (ranges[0].first == 0 && ranges[0].count == all));
}

/* All of a result that is made from nothing has changed: of one that is not retained, or mended. Memory runs out too.
 */
START_TEST(all_is_new_that_is_made_from_nothing) {
    static chain c;
    memory m = plenty();
    copy mirror;
    gxb_boolean *b;
    gxb_boolean_result r;
    gxb_changes changes;
    size_t step, added = 0;
    make_chain(&c, 1000 + (uint64_t)_i);
    memset(&mirror, 0, sizeof mirror);
    b = start(&c, 0, &m);
    ck_assert_int_eq(gxb_boolean_set_retained(NULL, 1, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_changes(b, &changes, NULL), GX_ERROR_SEQUENCE);
    for (step = 0; step < c.count; step++) {
        const int retained = step % 4 < 2, mend = step % 2;
        gx_result result = GX_ERROR_MEMORY;
        size_t n;
        added += add(b, &c.operand[step]) == GX_OK;
        if (added == 0) continue;
        ck_assert_int_eq(gxb_boolean_set_retained(b, retained, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_mend(b, mend, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        for (n = 0; result != GX_OK; n++) {
            fail_from(&m, n, 1);
            result = gxb_boolean_changes(b, &changes, NULL);
            ck_assert(result == GX_OK || result == GX_ERROR_MEMORY);
        }
        never_fail(&m);
        follow(&mirror, b, &r);
        if (retained && !mend) continue;
        ck_assert(is_all(changes.vertices, changes.vertex_range_count, r.vertex_count));
        ck_assert(is_all(changes.triangles, changes.triangle_range_count, r.triangle_count));
    }
    drop_copy(&mirror);
    gxb_boolean_destroy(b);
    ck_assert(m.blocks == NULL && !m.wrong && !m.overrun);
}
END_TEST

/* A Boolean of which everything is taken out is empty. Its next operand is the first one again. */
START_TEST(all_operands_are_taken_out) {
    static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    static chain c;
    gxb_boolean *b;
    gxb_boolean_result r;
    gx_failure f;
    gxb_components parts;
    int round;
    memset(&c, 0, sizeof c);
    b = start(&c, _i, NULL);
    ck_assert_int_eq(gxb_boolean_remove(NULL, 0, &f), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_remove(b, 0, &f), GX_ERROR_INDEX);
    ck_assert_str_eq(f.field, "operand");
    ck_assert_uint_eq(f.index, 0);
    for (round = 0; round < 3; round++) {
        static const uint32_t operations[] = {GXB_UNION, GXB_INTERSECTION, GXB_DIFFERENCE};
        gxb_operand o;
        memset(&o, 0, sizeof o);
        o.vertices = &corners[0][0];
        o.vertex_count = 4;
        o.triangles = &faces[0][0];
        o.triangle_count = 4;
        o.operation = operations[round];
        ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_components(b, &parts, NULL), GX_OK);
        ck_assert_uint_eq(parts.count, 1);
        ck_assert(fabs(parts.total_volume - 1.0 / 6) < 1e-15);
        ck_assert_uint_eq(r.triangle_operand[0], (uint32_t)round);
        ck_assert_int_eq(gxb_boolean_remove(b, (uint32_t)round, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_components(b, &parts, NULL), GX_ERROR_SEQUENCE);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_uint_eq(r.triangle_count, 0);
        ck_assert_int_eq(gxb_boolean_components(b, &parts, NULL), GX_OK);
        ck_assert_uint_eq(parts.count, 0);
    }
    gxb_boolean_destroy(b);
}
END_TEST

/* A box with these corners, moved along x; skew: by how much its corners are off, so that nothing is aligned */
static gxb_operand box_of(double x[8][3], const double low[3], const double high[3], double skew, double along) {
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    gxb_operand o;
    int i, k;
    memset(&o, 0, sizeof o);
    for (i = 0; i < 8; i++)
        for (k = 0; k < 3; k++)
            x[i][k] = (i >> k & 1 ? high : low)[k] + (i * (k + 2) % 5) * skew + (k == 0 ? along : 0);
    o.vertices = &x[0][0];
    o.vertex_count = 8;
    o.triangles = &faces[0][0];
    o.triangle_count = 12;
    return o;
}

/* A tool is dragged through a block, in steps of a 32nd of its length: each time it is taken out and added again. What
   it leaves has one volume in all places. A sheet beside it stays, too. The Boolean does not grow with the places where
   the tool was. */
START_TEST(a_dragged_tool_leaves_nothing_behind) {
    static const double low[3] = {0, 0, 0}, high[3] = {4, 1, 1};
    static const double tool_low[3] = {0.25, 0.25, 0.5}, tool_high[3] = {0.75, 0.75, 1.5};
    double block[8][3], x[8][3], volume = 0;
    uint32_t place, first = 0;
    chain c;
    gxb_boolean *b;
    gxb_operand o = box_of(block, low, high, 0, 0);
    dead_share = 4;
    memset(&c, 0, sizeof c);
    b = start(&c, _i / 2, NULL);
    o.operation = GXB_UNION;
    ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_OK);
    o.operation = GXB_SPLIT;
    o.vertex_count = 3;
    o.triangle_count = 1;
    for (place = 0; place < 3; place++) block[place][1] += 2;
    ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_OK);
    for (place = 0; place < 180 / FEWER; place++) {
        gxb_boolean_result r;
        gxb_components parts;
        o = box_of(x, tool_low, tool_high, _i % 2 == 0 ? 0 : 0.01, place / 64.0);
        o.operation = GXB_DIFFERENCE;
        if (place > 0) ck_assert_int_eq(gxb_boolean_remove(b, place + 1, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_components(b, &parts, NULL), GX_OK);
        if (place == 0) {
            volume = _i % 2 == 0 ? 3.875 : parts.total_volume;
            first = b->in.source_count + b->crossings.segment_count;
        }
        ck_assert_uint_eq(parts.count, 1);
        ck_assert_int_eq(parts.euler[0], 2);
        ck_assert(fabs(parts.total_volume - volume) < 1e-14);
        ck_assert_uint_le(b->in.source_count + b->crossings.segment_count, 3 * first);
        ck_assert_uint_le(b->points.vertex_count, 3 * first);
    }
    gxb_boolean_destroy(b);
}
END_TEST

/* test_chains [FIRST END]: the chains of these seeds */
int main(int argc, char **argv) {
    Suite *suite = suite_create("chains");
    TCase *tests = tcase_create("chains"), *anew = tcase_create("anew");
    tcase_set_timeout(tests, 300);
    if (argc == 3) {
        seeds[0] = strtoull(argv[1], NULL, 10);
        seeds[1] = strtoull(argv[2], NULL, 10);
        tcase_set_timeout(tests, 0);
        tcase_add_test(tests, given_chains);
    } else {
        tcase_add_loop_test(tests, retained_results_are_those_of_a_fresh_boolean, 0, 10);
        tcase_add_loop_test(tests, operands_are_taken_out, 0, 10);
        tcase_add_test(tests, chains_that_failed);
        tcase_add_loop_test(tests, all_operands_are_taken_out, 0, 2);
        tcase_add_loop_test(tests, a_dragged_tool_leaves_nothing_behind, 0, 4);
        tcase_add_loop_test(anew, all_is_new_that_is_made_from_nothing, 0, 8);
    }
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, anew);
    return run_suite(suite);
}
