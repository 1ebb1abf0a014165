/* test_pairs.c - a closed surface and another one, closed or open: union, intersection, difference and symmetric
   difference, or the first divided by the second. Compared with the exact oracle (boolean_oracle.h). Pairs too large
   for it are checked by the identities of volumes and by the same operations with axes exchanged. A first surface
   that is open must be refused, with a triangle at its rim.

   GXFEM_DATA (environment): a data folder. The pairs in its folder boolean/ are used too: MCUT's benchmark, and
   three of manifold's tests, whose difference is known from CGAL's corefinement. GXFEM_VERBOSE prints what each pair
   gives. */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include "../examples/gxio.h"
#include "boolean_oracle.h"
#include "operand.h"
#include "runner.h"

enum { PLANES = 80, PIECES = 60000, MCUT_PAIRS = 32 };
enum { UNION, INTERSECTION, DIFFERENCE, SYMMETRIC, SPLIT, OPERATIONS };
static const char *const operation_names[OPERATIONS] = {"union", "intersection", "difference", "symmetric difference",
                                                        "split"};
static const uint32_t operations[OPERATIONS] = {GXB_UNION, GXB_INTERSECTION, GXB_DIFFERENCE, GXB_SYMMETRIC_DIFFERENCE,
                                                GXB_SPLIT};

typedef struct pair {
    const char *first, *second;
    size_t components; /* of the difference; 0: not known */
    double volume;
} pair;

/* clang-format off */
static const pair generated[] = {
    {"box:0,0,0,1,1,1", "box:0.5,0.25,0,2,0.75,1", 1, 0.75},           /* two faces in common planes */
    {"box:0,0,0,1,1,1", "box:0.25,-1,-1,0.5,2,2", 2, 0.75},
    {"box:0,0,0,1,1,1", "box:1,0,0,2,1,1", 1, 1},                       /* a face in common */
    {"box:0,0,0,1,1,1", "box:0,0,0,1,1,1", 0, 0},
    {"box:0,0,0,4,4,4", "box:1,1,1,2,2,2", 1, 63},
    {"box:0,0,0,1,1,1", "plane:0.5,0.5,0.5,1,2,3", 0, 0},
    {"box:0,0,0,1,1,1", "wave:0.5,0.5,0.5,1,0,0,0.3,1,4", 0, 0},
    {"plane:0.5,0.5,0.5,1,2,3", "box:0,0,0,1,1,1", 0, 0}};
/* clang-format on */
enum { GENERATED = sizeof generated / sizeof generated[0] };

/* clang-format off */
static const pair manifold[] = {
    {"Cray_left", "Cray_right", 1, 982418629455.2062},
    {"Havocglass8_left", "Havocglass8_right", 5, 2710897.8084396427},
    {"Offset3", "Offset4", 1, 9415.249424127097}};
/* clang-format on */
enum { MANIFOLD = sizeof manifold / sizeof manifold[0] };

static int is_told(void) { return getenv("GXFEM_VERBOSE") != NULL; }

/* ---- closed? ---- */

typedef struct side {
    double from[3], to[3];
    size_t triangle;
    int turned;
} side;

