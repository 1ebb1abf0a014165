/* test_surface_boolean.c - Booleans of closed surfaces. The named workloads against the exact oracle, at once and in
   sequence. Small random solids on a lattice (coplanar, touching, nested, self-crossing) against the oracle and
   against the identities of volumes. Provenance, sheets, winding rules, coarse results, memory that runs out,
   refused input. */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include "../bench/splitmix.h"
#include "workloads.h"
#include "operand.h"
#include "runner.h"
#include "scarce.h"

#define CHECK_CASE(condition, ...) ck_assert_msg(condition, __VA_ARGS__)

/* ---- random numbers: splitmix64 ---- */

static uint64_t random_state;

static uint64_t random_bits(void) { return splitmix64(&random_state); }
static int random_below(int n) { return (int)(random_bits() % (uint64_t)n); }

/* ---- operands and answers ---- */

static gxb_operand operand_of(const wl_surface *s, uint32_t operation) {
    return operand_from(s->vertices, s->vertex_count, s->triangles, s->triangle_count, operation);
}

static void surface_free(wl_surface *s) {
    free(s->vertices);
    free(s->triangles);
    memset(s, 0, sizeof *s);
}

/* The boundary of a mesh of tetrahedra: faces that no other element has */
static wl_surface boundary_of(const workload *w) {
    static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    wl_surface s;
    size_t e, f;
    int k, m, i, j;
    memset(&s, 0, sizeof s);
    for (e = 0; e < w->node_count; e++) wl_add_vertex(&s, w->positions + 3 * e);
    for (e = 0; e < w->element_count; e++)
        for (k = 0; k < 4; k++) {
            int shared = 0;
            uint32_t n[3];
            for (i = 0; i < 3; i++) n[i] = w->elements[4 * e + (size_t)faces[k][i]];
            for (f = 0; f < w->element_count; f++)
                for (m = 0; m < 4 && f != e; m++) {
                    int same = 0;
                    for (i = 0; i < 3; i++)
                        for (j = 0; j < 3; j++) same += w->elements[4 * f + (size_t)faces[m][i]] == n[j];
                    shared |= same == 3;
                }
            if (!shared) wl_add_triangle(&s, n[0], n[1], n[2]);
        }
    return s;
}

static void swap_bytes(void *a, void *b, size_t size) {
    unsigned char *p = (unsigned char *)a, *q = (unsigned char *)b;
    for (; size > 0; size--, p++, q++) {
        const unsigned char kept = *p;
        *p = *q;
        *q = kept;
    }
}

typedef struct answer {
    size_t components, triangles, defects;
    double volume;
    long euler;
} answer;

/* Every directed edge of the result is matched by one in the other direction. */
static void check_closed(const gxb_boolean_result *r) {
    const size_t words = 3 * r->triangle_count;
    uint32_t *twin = (uint32_t *)malloc((words + gxbp_twin_room(r->vertex_count) + 1) * sizeof *twin), open;
    size_t t;
    for (t = 0; t < 3 * r->triangle_count; t++) ck_assert_uint_lt(r->triangles[t], r->vertex_count);
    gxbp_find_twins(r->triangles, r->triangle_count, (uint32_t)r->vertex_count, twin, &open, twin + words);
    ck_assert_uint_eq(open, GXB_NONE);
    free(twin);
}

static gxb_defects defects_of(gxb_boolean *b) {
    gxb_defects d;
    ck_assert_int_eq(gxb_boolean_defects(b, &d, NULL), GX_OK);
    return d;
}

static gxb_components components_of(gxb_boolean *b) {
    gxb_components c;
    ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_OK);
    return c;
}

static answer read_answer(gxb_boolean *b) {
    gxb_boolean_result r;
    gxb_components c;
    answer a;
    size_t i;
    double sum = 0;
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    check_closed(&r);
    c = components_of(b);
    for (i = 0; i < r.triangle_count; i++) ck_assert_uint_lt(c.triangle[i], c.count);
    a.euler = 0;
    for (i = 0; i < c.count; i++) {
        ck_assert(c.volume[i] > 0);
        sum += c.volume[i];
        a.euler += c.euler[i];
    }
    ck_assert(fabs(sum - c.total_volume) <= 1e-12 * sum);
    a.components = c.count;
    a.triangles = r.triangle_count;
    a.defects = defects_of(b).count;
    a.volume = c.total_volume;
    return a;
}

/* A Boolean of the operands; its results are read off as stated */
static gxb_boolean *boolean_of(const gxb_operand *o, size_t count, uint32_t triangulation, int fine, int mend) {
    gxb_boolean *b = NULL;
    size_t i;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_triangulation(b, triangulation, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_fine(b, fine, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_mend(b, mend, NULL), GX_OK);
    for (i = 0; i < count; i++) ck_assert_int_eq(gxb_boolean_add(b, &o[i], NULL), GX_OK);
    return b;
}

/* All operands at once, or (each) evaluated after each */
static answer evaluate(const gxb_operand *operands, size_t count, int each) {
    gxb_boolean *b = NULL;
    answer a = {0, 0, 0, 0, 0};
    size_t i;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i < count; i++) {
        ck_assert_int_eq(gxb_boolean_add(b, &operands[i], NULL), GX_OK);
        if (each && i + 1 < count) read_answer(b);
    }
    a = read_answer(b);
    gxb_boolean_destroy(b);
    return a;
}

static answer combine(const wl_surface *p, uint32_t operation, const wl_surface *q) {
    gxb_operand o[2];
    o[0] = operand_of(p, GXB_UNION);
    o[1] = operand_of(q, operation);
    return evaluate(o, 2, 0);
}

static int close_to(double x, double y, double size) { return fabs(x - y) <= 1e-11 * size; }

/* ---- workloads ---- */

static void check_answer(const char *name, const answer *a, size_t components, double volume) {
    CHECK_CASE(a->components == components, "%s: %zu components, should be %zu", name, a->components, components);
    CHECK_CASE(fabs(a->volume - volume) <= 1e-10 * volume, "%s: volume %.17g, should be %.17g", name, a->volume,
               volume);
}

static void check_balls(const char *name, const answer *a) {
    CHECK_CASE(a->euler == 2 * (long)a->components, "%s: Euler characteristic %ld of %zu balls", name, a->euler,
               a->components);
}

/* The kept volume, every component of it a ball, at once, in sequence and with every surface vouched for; and the
   removed volume, which shows cuts however thin. */
static void check_cuts(const char *name, const workload *w, size_t components, double kept, double removed) {
    gxb_operand o[WL_SURFACES + 1];
    wl_surface body = boundary_of(w);
    size_t i, n = w->surface_count;
    answer a;
    o[0] = operand_of(&body, GXB_UNION);
    for (i = 0; i < n; i++) o[i + 1] = operand_of(&w->surfaces[i], GXB_DIFFERENCE);
    a = evaluate(o, n + 1, 0);
    check_answer(name, &a, components, kept);
    check_balls(name, &a);
    a = evaluate(o, n + 1, 1);
    check_answer(name, &a, components, kept);
    check_balls(name, &a);
    for (i = 0; i <= n; i++) o[i].simple = 1;
    a = evaluate(o, n + 1, 0);
    check_answer(name, &a, components, kept);
    for (i = 0; i < n; i++) o[i] = operand_of(&w->surfaces[i], GXB_UNION);
    o[n] = operand_of(&body, GXB_INTERSECTION);
    a = evaluate(o, n + 1, 0);
    CHECK_CASE(fabs(a.volume - removed) <= 1e-9 * removed, "%s: removed %.17g, should be %.17g", name, a.volume,
               removed);
    surface_free(&body);
}

static void check_workload(const char *name, workload w, size_t components) {
    oracle *truth = wl_oracle(&w);
    ck_assert_uint_eq(truth->fragment_count, components);
    check_cuts(name, &w, components, truth->volume, wl_removed_volume(truth));
    oracle_destroy(truth);
    wl_free(&w);
}

START_TEST(slabs) {
    check_workload("W1", wl_through(1e-4), 2);
    check_workload("W2", wl_ring_cut(6), 2);
    check_workload("W2f", wl_ring_cut(5), 2);
}
END_TEST

/* Crossing boxes far away: a surface with them is not simple. It divides others segment by segment instead of by
   whole chains. */
static void add_crossing_boxes(wl_surface *s) {
    static const double low[2][3] = {{50, 50, 50}, {51, 51, 51}}, high[2][3] = {{52, 52, 52}, {53, 53, 53}};
    int i;
    for (i = 0; i < 2; i++) wl_add_aligned_box(s, low[i], high[i]);
}

static void check_chains(const char *name, const wl_surface *body, wl_surface *cut) {
    answer chains = combine(body, GXB_DIFFERENCE, cut), segments;
    add_crossing_boxes(cut);
    segments = combine(body, GXB_DIFFERENCE, cut);
    CHECK_CASE(chains.components == segments.components && chains.triangles == segments.triangles &&
                   chains.euler == segments.euler && fabs(chains.volume - segments.volume) <= 1e-12 * segments.volume,
               "%s: %zu components of %zu triangles and volume %.17g by chains, %zu of %zu and %.17g by segments", name,
               chains.components, chains.triangles, chains.volume, segments.components, segments.triangles,
               segments.volume);
}

static void check_chains_of(const char *name, workload w) {
    wl_surface body = boundary_of(&w);
    check_chains(name, &body, &w.surfaces[0]);
    surface_free(&body);
    wl_free(&w);
}

START_TEST(chains_divide_as_segments_do) {
    static const uint32_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    static const double low[3] = {0.25, 0.25, 0.25}, high[3] = {0.75, 0.75, 0.75};
    int i, k;
    check_chains_of("W1", wl_through(1e-4));
    check_chains_of("W2", wl_ring_cut(6));
    check_chains_of("W2f", wl_ring_cut(5));
    check_chains_of("W3", wl_wavy(1));
    random_state = 7;
    for (i = 0; i < 100; i++) {
        wl_surface box, tetrahedron;
        double x[4][3];
        char name[32];
        int turned;
        memset(&box, 0, sizeof box);
        memset(&tetrahedron, 0, sizeof tetrahedron);
        wl_add_aligned_box(&box, low, high);
        for (k = 0; k < 12; k++) x[k / 3][k % 3] = (double)(random_bits() >> 11) / 9007199254740992.0;
        turned = gxb_orient3d(x[1], x[2], x[3], x[0]) < 0;
        for (k = 0; k < 4; k++) wl_add_vertex(&tetrahedron, x[k]);
        for (k = 0; k < 4; k++)
            wl_add_triangle(&tetrahedron, faces[k][0], faces[k][turned ? 1 : 2], faces[k][turned ? 2 : 1]);
        sprintf(name, "tetrahedron %d", i);
        check_chains(name, &box, &tetrahedron);
        surface_free(&box);
        surface_free(&tetrahedron);
    }
}
END_TEST

START_TEST(wavy_sheet) {
    static const double apex[3] = {0.148, 0.298, 0.398};
    workload w = wl_wavy(1), uncut = wl_tetrahedron(wl_unit_tetrahedron);
    double removed = wl_inside_volume(wl_unit_tetrahedron, &w.surfaces[0], apex);
    wl_surface body = boundary_of(&uncut);
    gxb_operand o = operand_of(&body, GXB_UNION);
    answer whole = evaluate(&o, 1, 0);
    check_cuts("W3", &w, 2, whole.volume - removed, removed);
    surface_free(&body);
    wl_free(&uncut);
    wl_free(&w);
}
END_TEST

START_TEST(sticks) {
    wl_frame axes = wl_axes(), rotated = wl_rotated();
    workload w = wl_sticks(&axes);
    check_cuts("W4", &w, 36, 0.995 * 0.995, 1 - 0.995 * 0.995);
    wl_free(&w);
    check_workload("W4r", wl_sticks(&rotated), 36);
}
END_TEST

START_TEST(hard_slabs_and_corners) {
    const char *name;
    size_t pieces;
    workload w = wl_hard(_i, &name, &pieces);
    check_workload(name, w, pieces);
}
END_TEST

/* ---- random solids on a lattice ---- */

static void add_box(wl_surface *s, int size) {
    double low[3], high[3];
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = random_below(size);
        high[k] = low[k] + 1 + random_below(size);
    }
    wl_add_aligned_box(s, low, high);
}

/* Oriented outward */
static void add_oriented(wl_surface *s, double x[4][3]) {
    static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    uint32_t n[4];
    int i;
    for (i = 0; i < 4; i++) n[i] = wl_add_vertex(s, x[i]);
    if (gxb_orient3d(x[1], x[2], x[3], x[0]) < 0) {
        uint32_t swap = n[0];
        n[0] = n[1];
        n[1] = swap;
    }
    for (i = 0; i < 4; i++) wl_add_triangle(s, n[faces[i][0]], n[faces[i][1]], n[faces[i][2]]);
}

/* A tetrahedron with corners on the lattice */
static void add_tetrahedron(wl_surface *s, int size) {
    double x[4][3];
    int i, k;
    do
        for (i = 0; i < 4; i++)
            for (k = 0; k < 3; k++) x[i][k] = random_below(size + 1);
    while (gxb_orient3d(x[1], x[2], x[3], x[0]) == 0);
    add_oriented(s, x);
}

/* A tetrahedron around a place, of a size, in general position */
static void add_spike(wl_surface *s, const double place[3], double size) {
    double x[4][3];
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) x[i][k] = place[k] + size * (random_below(20001) - 10000) / 10000.0;
    add_oriented(s, x);
}

/* One to three boxes and tetrahedra: they may lie in, on and through each other. */
static wl_surface random_solid(int parts) {
    wl_surface s;
    memset(&s, 0, sizeof s);
    for (parts = 1 + random_below(parts); parts > 0; parts--)
        if (random_below(2))
            add_box(&s, 3);
        else
            add_tetrahedron(&s, 4);
    return s;
}

/* 1: turned, so that flat or equal parts are so only up to rounding; 2: coordinates moved by units of their last
   place, without tearing the surface */
static void disturb(wl_surface *s, int how) {
    wl_frame rotated = wl_rotated();
    size_t i;
    for (i = 0; i < s->vertex_count && how == 1; i++) {
        double x[3];
        memcpy(x, s->vertices + 3 * i, sizeof x);
        wl_place(&rotated, x, s->vertices + 3 * i);
    }
    for (i = 0; i < 3 * s->vertex_count && how == 2; i++) s->vertices[i] *= 1 + (random_below(5) - 2) * ldexp(1, -52);
}

static double volume_of(const wl_surface *s) {
    gxb_operand o = operand_of(s, GXB_UNION);
    return evaluate(&o, 1, 0).volume;
}

/* vol(A) + vol(B) = vol(A or B) + vol(A and B), and the consequences for the other operations */
static void check_volumes(const wl_surface *p, const wl_surface *q, unsigned seed) {
    double vp = volume_of(p), vq = volume_of(q), size = vp + vq;
    double both = combine(p, GXB_INTERSECTION, q).volume, any = combine(p, GXB_UNION, q).volume;
    double minus = combine(p, GXB_DIFFERENCE, q).volume, one = combine(p, GXB_SYMMETRIC_DIFFERENCE, q).volume;
    CHECK_CASE(close_to(both + any, size, size), "seed %u: %.17g and %.17g have %.17g in common and %.17g together",
               seed, vp, vq, both, any);
    CHECK_CASE(close_to(minus + both, vp, size), "seed %u: %.17g less %.17g is %.17g", seed, vp, both, minus);
    CHECK_CASE(close_to(one + both, any, size), "seed %u: only one: %.17g, both: %.17g, any: %.17g", seed, one, both,
               any);
    CHECK_CASE(close_to(combine(p, GXB_UNION, p).volume, vp, size), "seed %u: with itself", seed);
    CHECK_CASE(combine(p, GXB_DIFFERENCE, p).triangles == 0, "seed %u: less itself", seed);
}

START_TEST(volumes_add_up) {
    unsigned seed;
    for (seed = 1; seed <= 250; seed++) {
        wl_surface p, q;
        random_state = seed;
        p = random_solid(3);
        q = random_solid(3);
        disturb(&p, (int)(seed % 3));
        disturb(&q, (int)(seed % 3));
        check_volumes(&p, &q, seed);
        surface_free(&p);
        surface_free(&q);
    }
}
END_TEST

/* x, y, z become y, -x, z (a rotation) or the lattice times 3/8 plus a shift (rounding-free); order of triangles and
 * corners turned */
static wl_surface moved(const wl_surface *s, int how) {
    wl_surface m;
    size_t i;
    memset(&m, 0, sizeof m);
    for (i = 0; i < s->vertex_count; i++) {
        const double *x = s->vertices + 3 * (how == 2 ? s->vertex_count - 1 - i : i);
        double y[3] = {x[0], x[1], x[2]};
        if (how == 0) {
            y[0] = x[1];
            y[1] = -x[0];
        }
        if (how == 1) {
            y[0] = 0.375 * x[0] + 5;
            y[1] = 0.375 * x[1] - 2;
            y[2] = 0.375 * x[2];
        }
        wl_add_vertex(&m, y);
    }
    for (i = 0; i < s->triangle_count; i++) {
        const uint32_t *t = s->triangles + 3 * (how == 2 ? s->triangle_count - 1 - i : i);
        const uint32_t n = (uint32_t)s->vertex_count - 1;
        if (how == 2)
            wl_add_triangle(&m, n - t[1], n - t[2], n - t[0]);
        else
            wl_add_triangle(&m, t[0], t[1], t[2]);
    }
    return m;
}

START_TEST(the_same_from_elsewhere) {
    unsigned seed;
    int how;
    for (seed = 1; seed <= 100; seed++) {
        wl_surface p, q;
        answer a;
        random_state = 1000 + seed;
        p = random_solid(2);
        q = random_solid(3);
        a = combine(&p, GXB_DIFFERENCE, &q);
        for (how = 0; how < 3; how++) {
            wl_surface pm = moved(&p, how), qm = moved(&q, how);
            double scale = how == 1 ? 0.375 * 0.375 * 0.375 : 1;
            answer m = combine(&pm, GXB_DIFFERENCE, &qm);
            CHECK_CASE(m.components == a.components, "seed %u, %d: %zu components, were %zu", seed, how, m.components,
                       a.components);
            CHECK_CASE(close_to(m.volume, scale * a.volume, scale * 64), "seed %u, %d: volume %.17g of %.17g", seed,
                       how, m.volume, a.volume);
            surface_free(&pm);
            surface_free(&qm);
        }
        surface_free(&p);
        surface_free(&q);
    }
}
END_TEST

/* A tetrahedron less a random solid, compared with the exact oracle */
START_TEST(random_cuts_beside_the_oracle) {
    unsigned seed;
    for (seed = 1; seed <= 60; seed++) {
        static const int order[4] = {0, 2, 1, 3};
        workload w = wl_empty();
        wl_surface body, *cut;
        oracle *truth;
        answer a;
        int k;
        memset(&body, 0, sizeof body);
        random_state = 2000 + seed;
        add_tetrahedron(&body, 4);
        for (k = 0; k < 4; k++) {
            const double *x = body.vertices + 3 * order[k];
            wl_add_node(&w, x[0], x[1], x[2]);
        }
        wl_add_element(&w, 0, 1, 2, 3);
        cut = wl_add_surface(&w, 1);
        if (random_below(2))
            add_box(cut, 3);
        else
            add_tetrahedron(cut, 4);
        if (random_below(3) == 0) add_tetrahedron(cut, 4);
        truth = wl_oracle(&w);
        a = combine(&body, GXB_DIFFERENCE, cut);
        CHECK_CASE(close_to(a.volume, truth->volume, 64), "seed %u: volume %.17g, should be %.17g", seed, a.volume,
                   truth->volume);
        CHECK_CASE(a.components == truth->fragment_count, "seed %u: %zu components, should be %zu", seed, a.components,
                   truth->fragment_count);
        a = combine(&body, GXB_INTERSECTION, cut);
        CHECK_CASE(close_to(a.volume, wl_removed_volume(truth), 64), "seed %u: common %.17g", seed, a.volume);
        oracle_destroy(truth);
        surface_free(&body);
        wl_free(&w);
    }
}
END_TEST

/* ---- chains ---- */

START_TEST(chains_are_exact) {
    unsigned seed;
    for (seed = 1; seed <= 60; seed++) {
        wl_surface s[6];
        gxb_operand o[6];
        answer once, each;
        size_t i;
        random_state = 3000 + seed;
        for (i = 0; i < 6; i++) {
            s[i] = random_solid(2);
            disturb(&s[i], (int)(seed % 3));
            o[i] = operand_of(&s[i], i == 0 ? (uint32_t)GXB_UNION : (uint32_t)random_below(4));
        }
        once = evaluate(o, 6, 0);
        each = evaluate(o, 6, 1);
        CHECK_CASE(once.components == each.components, "seed %u: %zu components at once, %zu in sequence", seed,
                   once.components, each.components);
        CHECK_CASE(close_to(once.volume, each.volume, 64), "seed %u: volume %.17g at once, %.17g in sequence", seed,
                   once.volume, each.volume);
        for (i = 0; i < 6; i++) surface_free(&s[i]);
    }
}
END_TEST

/* Small solids through one face of a box, each evaluated, then large ones that cross that face between them: the same
   as all at once, where the large ones come first. */
START_TEST(crossings_around_islands) {
    enum { SPIKES = 9, BLADES = 3, ALL = 1 + SPIKES + BLADES };
    static const double low[3] = {-9, -9, -9}, high[3] = {9, 9, 0}, middle[3] = {0, 0, 0};
    wl_surface s[ALL];
    gxb_operand o[ALL], turned[ALL];
    answer each, once;
    int i;
    random_state = 5000 + (uint64_t)_i;
    memset(s, 0, sizeof s);
    wl_add_aligned_box(&s[0], low, high);
    for (i = 1; i <= SPIKES; i++) {
        const double place[3] = {(random_below(1401) - 700) / 100.0, (random_below(1401) - 700) / 100.0, 0};
        add_spike(&s[i], place, 0.7);
    }
    for (; i < ALL; i++) add_spike(&s[i], middle, 16);
    for (i = 0; i < ALL; i++) {
        o[i] = operand_of(&s[i], i == 0 ? GXB_UNION : GXB_DIFFERENCE);
        turned[i == 0 ? 0 : ALL - i] = o[i];
    }
    each = evaluate(o, ALL, 1);
    once = evaluate(turned, ALL, 0);
    CHECK_CASE(each.components == once.components && each.euler == once.euler, "seed %d: %zu components, %ld; %zu, %ld",
               _i, each.components, each.euler, once.components, once.euler);
    CHECK_CASE(close_to(each.volume, once.volume, 3000), "seed %d: volumes %.17g %.17g", _i, each.volume, once.volume);
    for (i = 0; i < ALL; i++) surface_free(&s[i]);
}
END_TEST

/* ---- rules, nesting, sheets ---- */

START_TEST(winding_rules) {
    static const double low[3] = {0, 0, 0}, high[3] = {2, 2, 2}, low2[3] = {1, 1, 1}, high2[3] = {3, 3, 3};
    wl_surface s;
    gxb_operand o;
    answer a;
    memset(&s, 0, sizeof s);
    wl_add_aligned_box(&s, low, high); /* two boxes of one surface, a unit cube in common */
    wl_add_aligned_box(&s, low2, high2);
    o = operand_of(&s, GXB_UNION);
    a = evaluate(&o, 1, 0);
    check_answer("nonzero", &a, 1, 15);
    o.rule = GXB_ODD;
    a = evaluate(&o, 1, 0);
    check_answer("odd", &a, 2, 14);
    o.rule = GXB_NEGATIVE;
    a = evaluate(&o, 1, 0);
    ck_assert_uint_eq(a.triangles, 0);
    o.rule = GXB_POSITIVE;
    a = evaluate(&o, 1, 0);
    check_answer("positive", &a, 1, 15);
    surface_free(&s);
}
END_TEST