static int compare_ends(const void *a, const void *b) {
    const side *x = (const side *)a, *y = (const side *)b;
    const double *p = x->from, *q = y->from; /* from and to stand behind one another */
    int k;
    for (k = 0; k < 6; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* A triangle's edges from the lower to the higher end, without edges of no length. Returns their number. */
static size_t sides_of(const gxio_surface *s, size_t triangle, side *sides) {
    size_t k, n = 0;
    int j;
    for (k = 0; k < 3; k++) {
        const double *a = s->vertices + 3 * (size_t)s->triangles[3 * triangle + k],
                     *b = s->vertices + 3 * (size_t)s->triangles[3 * triangle + (k + 1) % 3];
        int order = 0;
        for (j = 0; j < 3 && order == 0; j++) order = (a[j] > b[j]) - (a[j] < b[j]);
        if (order == 0) continue;
        for (j = 0; j < 3; j++) {
            sides[n].from[j] = (order < 0 ? a : b)[j] + 0.0;
            sides[n].to[j] = (order < 0 ? b : a)[j] + 0.0;
        }
        sides[n].triangle = triangle;
        sides[n++].turned = order > 0;
    }
    return n;
}

/* rim: for each triangle, whether it has an edge that is passed more often one way than the other. Returns the
   number of these. */
static size_t find_rim(const gxio_surface *s, unsigned char *rim) {
    side *sides = (side *)calloc(3 * s->triangle_count + 1, sizeof *sides);
    size_t n = 0, i, from, found = 0;
    ck_assert_ptr_nonnull(sides);
    for (i = 0; i < s->triangle_count; i++) n += sides_of(s, i, sides + n);
    qsort(sides, n, sizeof *sides, compare_ends);
    for (from = i = 0; i < n; from = i) {
        long sum = 0;
        for (; i < n && compare_ends(&sides[from], &sides[i]) == 0; i++) sum += sides[i].turned ? -1 : 1;
        for (; sum != 0 && from < i; from++) rim[sides[from].triangle] = 1;
    }
    for (i = 0; i < s->triangle_count; i++) found += rim[i];
    free(sides);
    return found;
}

static int is_closed(const gxio_surface *s) {
    unsigned char *rim = (unsigned char *)calloc(s->triangle_count + 1, 1);
    size_t found;
    ck_assert_ptr_nonnull(rim);
    found = find_rim(s, rim);
    free(rim);
    return found == 0;
}

/* ---- the kernel ---- */

typedef struct answer {
    size_t components;
    long euler;
    double volume;
} answer;

static gxb_operand operand_of(const gxio_surface *s, uint32_t operation) {
    return operand_from(s->vertices, s->vertex_count, s->triangles, s->triangle_count, operation);
}

static answer combine(const gxio_surface *s, size_t count, uint32_t operation) {
    gxb_boolean *b = NULL;
    gxb_boolean_result r;
    gxb_components c;
    answer a;
    size_t i;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    for (i = 0; i < count; i++) {
        const gxb_operand o = operand_of(&s[i], i == 0 ? GXB_UNION : operation);
        ck_assert_int_eq(gxb_boolean_add(b, &o, NULL), GX_OK);
    }
    ck_assert_int_eq(gxb_boolean_evaluate(b, &r, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_components(b, &c, NULL), GX_OK);
    memset(&a, 0, sizeof a);
    a.components = c.count;
    a.volume = c.total_volume;
    for (i = 0; i < c.count; i++) {
        ck_assert(c.volume[i] > 0);
        a.euler += c.euler[i];
    }
    gxb_boolean_destroy(b);
    return a;
}

/* An open surface is no solid: refused, with one of the triangles at its rim. */
static void check_refused(const gxio_surface *s) {
    const gxb_operand o = operand_of(s, GXB_UNION);
    unsigned char *rim = (unsigned char *)calloc(s->triangle_count + 1, 1);
    gxb_boolean *b = NULL;
    gx_failure failure;
    ck_assert_ptr_nonnull(rim);
    find_rim(s, rim);
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_add(b, &o, &failure), GX_ERROR_NOT_CLOSED);
    ck_assert_uint_lt(failure.index, s->triangle_count);
    ck_assert(rim[failure.index]);
    gxb_boolean_destroy(b);
    free(rim);
}

/* ---- the truth ---- */

static int counts_inside(void *user, const int32_t *winding, size_t count) {
    const int a = winding[0] != 0, b = winding[1] != 0;
    (void)count;
    switch (*(const int *)user) {
    case UNION: return a | b;
    case INTERSECTION: return a & b;
    case DIFFERENCE: return a & !b;
    case SYMMETRIC: return a ^ b;
    default: return a;
    }
}

/* 0: too large for the oracle */
static int ask_oracle(const gxio_surface *s, int operation, truth *t) {
    oracle_surface surface[2];
    size_t vertex_count[2], i;
    truth_question q;
    for (i = 0; i < 2; i++) {
        surface[i].vertices = s[i].vertices;
        surface[i].triangles = s[i].triangles;
        surface[i].triangle_count = s[i].triangle_count;
        surface[i].solid = i == 0 || operation != SPLIT;
        vertex_count[i] = s[i].vertex_count;
    }
    q.surface = surface;
    q.vertex_count = vertex_count;
    q.count = 2;
    q.planes = PLANES;
    q.pieces = PIECES;
    q.inside = counts_inside;
    q.user = &operation;
    return s[0].triangle_count + s[1].triangle_count <= 2 * PLANES && truth_ask(&q, t);
}

/* Volumes are right to 1e-7 of themselves. */
static void check_near(double x, double y, double size) { ck_assert_double_le(fabs(x - y), 4e-7 * size); }

static void exchange_axes(gxio_surface *s) {
    size_t i;
    for (i = 0; i < s->vertex_count; i++) {
        double *x = s->vertices + 3 * i, first = x[0];
        x[0] = x[1];
        x[1] = x[2];
        x[2] = first;
    }
}

/* Identities that hold for any operands, even if no oracle knows the numbers */
static void check_volumes(gxio_surface *s, const answer *a) {
    const answer first = combine(s, 1, GXB_UNION), second = combine(s + 1, 1, GXB_UNION);
    const double size = first.volume + second.volume;
    int operation;
    check_near(a[UNION].volume + a[INTERSECTION].volume, size, size);
    check_near(a[DIFFERENCE].volume + a[INTERSECTION].volume, first.volume, size);
    check_near(a[SYMMETRIC].volume + a[INTERSECTION].volume, a[UNION].volume, size);
    exchange_axes(&s[0]);
    exchange_axes(&s[1]);
    for (operation = UNION; operation < SPLIT; operation++) {
        const answer other = combine(s, 2, operations[operation]);
        ck_assert_uint_eq(other.components, a[operation].components);
        ck_assert_int_eq(other.euler, a[operation].euler);
        check_near(other.volume, a[operation].volume, size);
    }
}

static answer check_operation(const gxio_surface *s, int operation, int *asked) {
    const answer a = combine(s, 2, operations[operation]);
    truth t;
    ck_assert_int_eq(a.euler % 2, 0);
    *asked = ask_oracle(s, operation, &t);
    if (*asked) {
        ck_assert_uint_eq(a.components, t.components);
        ck_assert_int_eq(a.euler, t.euler);
        check_near(a.volume, t.volume, t.volume);
    }
    if (is_told())
        printf("  %-20s %3zu components, volume %.17g, Euler characteristic %ld%s\n", operation_names[operation],
               a.components, a.volume, a.euler, *asked ? ": as the oracle says" : "");
    return a;
}

static void load(const char *spec, gxio_surface *s) {
    const gxio_box box = {{0, 0, 0}, {1, 1, 1}};
    gxio_error error;
    if (!gxio_surface_load(spec, &box, s, &error)) ck_abort_msg("%s", error.text);
}

static void check_pair(const pair *p) {
    gxio_surface s[2];
    answer a[OPERATIONS];
    int operation, asked = 1, all = 1;
    load(p->first, &s[0]);
    load(p->second, &s[1]);
    if (is_told())
        printf("%s, %s: %zu + %zu triangles\n", p->first, p->second, s[0].triangle_count, s[1].triangle_count);
    if (!is_closed(&s[0])) {
        check_refused(&s[0]);
        if (is_told()) printf("  the first is open: refused\n");
    } else if (!is_closed(&s[1])) {
        check_refused(&s[1]);
        check_operation(s, SPLIT, &asked);
        ck_assert(asked);
    } else {
        for (operation = UNION; operation < SPLIT; operation++) {
            a[operation] = check_operation(s, operation, &asked);
            all = all && asked;
        }
        if (p->components > 0) {
            ck_assert_uint_eq(a[DIFFERENCE].components, p->components);
            ck_assert_double_le(fabs(a[DIFFERENCE].volume - p->volume), 1e-12 * p->volume);
        }
        check_volumes(s, a);
        if (is_told() && !all)
            printf("  checked by volumes and by axes exchanged%s\n",
                   p->components ? ", and against what is known" : "");
    }
    gxio_surface_release(&s[0]);
    gxio_surface_release(&s[1]);
}

/* ---- tests ---- */

START_TEST(generated_pairs) { check_pair(&generated[_i]); }
END_TEST

START_TEST(mcut_pairs) {
    char path[2][1024];
    pair p;
    memset(&p, 0, sizeof p);
    snprintf(path[0], sizeof path[0], "%s/boolean/pairs/src-mesh%03d.off", getenv("GXFEM_DATA"), 2 * _i);
    snprintf(path[1], sizeof path[1], "%s/boolean/pairs/cut-mesh%03d.off", getenv("GXFEM_DATA"), 2 * _i);
    p.first = path[0];
    p.second = path[1];
    check_pair(&p);
}
END_TEST

START_TEST(manifold_pairs) {
    char path[2][1024];
    pair p = manifold[_i];
    snprintf(path[0], sizeof path[0], "%s/boolean/manifold_%s.obj", getenv("GXFEM_DATA"), p.first);
    snprintf(path[1], sizeof path[1], "%s/boolean/manifold_%s.obj", getenv("GXFEM_DATA"), p.second);
    p.first = path[0];
    p.second = path[1];
    check_pair(&p);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("pairs");
    TCase *tests = tcase_create("pairs");
    int result;
    tcase_set_timeout(tests, 600);
    tcase_add_loop_test(tests, generated_pairs, 0, GENERATED);
    if (getenv("GXFEM_DATA")) {
        tcase_add_loop_test(tests, mcut_pairs, 0, MCUT_PAIRS);
        tcase_add_loop_test(tests, manifold_pairs, 0, MANIFOLD);
    }
    suite_add_tcase(suite, tests);
    result = run_suite(suite);
    rat_arena_free();
    return result;
}