START_TEST(cavities_belong_to_their_component) {
    static const double low[3][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, high[3][3] = {{9, 9, 9}, {8, 8, 8}, {7, 7, 7}};
    wl_surface s[3];
    gxb_operand o[3];
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components c;
    int i;
    memset(s, 0, sizeof s);
    for (i = 0; i < 3; i++) {
        wl_add_aligned_box(&s[i], low[i], high[i]);
        o[i] = operand_of(&s[i], i == 1 ? GXB_DIFFERENCE : GXB_UNION);
    }
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i < 3; i++) ck_assert_int_eq(gxb_boolean_add(b, &o[i], NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    c = components_of(b);
    ck_assert_uint_eq(c.count, 2);
    ck_assert(c.volume[0] == 729 - 343 && c.volume[1] == 125);
    ck_assert(c.euler[0] == 4 && c.euler[1] == 2);
    gxb_boolean_destroy(b);
    for (i = 0; i < 3; i++) surface_free(&s[i]);
}
END_TEST

/* A cube with `holes` slots through it is a ball with as many handles; where two slots meet there are three. Two
   that touch in an edge are one. */
static void check_handles(size_t holes, const double low[][3], const double high[][3], long euler) {
    static const double zero[3] = {0, 0, 0}, nine[3] = {9, 9, 9};
    wl_surface s[3];
    gxb_operand o[3];
    answer a;
    size_t i;
    memset(s, 0, sizeof s);
    wl_add_aligned_box(&s[0], zero, nine);
    o[0] = operand_of(&s[0], GXB_UNION);
    for (i = 0; i < holes; i++) {
        wl_add_aligned_box(&s[i + 1], low[i], high[i]);
        o[i + 1] = operand_of(&s[i + 1], GXB_DIFFERENCE);
    }
    a = evaluate(o, holes + 1, 0);
    ck_assert_uint_eq(a.components, 1);
    ck_assert_int_eq(a.euler, euler);
    for (i = 0; i <= holes; i++) surface_free(&s[i]);
}

START_TEST(handles_are_counted) {
    static const double low[2][3] = {{2, 2, -1}, {-1, 5, 5}}, high[2][3] = {{3, 3, 10}, {10, 6, 6}};
    static const double crossing[2][3] = {{2, 2, -1}, {-1, 2, 5}}, across[2][3] = {{3, 3, 10}, {10, 3, 6}};
    static const double beside[2][3] = {{2, 2, -1}, {3, 3, -1}}, touching[2][3] = {{3, 3, 10}, {4, 4, 10}};
    check_handles(0, low, high, 2);
    check_handles(1, low, high, 0);
    check_handles(2, low, high, -2);
    check_handles(2, crossing, across, -4);
    check_handles(2, beside, touching, 0);
}
END_TEST

/* Cubes that share an edge, a corner or a face */
START_TEST(touching_solids) {
    static const double one[3] = {1, 1, 1}, zero[3] = {0, 0, 0}, offset[3][3] = {{1, 1, 0}, {1, 1, 1}, {1, 0, 0}};
    static const size_t components[3] = {2, 2, 1};
    int i, k;
    for (i = 0; i < 3; i++) {
        wl_surface p, q;
        double high[3];
        answer a;
        memset(&p, 0, sizeof p);
        memset(&q, 0, sizeof q);
        for (k = 0; k < 3; k++) high[k] = offset[i][k] + 1;
        wl_add_aligned_box(&p, zero, one);
        wl_add_aligned_box(&q, offset[i], high);
        a = combine(&p, GXB_UNION, &q);
        check_answer("touching", &a, components[i], 2);
        check_balls("touching", &a);
        ck_assert_uint_eq(combine(&p, GXB_INTERSECTION, &q).triangles, 0);
        surface_free(&p);
        surface_free(&q);
    }
}
END_TEST

/* A cube with 216 cavities, each with a core in it: each core is a component of its own, and the cube has all
   cavities, wherever they are. */
START_TEST(cavities_and_cores) {
    enum { SIDE = 6, ALL = SIDE * SIDE * SIDE };
    static const double zero[3] = {0, 0, 0}, far[3] = {64 * SIDE, 64 * SIDE, 64 * SIDE};
    wl_surface s[3];
    gxb_operand o[3];
    gxb_boolean *b;
    gxb_boolean_result r;
    gxb_components c;
    double volume[2] = {0, 0}, cores = 0, whole = 0;
    size_t i, k;
    memset(s, 0, sizeof s);
    random_state = 0x9e3779b97f4a7c15u;
    wl_add_aligned_box(&s[0], zero, far);
    for (i = 0; i < ALL; i++) {
        const size_t at[3] = {i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)};
        double low[2][3], high[2][3], size[2] = {1, 1};
        for (k = 0; k < 3; k++) {
            low[0][k] = 64.0 * (double)at[k] + 1 + random_below(20);
            high[0][k] = 64.0 * (double)at[k] + 63 - random_below(20);
            low[1][k] = low[0][k] + 1 + random_below(5);
            high[1][k] = high[0][k] - 1 - random_below(5);
            size[0] *= high[0][k] - low[0][k];
            size[1] *= high[1][k] - low[1][k];
        }
        for (k = 0; k < 2; k++) {
            wl_add_aligned_box(&s[k + 1], low[k], high[k]);
            volume[k] += size[k];
        }
    }
    for (i = 0; i < 3; i++) o[i] = operand_of(&s[i], i == 1 ? GXB_DIFFERENCE : GXB_UNION);
    b = boolean_of(o, 3, GXB_DIVIDED, 0, 0);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    c = components_of(b);
    ck_assert_uint_eq(c.count, ALL + 1);
    for (i = 0; i < c.count; i++) {
        if (c.euler[i] == 2) {
            cores += c.volume[i];
            continue;
        }
        ck_assert_int_eq(c.euler[i], 2 + 2 * ALL);
        whole = c.volume[i];
    }
    ck_assert(cores == volume[1]);
    ck_assert(whole == far[0] * far[1] * far[2] - volume[0]);
    gxb_boolean_destroy(b);
    for (i = 0; i < 3; i++) surface_free(&s[i]);
}
END_TEST

/* A cube less 16 slabs across x and 16 across y, whose ends lie in common planes: 17 x 17 sticks. Then 16 x 16
   columns on its top, which overlap the sticks inside: all at once, and in any order. */
START_TEST(many_surfaces_at_once) {
    enum { SIDE = 16, WIDE = 64 * SIDE };
    static const double zero[3] = {0, 0, 0}, far[3] = {WIDE, WIDE, WIDE};
    wl_surface s[2 * SIDE + 2];
    gxb_operand o[2 * SIDE + 2];
    answer a;
    size_t i, j;
    memset(s, 0, sizeof s);
    random_state = 0x9e3779b97f4a7c15u * (uint64_t)(_i + 1);
    wl_add_aligned_box(&s[0], zero, far);
    for (i = 0; i < 2 * SIDE; i++) {
        double low[3] = {-1, -1, -1}, high[3] = {WIDE + 1, WIDE + 1, WIDE + 1};
        low[i % 2] = 64.0 * (double)(i / 2) + 28;
        high[i % 2] = low[i % 2] + 8;
        wl_add_aligned_box(&s[i + 1], low, high);
    }
    for (i = 0; i < SIDE; i++)
        for (j = 0; j < SIDE; j++) {
            const double low[3] = {64.0 * (double)i + 40, 64.0 * (double)j + 40, WIDE},
                         high[3] = {low[0] + 8, low[1] + 8, WIDE + 8};
            wl_add_aligned_box(&s[2 * SIDE + 1], low, high);
        }
    for (i = 0; i < 2 * SIDE + 2; i++) o[i] = operand_of(&s[i], i == 0 || i > 2 * SIDE ? GXB_UNION : GXB_DIFFERENCE);
    for (i = 2 * SIDE; i > 1; i--) swap_bytes(&o[i], &o[1 + (size_t)random_below((int)i)], sizeof o[0]);
    a = evaluate(o, 2 * SIDE + 2, _i % 2);
    ck_assert_uint_eq(a.components, (SIDE + 1) * (SIDE + 1));
    ck_assert_int_eq(a.euler, 2 * (SIDE + 1) * (SIDE + 1));
    ck_assert(a.volume == (double)WIDE * (56 * SIDE) * (56 * SIDE) + 512 * SIDE * SIDE);
    for (i = 0; i < 2 * SIDE + 2; i++) surface_free(&s[i]);
}
END_TEST

/* A sheet across a cube divides it; one that ends inside, or floats there, does not. Nothing is lost. Checked for
   each component: the side of the sheet. */
static void check_sides(const wl_surface *cube, const wl_surface *sheet, size_t components) {
    gxb_operand o[2];
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components c;
    size_t i;
    o[0] = operand_of(cube, GXB_UNION);
    o[1] = operand_of(sheet, GXB_SPLIT);
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i < 2; i++) ck_assert_int_eq(gxb_boolean_add(b, &o[i], NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    c = components_of(b);
    ck_assert_uint_eq(c.count, components);
    for (i = 0; i < components; i++) ck_assert(c.side[2 * i] == 0 && (c.side[2 * i + 1] == 0) == (components == 1));
    if (components == 2) ck_assert_int_eq(c.side[1], -c.side[3]);
    for (i = 0; i < r.triangle_count; i++) { /* the sheet faces up: what lies in front of it is above */
        const double z = r.vertices[3 * r.triangles[3 * i] + 2] + r.vertices[3 * r.triangles[3 * i + 1] + 2] +
                         r.vertices[3 * r.triangles[3 * i + 2] + 2];
        const int side = c.side[2 * c.triangle[i] + 1];
        ck_assert(side == 0 || (z - 1.5) * side >= 0);
        ck_assert(side == 0 || r.triangle_operand[i] == 0 || r.triangle_reversed[i] == (side == 1));
    }
    gxb_boolean_destroy(b);
}

START_TEST(sheets_divide) {
    static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    static const double reach[3] = {2, 0.75, 0.75}, start[3] = {-1, -1, 0.25};
    static const size_t components[3] = {2, 1, 1};
    int i;
    for (i = 0; i < 3; i++) {
        const double x0 = start[i], x1 = reach[i], z = 0.5;
        const double a[3] = {x0, x0, z}, b[3] = {x1, x0, z}, c[3] = {x1, x1, z}, d[3] = {x0, x1, z};
        wl_surface cube, sheet;
        answer r;
        memset(&cube, 0, sizeof cube);
        memset(&sheet, 0, sizeof sheet);
        wl_add_aligned_box(&cube, zero, one);
        wl_add_quad(&sheet, a, b, c, d);
        r = combine(&cube, GXB_SPLIT, &sheet);
        check_answer("sheet", &r, components[i], 1);
        ck_assert_uint_gt(r.triangles, 12);
        check_sides(&cube, &sheet, components[i]);
        surface_free(&cube);
        surface_free(&sheet);
    }
}
END_TEST

/* A flat sheet of so many triangles that they are sorted, all at one height */
START_TEST(a_fine_flat_sheet_divides) {
    enum { SIDE = 12 };
    static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    wl_surface cube, sheet;
    answer r;
    int i, j;
    memset(&cube, 0, sizeof cube);
    memset(&sheet, 0, sizeof sheet);
    wl_add_aligned_box(&cube, zero, one);
    for (j = 0; j <= SIDE; j++)
        for (i = 0; i <= SIDE; i++) {
            double x[3];
            x[0] = 0.25 * i - 1;
            x[1] = 0.25 * j - 1;
            x[2] = 0.375;
            wl_add_vertex(&sheet, x);
        }
    for (j = 0; j < SIDE; j++)
        for (i = 0; i < SIDE; i++) {
            const uint32_t v = (uint32_t)(j * (SIDE + 1) + i);
            wl_add_triangle(&sheet, v, v + 1, v + SIDE + 2);
            wl_add_triangle(&sheet, v, v + SIDE + 2, v + SIDE + 1);
        }
    r = combine(&cube, GXB_SPLIT, &sheet);
    check_answer("fine flat sheet", &r, 2, 1);
    surface_free(&cube);
    surface_free(&sheet);
}
END_TEST

/* An operand that is a point, twice: nothing, whatever is done with it */
START_TEST(an_operand_of_one_point_is_nothing) {
    double zeros[9] = {0};
    uint32_t triangles[6] = {0, 1, 2, 0, 2, 1};
    gxb_boolean_desc desc;
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_operand o;
    memset(&desc, 0, sizeof desc);
    memset(&o, 0, sizeof o);
    memset(&r, 0, sizeof r);
    o.vertices = zeros;
    o.vertex_count = 3;
    o.triangles = triangles;
    o.triangle_count = 2;
    o.operation = GXB_UNION;
    ck_assert_int_eq(gxb_boolean_create(&desc, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    ck_assert_uint_eq(r.triangle_count, 0);
    gxb_boolean_destroy(b);
}
END_TEST

/* Its triangles within the cube meet nothing, and occur twice. */
START_TEST(a_wave_divides) {
    static const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    wl_frame axes = wl_axes();
    wl_surface cube, sheet;
    answer r;
    memset(&cube, 0, sizeof cube);
    memset(&sheet, 0, sizeof sheet);
    memset(axes.origin, 0, sizeof axes.origin);
    wl_add_aligned_box(&cube, low, high);
    wl_add_wave(&sheet, &axes, 16, 2);
    r = combine(&cube, GXB_SPLIT, &sheet);
    check_answer("wave", &r, 2, 8);
    surface_free(&cube);
    surface_free(&sheet);
}
END_TEST

/* A closed sheet within a cube: its inside is another component, and the component around it has a cavity, whichever
   of its triangles comes first. */
START_TEST(closed_sheets_divide) {
    static const double zero[3] = {0, 0, 0}, three[3] = {3, 3, 3}, one[3] = {1, 1, 1}, two[3] = {2, 2, 2};
    wl_surface cube, sheet;
    gxb_operand o[2];
    size_t i, k;
    memset(&cube, 0, sizeof cube);
    memset(&sheet, 0, sizeof sheet);
    wl_add_aligned_box(&cube, zero, three);
    wl_add_aligned_box(&sheet, one, two);
    o[0] = operand_of(&cube, GXB_UNION);
    o[1] = operand_of(&sheet, GXB_SPLIT);
    for (i = 0; i < 2 * sheet.triangle_count; i++) {
        uint32_t first[3];
        gxb_boolean *b = NULL;
        gxb_boolean_result r;
        gxb_components c;
        memcpy(first, sheet.triangles, sizeof first);
        memmove(sheet.triangles, sheet.triangles + 3, 3 * (sheet.triangle_count - 1) * sizeof *first);
        memcpy(sheet.triangles + 3 * (sheet.triangle_count - 1), first, sizeof first);
        if (i == sheet.triangle_count) /* from here on inside out */
            for (k = 0; k < sheet.triangle_count; k++) {
                const uint32_t swap = sheet.triangles[3 * k];
                sheet.triangles[3 * k] = sheet.triangles[3 * k + 1];
                sheet.triangles[3 * k + 1] = swap;
            }
        ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
        for (k = 0; k < 2; k++) ck_assert_int_eq(gxb_boolean_add(b, &o[k], NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        c = components_of(b);
        ck_assert_uint_eq(c.count, 2);
        ck_assert(c.volume[0] == 26 && c.volume[1] == 1);
        ck_assert(c.euler[0] == 4 && c.euler[1] == 2);
        ck_assert_int_eq(c.side[1], i < sheet.triangle_count ? 1 : -1);
        ck_assert_int_eq(c.side[3], -c.side[1]);
        gxb_boolean_destroy(b);
    }
    surface_free(&cube);
    surface_free(&sheet);
}
END_TEST

/* ---- provenance ---- */

static const double *corner(const gxb_operand *o, uint32_t operand, size_t triangle, size_t k) {
    return o[operand].vertices + 3 * (size_t)o[operand].triangles[3 * triangle + k % 3];
}

/* Distance of x from a triangle's plane */
static double off_plane(const gxb_operand *o, uint32_t operand, size_t triangle, const double *x) {
    const double *p = corner(o, operand, triangle, 0), *q = corner(o, operand, triangle, 1),
                 *r = corner(o, operand, triangle, 2);
    double u[3], v[3], n[3], d = 0, size = 0;
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = q[k] - p[k];
        v[k] = r[k] - p[k];
    }
    for (k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (k = 0; k < 3; k++) {
        d += n[k] * (x[k] - p[k]);
        size += n[k] * n[k];
    }
    return fabs(d) / sqrt(size);
}

static double off_edge(const gxb_operand *o, uint32_t operand, size_t half_edge, const double *x) {
    const double *p = corner(o, operand, half_edge / 3, half_edge % 3),
                 *q = corner(o, operand, half_edge / 3, half_edge % 3 + 1);
    double u[3], t = 0, size = 0, d = 0;
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = q[k] - p[k];
        t += u[k] * (x[k] - p[k]);
        size += u[k] * u[k];
    }
    for (k = 0; k < 3; k++) {
        const double e = x[k] - p[k] - t / size * u[k];
        d += e * e;
    }
    return sqrt(d);
}

static void check_origin(const gxb_operand *o, const gxb_origin *origin, const double *x) {
    int k;
    switch (origin->kind) {
    case GXB_FROM_VERTEX:
        ck_assert_mem_eq(x, o[origin->operand[0]].vertices + 3 * (size_t)origin->index[0], 3 * sizeof *x);
        break;
    case GXB_FROM_EDGE_TRIANGLE:
        ck_assert(off_edge(o, origin->operand[0], origin->index[0], x) < 1e-13);
        ck_assert(off_plane(o, origin->operand[1], origin->index[1], x) < 1e-13);
        break;
    case GXB_FROM_EDGE_EDGE:
        for (k = 0; k < 2; k++) ck_assert(off_edge(o, origin->operand[k], origin->index[k], x) < 1e-13);
        break;
    default:
        for (k = 0; k < 3; k++) ck_assert(off_plane(o, origin->operand[k], origin->index[k], x) < 1e-13);
    }
}

START_TEST(everything_knows_where_it_comes_from) {
    wl_frame rotated = wl_rotated();
    workload w = wl_sticks(&rotated);
    wl_surface body = boundary_of(&w);
    gxb_operand o[WL_SURFACES + 1];
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    size_t i, kinds[4] = {0, 0, 0, 0};
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i <= w.surface_count; i++) {
        o[i] = operand_of(i == 0 ? &body : &w.surfaces[i - 1], i == 0 ? GXB_UNION : GXB_DIFFERENCE);
        ck_assert_int_eq(gxb_boolean_add(b, &o[i], NULL), GX_OK);
    }
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    for (i = 0; i < r.vertex_count; i++) {
        check_origin(o, &r.vertex_origin[i], r.vertices + 3 * i);
        kinds[r.vertex_origin[i].kind]++;
    }
    ck_assert(kinds[0] == 8 && kinds[1] > 0 && kinds[3] > 0);
    for (i = 0; i < 3 * r.triangle_count; i++)
        ck_assert(off_plane(o, r.triangle_operand[i / 3], r.triangle_source[i / 3],
                            r.vertices + 3 * (size_t)r.triangles[i]) < 1e-13);
    gxb_boolean_destroy(b);
    surface_free(&body);
    wl_free(&w);
}
END_TEST

/* ---- coarse results ---- */

static const uint32_t triangulations[3] = {GXB_DIVIDED, GXB_COARSE, GXB_MERGED};

/* The answer for each way to divide it. Results are read off Booleans that live until the caller destroys them. */
static void divide_all_ways(const gxb_operand *o, size_t count, gxb_boolean *b[3], gxb_boolean_result r[3]) {
    int how;
    for (how = 0; how < 3; how++) {
        b[how] = boolean_of(o, count, triangulations[how], 0, 0);
        ck_assert_int_eq(gxb_boolean_evaluate(b[how], &r[how], NULL), GX_OK);
        check_closed(&r[how]);
    }
}

static void count_ways(const gxb_operand *o, size_t count, size_t coarse, size_t merged) {
    gxb_boolean *b[3];
    gxb_boolean_result r[3];
    int how;
    divide_all_ways(o, count, b, r);
    ck_assert_uint_eq(r[1].triangle_count, coarse);
    ck_assert_uint_eq(r[2].triangle_count, merged);
    for (how = 0; how < 3; how++) gxb_boolean_destroy(b[how]);
}

/* Outlines with n corners and h holes take n + 2 h - 2 triangles. */
START_TEST(faces_in_as_few_triangles_as_possible) {
    static const double low[5][3] = {{0, 0, 0}, {-1, -1, 0.9}, {0.5, 0.75, -1}, {2, 0, 0}, {0, 0, 2}};
    static const double high[5][3] = {{2, 2, 2}, {3, 3, 1.1}, {1, 1.25, 3}, {3, 2, 2}, {2, 2, 5}};
    wl_surface s[5];
    gxb_operand o[5];
    gxb_boolean *b[3];
    gxb_boolean_result r[3];
    size_t i;
    memset(s, 0, sizeof s);
    for (i = 0; i < 5; i++) {
        wl_add_aligned_box(&s[i], low[i], high[i]);
        o[i] = operand_of(&s[i], i == 0 ? GXB_UNION : GXB_DIFFERENCE);
    }
    count_ways(o, 1, 12, 12);
    /* Two boxes. Each side of each is a triangle and a quadrilateral of the cube's triangles; where these meet, the
       slab's face has a fifth to eighth corner. */
    count_ways(o, 2, 2 * (2 + 4 * 3 + 6), 2 * 12);
    /* A square hole through the cube: merged, two faces with a hole, four without, four walls. */
    o[1] = o[2];
    divide_all_ways(o, 2, b, r);
    ck_assert_uint_eq(r[2].triangle_count, 2 * (4 + 4 + 2 - 2) + 4 * 2 + 4 * 2);
    ck_assert_uint_lt(r[2].triangle_count, r[1].triangle_count);
    ck_assert_uint_le(r[1].triangle_count, r[0].triangle_count);
    for (i = 0; i < 3; i++) gxb_boolean_destroy(b[i]);
    /* Boxes side by side and on top of each other: faces that fit disappear, those that meet in one plane become
       one. */
    o[1] = operand_of(&s[3], GXB_UNION);
    count_ways(o, 2, 4 * 4 + 2 * 2, 12);
    o[1] = operand_of(&s[4], GXB_UNION);
    count_ways(o, 2, 4 * 4 + 2 * 2, 12);
    for (i = 0; i < 5; i++) surface_free(&s[i]);
}
END_TEST

static int same_face(const gxb_boolean_result *r, size_t t, size_t u) {
    return r->triangle_operand[t] == r->triangle_operand[u] && r->triangle_source[t] == r->triangle_source[u];
}

/* Is q - p opposite to o - p, but for rounding? */
static int goes_straight(const double *p, const double *o, const double *q) {
    double a[3], c[3], cross[3], size;
    int k;
    for (k = 0; k < 3; k++) {
        a[k] = o[k] - p[k];
        c[k] = q[k] - p[k];
    }
    for (k = 0; k < 3; k++) cross[k] = a[(k + 1) % 3] * c[(k + 2) % 3] - a[(k + 2) % 3] * c[(k + 1) % 3];
    size = sqrt((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
    return a[0] * c[0] + a[1] * c[1] + a[2] * c[2] < 0 &&
           fabs(cross[0]) + fabs(cross[1]) + fabs(cross[2]) < 1e-9 * size;
}

/* Does vertex v end an outline, or does an outline bend or branch there? Counted from the triangles around it alone. */
static int is_needed(const gxb_boolean_result *r, uint32_t v) {
    uint32_t ends[64];
    size_t t, u, n = 0, i;
    for (t = 0; t < r->triangle_count; t++) {
        const uint32_t *p = r->triangles + 3 * t;
        const int k = p[0] == v ? 0 : p[1] == v ? 1 : p[2] == v ? 2 : -1;
        uint32_t to;
        int outline = 0;
        if (k < 0) continue;
        to = p[(k + 1) % 3];
        for (u = 0; u < r->triangle_count; u++) {
            const uint32_t *q = r->triangles + 3 * u;
            const int has_v = q[0] == v || q[1] == v || q[2] == v, has_to = q[0] == to || q[1] == to || q[2] == to;
            outline = outline || (has_v && has_to && !same_face(r, t, u));
        }
        for (i = 0; i < n && ends[i] != to; i++) {}
        if (outline && i == n && n < 64) ends[n++] = to;
    }
    if (n == 0) return 0;
    return n != 2 || !goes_straight(r->vertices + 3 * (size_t)v, r->vertices + 3 * (size_t)ends[0],
                                    r->vertices + 3 * (size_t)ends[1]);
}

/* Exactly: no triangle of a result without area or turned over */
static void check_triangles(gxb_boolean *b) {
    uint32_t t;
    for (t = 0; t < b->out.triangle_count; t++)
        ck_assert_int_eq(gxbp_plane_turn(b, gxbp_out_plane(b, t), gxbp_out_corner(b, t, 0), gxbp_out_corner(b, t, 1),
                                         gxbp_out_corner(b, t, 2)),
                         b->out.subtriangles[t] & 1 ? -1 : 1);
}

/* Does each edge belong to two triangles? */
static int is_manifold(const gxb_boolean_result *r) {
    size_t i, j;
    for (i = 0; i < 3 * r->triangle_count; i++) {
        const uint32_t p = r->triangles[i], q = r->triangles[i % 3 == 2 ? i - 2 : i + 1];
        size_t same = 0;
        for (j = 0; j < 3 * r->triangle_count; j++)
            same += r->triangles[j] == p && r->triangles[j % 3 == 2 ? j - 2 : j + 1] == q;
        if (same > 1) return 0;
    }
    return 1;
}

static void check_ways(const gxb_operand *o, size_t count, const char *name, unsigned seed) {
    gxb_boolean *b[3];
    gxb_boolean_result r[3];
    gxb_components c[3];
    uint32_t v;
    size_t t, gone;
    int how;
    divide_all_ways(o, count, b, r);
    c[0] = components_of(b[0]);
    for (how = 1; how < 3; how++) {
        const double size = c[0].total_volume + 1;
        c[how] = components_of(b[how]);
        CHECK_CASE(close_to(c[how].total_volume, c[0].total_volume, size), "%s %u: volume %.17g, was %.17g", name, seed,
                   c[how].total_volume, c[0].total_volume);
        CHECK_CASE(c[how].count == c[0].count, "%s %u: %zu components", name, seed, c[how].count);
        /* The Euler characteristic of the surface is the same: two triangles go with each vertex, more where more
           than two meet in an edge. */
        gone = 2 * (r[0].vertex_count - r[how].vertex_count);
        CHECK_CASE(r[0].triangle_count - r[how].triangle_count == gone ||
                       (!is_manifold(&r[0]) && r[0].triangle_count - r[how].triangle_count > gone),
                   "%s %u: %zu triangles of %zu, %zu vertices of %zu", name, seed, r[how].triangle_count,
                   r[0].triangle_count, r[how].vertex_count, r[0].vertex_count);
        check_triangles(b[how]);
    }
    for (v = 0; v < r[1].vertex_count; v++)
        CHECK_CASE(is_needed(&r[1], v), "%s %u: vertex %u is needless", name, seed, v);
    for (t = 0; t < 3 * r[1].triangle_count; t++)
        ck_assert(off_plane(o, r[1].triangle_operand[t / 3], r[1].triangle_source[t / 3],
                            r[1].vertices + 3 * (size_t)r[1].triangles[t]) < 1e-10);
    ck_assert_uint_le(r[2].triangle_count, r[1].triangle_count);
    for (how = 0; how < 3; how++) gxb_boolean_destroy(b[how]);
}

START_TEST(coarse_results_are_the_same_solids) {
    static const uint32_t operations[5] = {GXB_UNION, GXB_INTERSECTION, GXB_DIFFERENCE, GXB_SYMMETRIC_DIFFERENCE,
                                           GXB_SPLIT};
    unsigned seed;
    int i;
    for (seed = 1; seed <= 80; seed++) {
        wl_surface s[3];
        gxb_operand o[3];
        random_state = 7000 + seed;
        for (i = 0; i < 3; i++) {
            s[i] = random_solid(2);
            disturb(&s[i], (int)(seed % 3));
            o[i] = operand_of(&s[i], i == 0 ? (uint32_t)GXB_UNION : operations[random_below(5)]);
        }
        check_ways(o, 3, "seed", seed);
        for (i = 0; i < 3; i++) surface_free(&s[i]);
    }
}
END_TEST

START_TEST(coarse_sticks) {
    wl_frame rotated = wl_rotated();
    workload w = wl_sticks(&rotated);
    wl_surface body = boundary_of(&w);
    gxb_operand o[WL_SURFACES + 1];
    size_t i;
    o[0] = operand_of(&body, GXB_UNION);
    for (i = 0; i < w.surface_count; i++) o[i + 1] = operand_of(&w.surfaces[i], GXB_DIFFERENCE);
    check_ways(o, w.surface_count + 1, "sticks", 0);
    surface_free(&body);
    wl_free(&w);
}
END_TEST

/* ---- rounding ---- */

/* In rationals: does the rounded triangle face along its source's, less than a right angle off? */
static int is_upright(const gxb_operand *o, const gxb_boolean_result *r, size_t t) {
    const rat_mark mark = rat_arena_mark();
    const uint32_t *v = r->triangles + 3 * t;
    big n[2][3], u[3], w[3];
    int sign;
    big_difference(corner(o, r->triangle_operand[t], r->triangle_source[t], 1),
                   corner(o, r->triangle_operand[t], r->triangle_source[t], 0), u);
    big_difference(corner(o, r->triangle_operand[t], r->triangle_source[t], 2),
                   corner(o, r->triangle_operand[t], r->triangle_source[t], 0), w);
    big_cross(u, w, n[0]);
    big_difference(r->vertices + 3 * (size_t)v[1], r->vertices + 3 * (size_t)v[0], u);
    big_difference(r->vertices + 3 * (size_t)v[2], r->vertices + 3 * (size_t)v[0], w);
    big_cross(u, w, n[1]);
    sign = big_sign(big_dot(n[0], n[1])) * (r->triangle_reversed[t] ? -1 : 1);
    rat_arena_release(mark);
    return sign > 0;
}

/* Evaluates as requested. The listed defects are the true ones. Volumes and topology go to *a. */
static size_t find_defects(const gxb_operand *o, size_t count, int fine, int mend, answer *a, size_t *mended) {
    gxb_boolean *b = boolean_of(o, count, GXB_DIVIDED, fine, mend);
    gxb_boolean_result r;
    gxb_defects d;
    size_t i, listed = 0;
    *a = read_answer(b);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    d = defects_of(b);
    for (i = 0; i < r.triangle_count; i++) {
        const int defect = listed < d.count && d.triangles[listed] == i;
        ck_assert_int_eq(is_upright(o, &r, i), !defect);
        listed += (size_t)defect;
    }
    ck_assert_uint_eq(listed, d.count);
    *mended = d.mended_count;
    gxb_boolean_destroy(b);
    return listed;
}

/* Adds the effects of rounding on a workload, kept or removed, to sum: defects by fine, defects left by mend */
static void mend_workload(const char *name, workload w, int removed, size_t sum[2]) {
    gxb_operand o[WL_SURFACES + 1];
    wl_surface body = boundary_of(&w);
    const size_t n = w.surface_count;
    size_t i, found, left, mended;
    answer a, m;
    for (i = 0; i < n; i++) o[removed ? i : i + 1] = operand_of(&w.surfaces[i], removed ? GXB_UNION : GXB_DIFFERENCE);
    o[removed ? n : 0] = operand_of(&body, removed ? GXB_INTERSECTION : GXB_UNION);
    find_defects(o, n + 1, 0, 0, &a, &mended);
    found = find_defects(o, n + 1, 1, 0, &a, &mended);
    ck_assert_uint_eq(mended, 0);
    left = find_defects(o, n + 1, 0, 1, &m, &mended);
    CHECK_CASE(left + mended == found, "%s: %zu defects, %zu mended, %zu left", name, found, mended, left);
    CHECK_CASE(m.euler == a.euler && m.components == a.components && m.volume == a.volume && m.triangles <= a.triangles,
               "%s: mended, it is another", name);
    sum[0] += found;
    sum[1] += left;
    surface_free(&body);
    wl_free(&w);
}

/* A ball of around x down faces */
static wl_surface ball_of(const double middle[3], double radius, size_t around, size_t down) {
    wl_surface s;
    size_t i, j, k;
    s.vertex_count = around * (down - 1) + 2;
    s.triangle_count = 2 * around * (down - 1);
    s.vertices = (double *)malloc(3 * s.vertex_count * sizeof *s.vertices);
    s.triangles = (uint32_t *)malloc(3 * s.triangle_count * sizeof *s.triangles);
    for (i = 0; i < s.vertex_count; i++) {
        const double pi = 3.14159265358979323846, low = i + 1 == s.vertex_count ? pi
                                                      : i == 0                  ? 0
                                                               : pi * (double)(1 + (i - 1) / around) / (double)down;
        const double turn = 2 * pi * (double)((i + around - 1) % around) / (double)around;
        s.vertices[3 * i] = middle[0] + radius * sin(low) * cos(turn);
        s.vertices[3 * i + 1] = middle[1] + radius * sin(low) * sin(turn);
        s.vertices[3 * i + 2] = middle[2] + radius * cos(low);
    }
    for (i = 0, k = 0; i < around; i++) {
        const uint32_t n = (uint32_t)around, a = 1 + (uint32_t)i, b = 1 + (uint32_t)((i + 1) % around),
                       end = (uint32_t)s.vertex_count - 1;
        const uint32_t caps[6] = {0, a, b, end, b + n * ((uint32_t)down - 2), a + n * ((uint32_t)down - 2)};
        memcpy(s.triangles + k, caps, sizeof caps);
        for (k += 6, j = 0; j + 2 < down; j++, k += 6) {
            const uint32_t p = a + n * (uint32_t)j, q = b + n * (uint32_t)j, sides[6] = {p, p + n, q + n, p, q + n, q};
            memcpy(s.triangles + k, sides, sizeof sides);
        }
    }
    return s;
}

/* A ball of 9 x 6 faces around a random place near 0 */
static wl_surface random_ball(double radius) {
    double middle[3];
    int k;
    for (k = 0; k < 3; k++) middle[k] = (random_below(2001) - 1000) / 1000.0;
    return ball_of(middle, radius, 9, 6);
}

static double dot_of(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Distance of a point from the triangle of an operand, by doubles */
static double distance_from(const gxb_operand *o, uint32_t triangle, const double x[3]) {
    const double *p[3];
    double least = HUGE_VAL, normal[3], edge[3][3], off[3][3], inward[3];
    int inside = 1, i, k;
    for (i = 0; i < 3; i++) p[i] = o->vertices + 3 * o->triangles[3 * triangle + (uint32_t)i];
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) {
            edge[i][k] = p[(i + 1) % 3][k] - p[i][k];
            off[i][k] = x[k] - p[i][k];
        }
    for (k = 0; k < 3; k++)
        normal[k] = edge[0][(k + 1) % 3] * edge[1][(k + 2) % 3] - edge[0][(k + 2) % 3] * edge[1][(k + 1) % 3];
    for (i = 0; i < 3; i++) {
        const double along = fmax(0, fmin(1, dot_of(off[i], edge[i]) / dot_of(edge[i], edge[i])));
        double away[3];
        for (k = 0; k < 3; k++) away[k] = off[i][k] - along * edge[i][k];
        least = fmin(least, sqrt(dot_of(away, away)));
        for (k = 0; k < 3; k++)
            inward[k] = normal[(k + 1) % 3] * edge[i][(k + 2) % 3] - normal[(k + 2) % 3] * edge[i][(k + 1) % 3];
        inside &= dot_of(inward, off[i]) > 0;
    }
    return inside ? fmin(least, fabs(dot_of(normal, off[0])) / sqrt(dot_of(normal, normal))) : least;
}

/* A ball less others, one after the other, each result mended and used for the next. Mending moves the surface no
   further than rounding does, and leaves no triangle beyond its source. */
START_TEST(mending_keeps_volumes) {
    wl_surface a;
    int step;
    random_state = 0x9e3779b97f4a7c15u * (uint64_t)(_i + 1);
    a = random_ball(1);
    for (step = 0; step < 8 && a.triangle_count > 0 && a.triangle_count < 3000; step++) {
        wl_surface ball = random_ball(0.3 + random_below(401) / 1000.0), next;
        gxb_operand o[2];
        gxb_boolean *b;
        gxb_boolean_result r;
        double sum = 0, away = 0, volume;
        size_t t;
        o[0] = operand_of(&a, GXB_UNION);
        o[1] = operand_of(&ball, GXB_DIFFERENCE);
        b = boolean_of(o, 2, GXB_DIVIDED, 0, 1);
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        for (t = 0; t < r.triangle_count; t++) {
            const double *p = r.vertices + 3 * r.triangles[3 * t], *q = r.vertices + 3 * r.triangles[3 * t + 1],
                         *s = r.vertices + 3 * r.triangles[3 * t + 2];
            sum += (p[0] * (q[1] * s[2] - q[2] * s[1]) - p[1] * (q[0] * s[2] - q[2] * s[0]) +
                    p[2] * (q[0] * s[1] - q[1] * s[0])) /
                   6;
            away = fmax(away, distance_from(&o[r.triangle_operand[t]], r.triangle_source[t], p));
            away = fmax(away, distance_from(&o[r.triangle_operand[t]], r.triangle_source[t], q));
            away = fmax(away, distance_from(&o[r.triangle_operand[t]], r.triangle_source[t], s));
        }
        CHECK_CASE(away <= 1e-14, "seed %d, step %d: a triangle %g beyond its source", _i, step, away);
        volume = components_of(b).total_volume;
        CHECK_CASE(fabs(sum - volume) <= 1e-10, "seed %d, step %d: volume %.17g, by its triangles %.17g", _i, step,
                   volume, sum);
        next.vertex_count = r.vertex_count;
        next.triangle_count = r.triangle_count;
        next.vertices = (double *)malloc((3 * r.vertex_count + 1) * sizeof *next.vertices);
        next.triangles = (uint32_t *)malloc((3 * r.triangle_count + 1) * sizeof *next.triangles);
        memcpy(next.vertices, r.vertices, 3 * r.vertex_count * sizeof *next.vertices);
        memcpy(next.triangles, r.triangles, 3 * r.triangle_count * sizeof *next.triangles);
        gxb_boolean_destroy(b);
        surface_free(&a);
        surface_free(&ball);
        a = next;
    }
    surface_free(&a);
}
END_TEST

/* Six times a surface's volume, exactly */
static big exact_volume_of(const wl_surface *s) {
    big sum = big_zero();
    size_t t;
    int k;
    for (t = 0; t < s->triangle_count; t++) {
        big x[3][3];
        for (k = 0; k < 3; k++) big_vector(s->vertices + 3 * (size_t)s->triangles[3 * t + (size_t)k], x[k]);
        sum = big_add(sum, big_det3(x[0], x[1], x[2]));
    }
    return sum;
}

/* The volume of each component is that of one wall, each wall has one, and all have two sides. */
static void check_walls(const gxb_operand *o, const double *wall, size_t walls, int fine) {
    gxb_boolean *b = boolean_of(o, 2 * walls, GXB_DIVIDED, fine, 0);
    gxb_boolean_result r;
    gxb_components c;
    size_t i, j;
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    c = components_of(b);
    CHECK_CASE(c.count == walls, "%zu components", c.count);
    for (i = 0; i < walls; i++) {
        size_t same = 0;
        ck_assert_int_eq(c.euler[i], 4);
        for (j = 0; j < c.count; j++) same += fabs(c.volume[j] - wall[i]) <= (fine ? 1e-15 : 1e-7) * wall[i];
        CHECK_CASE(same == 1, "wall %zu: volume %g, %g or %g instead of %g", i, c.volume[0], c.volume[1], c.volume[2],
                   wall[i]);
    }
    gxb_boolean_destroy(b);
}

/* Three hollow balls, one in the other, with walls four units of the last place thick. All six shells have nearly
   one volume; the walls' volumes are some 1e-15 of it. Triangles and shells come in any order. */
START_TEST(walls_of_a_few_units) {
    enum { SHELLS = 6 };
    static const double zero[3] = {0, 0, 0};
    const rat_mark mark = rat_arena_mark();
    wl_surface s[SHELLS];
    gxb_operand o[SHELLS];
    big volume[SHELLS];
    double wall[SHELLS / 2];
    size_t i, k;
    random_state = 0x9e3779b97f4a7c15u * (uint64_t)(_i + 1);
    for (i = 0; i < SHELLS; i++) {
        s[i] = ball_of(zero, 1, 24, 13);
        for (k = 0; k < 3 * s[i].vertex_count; k++)
            s[i].vertices[k] = i == 0 ? s[i].vertices[k] * (1 + random_below(100) * 1e-4)
                                      : s[0].vertices[k] * (1 - (double)i * 0x1p-51);
        for (k = s[i].triangle_count - 1; k > 0; k--)
            swap_bytes(s[i].triangles + 3 * k, s[i].triangles + 3 * (size_t)random_below((int)k + 1),
                       3 * sizeof(uint32_t));
        volume[i] = exact_volume_of(&s[i]);
        o[i] = operand_of(&s[i], GXB_SYMMETRIC_DIFFERENCE);
    }
    for (i = 0; i < SHELLS / 2; i++) wall[i] = big_to_double(big_sub(volume[2 * i], volume[2 * i + 1])) / 6;
    for (i = SHELLS - 1; i > 0; i--) swap_bytes(&o[i], &o[random_below((int)i + 1)], sizeof o[0]);
    check_walls(o, wall, SHELLS / 2, 0);
    check_walls(o, wall, SHELLS / 2, 1);
    for (i = 0; i < SHELLS; i++) surface_free(&s[i]);
    rat_arena_release(mark);
}
END_TEST

/* Each of the hard slabs, and the slabs through one tetrahedron and a ring, can be rounded without any defect. */
START_TEST(rounding_is_mended) {
    size_t sum[2] = {0, 0}, pieces;
    const char *name;
    int removed, i;
    for (removed = 0; removed < 2; removed++) {
        for (i = 0; i < WL_HARD; i++) {
            workload w = wl_hard(i, &name, &pieces);
            mend_workload(name, w, removed, sum);
        }
        mend_workload("W1", wl_through(1e-4), removed, sum);
        mend_workload("W2", wl_ring_cut(6), removed, sum);
        mend_workload("W2f", wl_ring_cut(5), removed, sum);
    }
    ck_assert_uint_gt(sum[0], 0);
    ck_assert_uint_eq(sum[1], 0);
}
END_TEST

/* What was asked for before leaves no trace: one Boolean whose results are read off in all ways, there and back, gives
 * those of new ones. */
START_TEST(read_off_in_all_ways) {
    enum { WAYS = 12 };
    wl_frame rotated = wl_rotated();
    workload w = wl_sticks(&rotated);
    wl_surface body = boundary_of(&w);
    gxb_operand o[WL_SURFACES + 1];
    gxb_boolean *all;
    size_t mended = 0, i;
    int turn;
    o[0] = operand_of(&body, GXB_UNION);
    for (i = 0; i < w.surface_count; i++) o[i + 1] = operand_of(&w.surfaces[i], GXB_DIFFERENCE);
    all = boolean_of(o, w.surface_count + 1, GXB_DIVIDED, 0, 0);
    for (turn = 0; turn < 2 * WAYS; turn++) {
        const int way = turn < WAYS ? turn : 2 * WAYS - 1 - turn, fine = way / 3 % 2, mend = way / 6;
        gxb_boolean *fresh = boolean_of(o, w.surface_count + 1, triangulations[way % 3], fine, mend);
        gxb_boolean_result r[2];
        gxb_components c[2];
        gxb_defects d[2];
        ck_assert_int_eq(gxb_boolean_set_triangulation(all, triangulations[way % 3], NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_fine(all, fine, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_mend(all, mend, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(all, &r[0], NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_evaluate(fresh, &r[1], NULL), GX_OK);
        c[0] = components_of(all);
        c[1] = components_of(fresh);
        d[0] = defects_of(all);
        d[1] = defects_of(fresh);
        CHECK_CASE(r[0].vertex_count == r[1].vertex_count && r[0].triangle_count == r[1].triangle_count &&
                       c[0].count == c[1].count && d[0].count == d[1].count && d[0].mended_count == d[1].mended_count,
                   "way %d: other counts", way);
        ck_assert_mem_eq(r[0].vertices, r[1].vertices, 3 * r[0].vertex_count * sizeof(double));
        ck_assert_mem_eq(r[0].triangles, r[1].triangles, 3 * r[0].triangle_count * sizeof(uint32_t));
        ck_assert_mem_eq(c[0].volume, c[1].volume, c[0].count * sizeof(double));
        if (mend)
            mended += d[0].mended_count;
        else
            ck_assert_uint_eq(d[0].mended_count, 0);
        gxb_boolean_destroy(fresh);
    }
    ck_assert_uint_gt(mended, 0);
    gxb_boolean_destroy(all);
    surface_free(&body);
    wl_free(&w);
}
END_TEST

/* Many slivers side by side: nearly all of them */
START_TEST(rounded_sticks_are_mended) {
    wl_frame rotated = wl_rotated();
    size_t sum[2] = {0, 0};
    int removed;
    for (removed = 0; removed < 2; removed++) mend_workload("W4r", wl_sticks(&rotated), removed, sum);
    CHECK_CASE(sum[0] >= 30 && sum[1] == 0, "%zu defects of %zu left", sum[1], sum[0]);
}
END_TEST

/* ---- surfaces that are not vouched for ---- */

/* A prism over a star polygon with five corners, from corner to corner by step: 1 a pentagon, 2 a pentagram. */
static wl_surface star_prism(uint32_t step) {
    wl_surface s;
    uint32_t i;
    memset(&s, 0, sizeof s);
    for (i = 0; i < 12; i++) {
        const double turn = 2 * 3.14159265358979323846 * (i % 6) / 5, z = i < 6 ? -1 : 1;
        const double x[3] = {i % 6 == 5 ? 0 : cos(turn), i % 6 == 5 ? 0 : sin(turn), z};
        wl_add_vertex(&s, x);
    }
    for (i = 0; i < 5; i++) {
        const uint32_t j = (i + step) % 5;
        wl_add_triangle(&s, 5, j, i);
        wl_add_triangle(&s, 11, i + 6, j + 6);
        wl_add_triangle(&s, i, j, j + 6);
        wl_add_triangle(&s, i, j + 6, i + 6);
    }
    return s;
}

/* A ball around 0 */
static void add_ball(wl_surface *s, double radius) {
    static const double zero[3] = {0, 0, 0};
    wl_surface ball = ball_of(zero, radius, 9, 6);
    const uint32_t first = (uint32_t)s->vertex_count;
    size_t i;
    for (i = 0; i < ball.vertex_count; i++) wl_add_vertex(s, ball.vertices + 3 * i);
    for (i = 0; i < ball.triangle_count; i++)
        wl_add_triangle(s, first + ball.triangles[3 * i], first + ball.triangles[3 * i + 1],
                        first + ball.triangles[3 * i + 2]);
    surface_free(&ball);
}

/* Was the surface found simple? As a sheet it is searched for crossings; as a closed surface it may be a star. */
static int found_simple(const wl_surface *s, uint32_t operation, int *star, double *volume) {
    gxb_operand o = operand_of(s, operation);
    gxb_boolean *b = boolean_of(&o, 1, GXB_DIVIDED, 1, 0);
    gxb_boolean_result r;
    int simple;
    *star = gxbp_is_star(b, &b->in.operands[0]);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    simple = (int)b->in.operands[0].simple;
    if (operation != GXB_SPLIT) *volume = components_of(b).total_volume;
    gxb_boolean_destroy(b);
    return simple;
}

static int check_star(const wl_surface *s, double *volume) {
    int star, never;
    const int searched = found_simple(s, GXB_SPLIT, &never, volume), found = found_simple(s, GXB_UNION, &star, volume);
    ck_assert(!never && found == searched && (!star || searched));
    return star;
}

/* A ball whose surface goes twice around its axis, with two radii: it crosses itself. Moved along x */
static wl_surface twice_around(size_t down, double along) {
    static const double zero[3] = {0, 0, 0};
    wl_surface s = ball_of(zero, 1, 2 * down, down);
    size_t i;
    for (i = 0; i < s.vertex_count; i++) {
        double *x = s.vertices + 3 * i;
        const double turn = atan2(x[1], x[0]), wide = hypot(x[0], x[1]), r = 1 + 0.2 * wide * cos(turn);
        x[0] = r * wide * cos(2 * turn) + along;
        x[1] = r * wide * sin(2 * turn) + 0.013 * (along > 0);
        x[2] *= r;
    }
    return s;
}

/* Who vouches for surfaces that cross themselves gets an error or a result, never a crash. */
START_TEST(broken_promises) {
    size_t down, refused = 0;
    for (down = 8; down <= 44; down += 4) {
        wl_surface s[2];
        gxb_operand operands[2];
        gxb_boolean *b;
        gxb_boolean_result r;
        gx_failure failure;
        gx_result result;
        size_t i;
        for (i = 0; i < 2; i++) {
            s[i] = twice_around(down, 0.5 * (double)i);
            operands[i] = operand_of(&s[i], i == 0 ? GXB_UNION : GXB_DIFFERENCE);
            operands[i].simple = 1;
        }
        b = boolean_of(operands, 2, GXB_DIVIDED, 0, 0);
        result = gxb_boolean_evaluate(b, &r, &failure);
        ck_assert(result == GX_OK || (result == GX_ERROR_OVERLAP && strcmp(failure.field, "simple") == 0));
        refused += result != GX_OK;
        gxb_boolean_destroy(b);
        for (i = 0; i < 2; i++) surface_free(&s[i]);
    }
    ck_assert_uint_gt(refused, 0);
}
END_TEST

/* What the middle of a surface sees all of does not cross itself, if the surface winds around it once. */
START_TEST(stars_are_simple) {
    int i, stars = 0, cases = 300;
    double volume, pentagon = 0;
    wl_surface s = star_prism(1);
    ck_assert(check_star(&s, &pentagon));
    surface_free(&s);
    s = star_prism(2);
    ck_assert(!check_star(&s, &volume)); /* seen from its middle, but it winds twice */
    ck_assert(volume > 0 && volume < pentagon);
    surface_free(&s);
    random_state = 37;
    for (i = 0; i < cases; i++) {
        size_t v, k, n;
        memset(&s, 0, sizeof s);
        add_ball(&s, 1);
        for (v = 0; v < s.vertex_count; v++) {
            const double factor = i % 3 == 0 ? 1 + 0.5 * random_below(1000) / 1000.0 : 1;
            for (k = 0; k < 3; k++) s.vertices[3 * v + k] *= factor;
        }
        for (n = i % 3 == 1 ? 1 + (size_t)random_below(3) : 0; n > 0; n--) { /* moves some out of their order */
            double *x = s.vertices + 3 * (size_t)random_below((int)s.vertex_count);
            for (k = 0; k < 3; k++) x[k] = (random_below(201) - 100) / 100.0;
        }
        if (i % 3 == 2) add_ball(&s, random_below(2) ? 1 : 0.5); /* the same again, or one inside */
        for (v = 0; i % 2 == 1 && v < s.triangle_count; v++)
            swap_bytes(&s.triangles[3 * v], &s.triangles[3 * v + 1], sizeof *s.triangles);
        k = (size_t)check_star(&s, &volume);
        ck_assert(i % 3 == 1 || k == (i % 3 == 0));
        stars += (int)k;
        surface_free(&s);
    }
    ck_assert(stars > cases / 3 && stars < cases);
}
END_TEST

/* ---- memory and bad input ---- */

/* Of the allocations each so many-th fails. */
#ifndef STRIDE
#define STRIDE 1
#endif

/* Create, and for each operand: add, evaluate, components, defects */
static gx_result make_call(int i, const gxb_boolean_desc *desc, const gxb_operand *o, gxb_boolean **b) {
    gxb_boolean_result r;
    gxb_components c;
    gxb_defects d;
    if (i < 0) return gxb_boolean_create(desc, b, NULL);
    if (i % 4 == 0) return gxb_boolean_add(*b, &o[i / 4], NULL);
    if (i % 4 == 1) return gxb_boolean_evaluate(*b, &r, NULL);
    return i % 4 == 2 ? gxb_boolean_components(*b, &c, NULL) : gxb_boolean_defects(*b, &d, NULL);
}

/* Adds the operands, evaluates after each, and gets everything. A call that fails is made again, and then succeeds. */
static answer despite_failures(memory *m, const gxb_operand *o, int count, uint32_t triangulation, int mend,
                               int *failed) {
    gxb_boolean_desc desc;
    gxb_boolean *b = NULL;
    gx_result result;
    answer a;
    int i;
    memset(&desc, 0, sizeof desc);
    m->grows = m->from_then_on;
    desc.allocator = allocator_of(m);
    desc.memory_limit = (size_t)1 << 19; /* so little that each array is an allocation of its own */
    *failed = 0;
    for (i = -1; i < 4 * count; i++) {
        for (;;) {
            result = make_call(i, &desc, o, &b);
            if (result == GX_OK) break;
            ck_assert_int_eq(result, GX_ERROR_MEMORY);
            ck_assert(m->fail_at != SIZE_MAX);
            *failed = 1;
            never_fail(m);
        }
        if (i >= 0) continue;
        ck_assert_int_eq(gxb_boolean_set_triangulation(b, triangulation, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_fine(b, mend, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_set_mend(b, mend, NULL), GX_OK);
    }
    never_fail(m);
    a = read_answer(b);
    gxb_boolean_destroy(b);
    ck_assert(is_whole(m));
    return a;
}

START_TEST(memory_runs_out) {
    static const double low[3][3] = {{0, 0, 0}, {1, -1, 0}, {-1, 1, 1}}, high[3][3] = {{3, 3, 3}, {2, 4, 3}, {4, 2, 2}};
    wl_surface s[3];
    gxb_operand o[3];
    size_t n;
    int i, failed = 1;
    memset(s, 0, sizeof s);
    for (i = 0; i < 3; i++) {
        wl_add_aligned_box(&s[i], low[i], high[i]);
        o[i] = operand_of(&s[i], i == 0 ? GXB_UNION : GXB_DIFFERENCE);
    }
    for (i = 0; i < 2; i++)
        for (n = 0, failed = 1; failed; n += STRIDE) {
            memory m = plenty();
            answer a;
            fail_from(&m, n, i);
            a = despite_failures(&m, o, 3, GXB_COARSE, 0, &failed);
            check_answer("after a failure", &a, 2, 27 - 9 - 2);
            ck_assert_uint_lt(n, 5000 * STRIDE);
        }
    for (i = 0; i < 3; i++) surface_free(&s[i]);
}
END_TEST

/* Each allocation fails, once and from then on. The answers are those without a failure; triangles may
   come in another order. */
static void sweep_failures(const char *name, const gxb_operand *o, int count, uint32_t triangulation, int mend) {
    memory m = plenty();
    int failed = 1, from_then_on;
    const answer truth = despite_failures(&m, o, count, triangulation, mend, &failed);
    static size_t sweeps;
    size_t n;
    for (from_then_on = 0; from_then_on < 2; from_then_on++)
        for (n = 5 * sweeps++ % STRIDE, failed = 1; failed; n += FEWER * STRIDE) {
            answer a;
            fail_from(&m, n, from_then_on);
            a = despite_failures(&m, o, count, triangulation, mend, &failed);
            CHECK_CASE(a.euler == truth.euler && a.components == truth.components && a.triangles == truth.triangles &&
                           a.defects == truth.defects && fabs(a.volume - truth.volume) <= 1e-14 * truth.volume,
                       "%s, triangulation %u, allocation %zu: another answer", name, (unsigned)triangulation, n);
        }
}

/* Memory runs out while defects are mended and volumes are computed again, in all triangulations */
START_TEST(memory_runs_out_late) {
    static const int hard[3] = {8, 13, 16}; /* P12, C3, C14 */
    int i, removed, k;
    for (i = 0; i < 4; i++)
        for (removed = 0; removed < 2; removed++) {
            const char *name = "W2f";
            size_t pieces, n, j;
            workload w = i < 3 ? wl_hard(hard[i], &name, &pieces) : wl_ring_cut(5);
            wl_surface body = boundary_of(&w);
            gxb_operand o[WL_SURFACES + 1];
            n = w.surface_count;
            for (j = 0; j < n; j++)
                o[removed ? j : j + 1] = operand_of(&w.surfaces[j], removed ? GXB_UNION : GXB_DIFFERENCE);
            o[removed ? n : 0] = operand_of(&body, removed ? GXB_INTERSECTION : GXB_UNION);
            for (k = 0; k < 3; k++) sweep_failures(name, o, (int)n + 1, triangulations[k], 1);
            surface_free(&body);
            wl_free(&w);
        }
}
END_TEST

/* ... and while it lists states, of which there are more than a few: of six boxes along a diagonal any neighbours meet
 */
START_TEST(memory_runs_out_of_states) {
    enum { BOXES = 6 };
    wl_surface s[BOXES];
    gxb_operand o[BOXES];
    int i, k;
    memset(s, 0, sizeof s);
    for (i = 0; i < BOXES; i++) {
        double low[3], high[3];
        for (k = 0; k < 3; k++) {
            low[k] = i;
            high[k] = i + BOXES + 0.5;
        }
        wl_add_aligned_box(&s[i], low, high);
        o[i] = operand_of(&s[i], GXB_SYMMETRIC_DIFFERENCE);
    }
    sweep_failures("boxes", o, BOXES, GXB_COARSE, 0);
    for (i = 0; i < BOXES; i++) surface_free(&s[i]);
}
END_TEST

START_TEST(memory_limit) {
    workload w = wl_wavy(1);
    wl_surface body = boundary_of(&w);
    gxb_operand o[2];
    gxb_boolean_desc desc;
    gxb_boolean_result r;
    gxb_components c;
    gxb_statistics s;
    size_t limit, refused = 0;
    int i;
    o[0] = operand_of(&body, GXB_UNION);
    o[1] = operand_of(&w.surfaces[0], GXB_DIFFERENCE);
    memset(&s, 0, sizeof s);
    memset(&desc, 0, sizeof desc);
    desc.memory_limit = 100; /* not even the Boolean itself */
    {
        gxb_boolean *b = NULL;
        ck_assert_int_eq(gxb_boolean_create(&desc, &b, NULL), GX_ERROR_LIMIT);
        ck_assert(b == NULL);
    }
    for (limit = 1 << 12; limit <= 1 << 23; limit *= 2) {
        gxb_boolean *b = NULL;
        gx_result result = GX_OK;
        memset(&desc, 0, sizeof desc);
        desc.memory_limit = limit;
        ck_assert_int_eq(gxb_boolean_create(&desc, &b, NULL), GX_OK);
        for (i = 0; i < 2 && result == GX_OK; i++) result = gxb_boolean_add(b, &o[i], NULL);
        if (result == GX_OK) result = gxb_boolean_evaluate(b, &r, NULL);
        if (result == GX_OK) result = gxb_boolean_components(b, &c, NULL);
        if (result == GX_OK) {
            ck_assert_uint_eq(c.count, 2);
            ck_assert_int_eq(gxb_boolean_statistics(b, &s, NULL), GX_OK);
            ck_assert(s.peak_bytes <= limit && s.allocations > 0 && s.filter_calls >= s.exact_calls);
        } else {
            ck_assert_int_eq(result, GX_ERROR_LIMIT);
            refused++;
        }
        gxb_boolean_destroy(b);
    }
    ck_assert(refused > 0 && refused < 12);
    surface_free(&body);
    wl_free(&w);
}
END_TEST

static gx_result refusal(const gxb_operand *o, size_t *index) {
    gxb_boolean *b = NULL;
    gx_failure failure;
    gx_result result;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    result = gxb_boolean_add(b, o, &failure);
    *index = failure.index;
    gxb_boolean_destroy(b);
    return result;
}

/* The intersection of two boxes: the same at any size, or the first operand is refused */
START_TEST(sizes_are_numbers_or_refused) {
    static const int powers[17] = {-1022, -1000, -400, -310, -201, -200, -100, -61, 0,
                                   61,    100,   200,  201,  310,  400,  1000, 1020};
    const int e = powers[_i], fits = e >= -200 && e <= 200;
    const double size = ldexp(1, e);
    double corner[3][3];
    gxb_operand o[2];
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components c;
    wl_surface s[2];
    size_t i;
    int k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) corner[i][k] = i == 0 ? 0 : i == 1 ? size : ldexp(1.5 + k / 8.0, e);
    memset(s, 0, sizeof s);
    wl_add_aligned_box(&s[0], corner[0], corner[1]);
    for (k = 0; k < 3; k++) corner[0][k] = 0.75 * size;
    wl_add_aligned_box(&s[1], corner[0], corner[2]);
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i < 2; i++) {
        o[i] = operand_of(&s[i], i == 0 ? GXB_UNION : GXB_INTERSECTION);
        ck_assert_int_eq(gxb_boolean_add(b, &o[i], NULL), fits ? GX_OK : GX_ERROR_RANGE);
    }
    if (fits) {
        ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_OK);
        ck_assert_uint_eq(c.count, 1);
        ck_assert_double_eq_tol(c.total_volume, ldexp(1, 3 * e - 6), ldexp(1, 3 * e - 50));
        for (i = 0; i < 3 * r.vertex_count; i++) ck_assert(fabs(r.vertices[i] / size - 0.875) <= 0.125 + 1e-10);
    }
    gxb_boolean_destroy(b);
    surface_free(&s[0]);
    surface_free(&s[1]);
}
END_TEST

/* A coordinate far below the others, but not 0 */
START_TEST(small_coordinates_are_numbers_or_refused) {
    static const double one[3] = {1, 1, 1}, small[3] = {0x1p-128, 0x1p-129, 5e-324};
    int i;
    for (i = 0; i < 3; i++) {
        double low[3] = {0, 0, 0};
        gxb_boolean *b = NULL;
        gxb_operand o;
        gx_failure failure;
        wl_surface s;
        low[1] = small[i];
        memset(&s, 0, sizeof s);
        wl_add_aligned_box(&s, low, one);
        o = operand_of(&s, GXB_UNION);
        ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
        ck_assert_int_eq(gxb_boolean_add(b, &o, &failure), i == 0 ? GX_OK : GX_ERROR_RANGE);
        ck_assert(i == 0 || failure.index < s.vertex_count);
        gxb_boolean_destroy(b);
        surface_free(&s);
    }
    gxb_boolean_destroy(NULL);
}
END_TEST

/* The largest possible: a second operand 2^128 times as large as the first one */
START_TEST(largest_volumes_are_numbers) {
    static const double zero[3] = {0, 0, 0};
    const double one[3] = {0x1p200, 0x1p200, 0x1p200}, more[3] = {0x1p327, 0x1p327, 0x1p327};
    gxb_operand o[2];
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components c;
    wl_surface s[2];
    size_t i;
    memset(s, 0, sizeof s);
    wl_add_aligned_box(&s[0], zero, one);
    wl_add_aligned_box(&s[1], zero, more);
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i < 2; i++) {
        o[i] = operand_of(&s[i], GXB_UNION);
        ck_assert_int_eq(gxb_boolean_add(b, &o[i], NULL), GX_OK);
    }
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_OK);
    ck_assert(c.total_volume == 0x1p981);
    for (i = 0; i < 3 * s[1].vertex_count; i++) s[1].vertices[i] *= 2;
    ck_assert_int_eq(gxb_boolean_add(b, &o[1], NULL), GX_ERROR_RANGE);
    gxb_boolean_destroy(b);
    surface_free(&s[0]);
    surface_free(&s[1]);
}
END_TEST

START_TEST(bad_input_is_refused) {
    static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    wl_surface s;
    gxb_operand good, o;
    gxb_boolean_desc desc;
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components c;
    gxb_defects d;
    gxb_statistics statistics;
    size_t i;
    double kept;
    memset(&s, 0, sizeof s);
    wl_add_aligned_box(&s, zero, one);
    good = operand_of(&s, GXB_UNION);
    ck_assert_int_eq(refusal(&good, &i), GX_OK);
    o = good;
    o.operation = 99;
    ck_assert_int_eq(refusal(&o, &i), GX_ERROR_ARGUMENT);
    o = good;
    o.vertices = NULL;
    ck_assert_int_eq(refusal(&o, &i), GX_ERROR_ARGUMENT);
    o = good;
    o.triangle_count = 0;
    ck_assert_int_eq(refusal(&o, &i), GX_ERROR_EMPTY);
    o = good;
    o.triangle_count = 11;
    ck_assert_int_eq(refusal(&o, &i), GX_ERROR_NOT_CLOSED);
    o = good;
    o.vertex_count = 7;
    ck_assert_int_eq(refusal(&o, &i), GX_ERROR_INDEX);
    kept = s.vertices[10];
    s.vertices[10] = INFINITY;
    ck_assert_int_eq(refusal(&good, &i), GX_ERROR_NOT_FINITE);
    ck_assert_uint_eq(i, 3);
    s.vertices[10] = 1e300;
    ck_assert_int_eq(refusal(&good, &i), GX_ERROR_RANGE);
    ck_assert_uint_eq(i, 3);
    s.vertices[10] = kept;
    ck_assert_int_eq(gxb_boolean_create(NULL, NULL, NULL), GX_ERROR_ARGUMENT);
    memset(&desc, 0, sizeof desc);
    desc.allocator.allocate = scarce_take; /* and nothing to release it */
    ck_assert_int_eq(gxb_boolean_create(&desc, &b, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_triangulation(b, 3, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_set_triangulation(NULL, GXB_COARSE, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_set_fine(NULL, 1, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_set_mend(NULL, 1, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxb_boolean_defects(b, &d, NULL), GX_ERROR_SEQUENCE);
    ck_assert_int_eq(gxb_boolean_components(NULL, &c, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_components(b, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_defects(NULL, &d, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_defects(b, NULL, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_statistics(NULL, &statistics, NULL), GX_ERROR_ARGUMENT);
    ck_assert_int_eq(gxb_boolean_statistics(b, NULL, NULL), GX_ERROR_ARGUMENT);
    /* a refused operand leaves nothing behind */
    o = good;
    o.triangle_count = 11;
    ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_ERROR_NOT_CLOSED);
    ck_assert_int_eq(gxb_boolean_add(b, &good, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    ck_assert_uint_eq(r.triangle_count, 12);
    ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_ERROR_NOT_CLOSED); /* nor does it take the result away */
    c = components_of(b);
    ck_assert(c.total_volume == 1 && c.count == 1);
    ck_assert_int_eq(gxb_boolean_add(b, &good, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_ERROR_SEQUENCE); /* an operand does */
    ck_assert_int_eq(gxb_boolean_defects(b, &d, NULL), GX_ERROR_SEQUENCE);
    gxb_boolean_destroy(b);
    surface_free(&s);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("Booleans of surfaces");
    TCase *tests = tcase_create("Booleans"), *scarce = tcase_create("memory");
    int result;
    tcase_set_timeout(tests, 300);
    tcase_add_test(tests, slabs);
    tcase_add_test(tests, wavy_sheet);
    tcase_add_test(tests, chains_divide_as_segments_do);
    tcase_add_test(tests, sticks);
    tcase_add_loop_test(tests, hard_slabs_and_corners, 0, WL_HARD);
    tcase_add_test(tests, volumes_add_up);
    tcase_add_test(tests, the_same_from_elsewhere);
    tcase_add_test(tests, random_cuts_beside_the_oracle);
    tcase_add_test(tests, chains_are_exact);
    tcase_add_test(tests, winding_rules);
    tcase_add_test(tests, cavities_belong_to_their_component);
    tcase_add_test(tests, cavities_and_cores);
    tcase_add_loop_test(tests, many_surfaces_at_once, 0, 4);
    tcase_add_test(tests, touching_solids);
    tcase_add_test(tests, handles_are_counted);
    tcase_add_test(tests, sheets_divide);
    tcase_add_test(tests, a_fine_flat_sheet_divides);
    tcase_add_test(tests, an_operand_of_one_point_is_nothing);
    tcase_add_test(tests, a_wave_divides);
    tcase_add_test(tests, everything_knows_where_it_comes_from);
    tcase_add_test(tests, faces_in_as_few_triangles_as_possible);
    tcase_add_test(tests, coarse_results_are_the_same_solids);
    tcase_add_test(tests, coarse_sticks);
    tcase_add_test(tests, closed_sheets_divide);
    tcase_add_test(tests, read_off_in_all_ways);
    tcase_add_test(tests, rounding_is_mended);
    tcase_add_loop_test(tests, mending_keeps_volumes, 0, 12);
    tcase_add_loop_test(tests, walls_of_a_few_units, 0, 30);
    tcase_add_test(tests, rounded_sticks_are_mended);
    tcase_add_loop_test(tests, crossings_around_islands, 0, 200 / FEWER);
    tcase_add_test(tests, stars_are_simple);
    tcase_add_test(tests, broken_promises);
    tcase_add_test(tests, memory_limit);
    tcase_add_loop_test(tests, sizes_are_numbers_or_refused, 0, 17);
    tcase_add_test(tests, small_coordinates_are_numbers_or_refused);
    tcase_add_test(tests, largest_volumes_are_numbers);
    tcase_add_test(tests, bad_input_is_refused);
    suite_add_tcase(suite, tests);
    tcase_set_timeout(scarce, 300);
    tcase_add_test(scarce, memory_runs_out);
    tcase_add_test(scarce, memory_runs_out_late);
    tcase_add_test(scarce, memory_runs_out_of_states);
    suite_add_tcase(suite, scarce);
    result = run_suite(suite);
    rat_arena_free();
    return result;
}
