/* fuzz.c - Booleans of surfaces and the cell complex on cases made from bytes. Each result is checked for properties
   that hold for any input.

       fuzz FILE... | --seed=S --cases=N --seconds=T --out=FOLDER     as fuzz.h says
            --oracle=K                         the exact oracle on one case in K (100)

   With -DGXFEM_LINKED it does not contain the library. The library may then be built under flags that would mislead the
   checks. The first byte of a case says what is tested, the next how coordinates are made; operands follow
   (fuzz_cases.h).

   Checks:
       results      an operand is refused with the code that the documentation gives, and leaves nothing behind
       surface      every directed edge is matched, every index in range, every component has a volume and an even
                    Euler characteristic
       provenance   the exact point of each vertex lies in each triangle and edge of its origin, and in the source of
                    each triangle around it; how far rounding moved it
       volumes      vol(A) + vol(B) = vol(A or B) + vol(A and B), and the consequences for the other operations
       sameness     in any order of operands and axes, at once or one after the other, by rules or by a callback
       rounding     a rounded result is a closed surface of the same volume
       complex      pieces of tetrahedra cut by triangles are those of the Boolean; a rollback leaves nothing; a
                    saved complex can be loaded
       oracle       components, volume and Euler characteristic agree with a division of space by all planes, in
                    rationals (boolean_oracle.h) */
#define _XOPEN_SOURCE 700
#ifndef GXFEM_LINKED
#define GXFEM_BOOLEAN_IMPLEMENTATION
#endif
#include "../gxfem_boolean.h"
#include "boolean_oracle.h"
#include "scarce.h"
#include "fuzz_cases.h"
#define FUZZ_BYTES   CASE_BYTES
#define FUZZ_SECONDS 60
#define FUZZ_FOLDER  "build/fuzz"
#include "fuzz.h"

enum { PARTS = 12, ORACLE_PLANES = 22 };

static struct {
    uint64_t number; /* of cases so far */
    uint64_t every;  /* the oracle is asked about one case in this number; 0: about none */
    rat_mark start;  /* of numbers, before the case */
} asked = {0, 100, {0}};

static struct { uint64_t evaluations, refused, oracles, complexes, provenances, defects, mended; } count;

/* ---- one Boolean and its result ---- */

typedef struct answer { /* independent of how the arrangement was made */
    size_t components, triangles;
    long euler;
    double volume;
    double part[PARTS]; /* of the components, ascending, if they fit */
} answer;

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Operands, and what a callback counts as inside */
typedef struct scene {
    const case_operand *operand;
    size_t count;
    int what;      /* of the callback: WHAT_CHAIN ... */
    size_t states; /* number of calls */
} scene;

enum { WHAT_CHAIN, WHAT_A, WHAT_B, WHAT_ANY, WHAT_BOTH, WHAT_MINUS, WHAT_ONE, WHATS };

static int counts_inside(uint32_t rule, int32_t n) {
    return rule == GXB_POSITIVE ? n > 0 : rule == GXB_NEGATIVE ? n < 0 : rule == GXB_ODD ? (n & 1) != 0 : n != 0;
}

static int chain_inside(const case_operand *operand, size_t n, const int32_t *winding) {
    size_t i;
    int inside = 0;
    for (i = 0; i < n; i++) {
        const int in = counts_inside(operand[i].rule, winding[i]);
        if (operand[i].operation == GXB_SPLIT) continue;
        if (i == 0 || operand[i].operation == GXB_UNION)
            inside |= in;
        else if (operand[i].operation == GXB_INTERSECTION)
            inside &= in;
        else if (operand[i].operation == GXB_DIFFERENCE)
            inside &= !in;
        else
            inside ^= in;
    }
    return inside;
}

static int is_inside(void *user, const int32_t *winding, size_t operands) {
    scene *s = (scene *)user;
    int a, b;
    s->states++;
    if (s->what == WHAT_CHAIN) return chain_inside(s->operand, operands, winding);
    a = counts_inside(s->operand[0].rule, winding[0]);
    b = counts_inside(s->operand[1].rule, winding[1]);
    switch (s->what) {
    case WHAT_A: return a;
    case WHAT_B: return b;
    case WHAT_ANY: return a | b;
    case WHAT_BOTH: return a & b;
    case WHAT_MINUS: return a & !b;
    default: return a ^ b;
    }
}

static gxb_operand operand_of(const case_operand *c) {
    gxb_operand o;
    memset(&o, 0, sizeof o);
    o.vertices = &c->mesh.x[0][0];
    o.vertex_count = c->mesh.vertices;
    o.triangles = &c->mesh.t[0][0];
    o.triangle_count = c->mesh.triangles;
    o.operation = c->operation;
    o.rule = c->rule;
    return o;
}

/* Directed edges by hash: the number of passes one way less the number the other way */
enum { EDGE_TABLE = 1 << 15 };
typedef struct edge_entry {
    uint64_t stamp;
    uint32_t low, high;
    int32_t sum;
} edge_entry;
static edge_entry edges[EDGE_TABLE];
static uint64_t edge_stamp;

static edge_entry *find_edge(uint32_t p, uint32_t q) {
    const uint32_t low = p < q ? p : q, high = p < q ? q : p;
    uint32_t k = (low * 2654435761u ^ high * 2246822519u) >> 7 & (EDGE_TABLE - 1);
    while (edges[k].stamp == edge_stamp && (edges[k].low != low || edges[k].high != high))
        k = (k + 1) & (EDGE_TABLE - 1);
    if (edges[k].stamp != edge_stamp) {
        edges[k].stamp = edge_stamp;
        edges[k].low = low;
        edges[k].high = high;
        edges[k].sum = 0;
    }
    return &edges[k];
}

/* name: of each vertex, or NULL. Returns whether each edge is passed equally often in both directions. Large
   surfaces are not checked. */
static int is_closed(const uint32_t *triangles, size_t n, const uint32_t *name) {
    size_t i;
    if (3 * n > EDGE_TABLE / 2) return 1;
    edge_stamp++;
    for (i = 0; i < 3 * n; i++) {
        const uint32_t a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1], p = name ? name[a] : a,
                       q = name ? name[b] : b;
        if (p != q) find_edge(p, q)->sum += p < q ? 1 : -1;
    }
    for (i = 0; i < 3 * n; i++) {
        const uint32_t a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1], p = name ? name[a] : a,
                       q = name ? name[b] : b;
        if (p != q && find_edge(p, q)->sum != 0) return 0;
    }
    return 1;
}

static void check_indices(const scene *s, const gxb_boolean_result *r) {
    size_t i;
    for (i = 0; i < r->triangle_count; i++) {
        const uint32_t *t = r->triangles + 3 * i;
        REQUIRE(t[0] < r->vertex_count && t[1] < r->vertex_count && t[2] < r->vertex_count,
                "triangle %zu: no such vertex", i);
        REQUIRE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "triangle %zu has one vertex twice", i);
        REQUIRE(r->triangle_operand[i] < s->count &&
                    r->triangle_source[i] < s->operand[r->triangle_operand[i]].mesh.triangles,
                "triangle %zu: no such source", i);
    }
}

static gxb_defects defects_of(gxb_boolean *b, const gxb_boolean_result *r) {
    gxb_defects d;
    size_t i;
    const gx_result result = gxb_boolean_defects(b, &d, NULL);
    REQUIRE(result == GX_OK, "defects: error %d", (int)result);
    for (i = 0; i < d.count; i++) REQUIRE(d.triangles[i] < r->triangle_count, "defect %zu: no such triangle", i);
    return d;
}

static answer check_result(gxb_boolean *b, const scene *s, const gxb_boolean_result *r) {
    answer a = {0, 0, 0, 0, {0}};
    gxb_components c;
    size_t i, k;
    double sum = 0;
    const gx_result result = gxb_boolean_components(b, &c, NULL);
    count.evaluations++;
    REQUIRE(result == GX_OK, "components: error %d", (int)result);
    check_indices(s, r);
    REQUIRE(is_closed(r->triangles, r->triangle_count, NULL), "the result is not closed");
    for (i = 0; i < r->triangle_count; i++) REQUIRE(c.triangle[i] < c.count, "triangle %zu: no such component", i);
    for (i = 0; i < c.count; i++) {
        REQUIRE(c.volume[i] > 0, "component %zu has volume %g", i, c.volume[i]);
        REQUIRE(c.euler[i] % 2 == 0, "component %zu has Euler characteristic %ld", i, (long)c.euler[i]);
        sum += c.volume[i];
        a.euler += c.euler[i];
        if (i < PARTS) a.part[i] = c.volume[i];
        for (k = 0; k < s->count; k++) {
            const int side = c.side[i * s->count + k];
            REQUIRE(side == 0 || (s->operand[k].operation == GXB_SPLIT && (side == 1 || side == -1)),
                    "component %zu is on side %d of %zu", i, side, k);
        }
    }
    REQUIRE(fabs(sum - c.total_volume) <= 1e-12 * sum, "volume %.17g, of components %.17g", c.total_volume, sum);
    a.components = c.count;
    a.triangles = r->triangle_count;
    a.volume = c.total_volume;
    if (a.components <= PARTS) qsort(a.part, a.components, sizeof a.part[0], compare_doubles);
    return a;
}

static gxb_boolean *create(scene *s, int fine, int callback) {
    gxb_boolean *b = NULL;
    gxb_boolean_desc desc;
    memset(&desc, 0, sizeof desc);
    if (callback) {
        desc.inside = is_inside;
        desc.user = s;
    }
    REQUIRE(gxb_boolean_create(&desc, &b, NULL) == GX_OK && gxb_boolean_set_fine(b, fine, NULL) == GX_OK, "create");
    return b;
}

static answer evaluate(gxb_boolean *b, const scene *s, gxb_boolean_result *r) {
    const gx_result result = gxb_boolean_evaluate(b, r, NULL);
    REQUIRE(result == GX_OK, "evaluate: error %d", (int)result);
    return check_result(b, s, r);
}

/* All operands; each: evaluated after each. Gives the last result. */
static answer combine(scene *s, int fine, int each) {
    gxb_boolean *b = create(s, fine, 0);
    scene sofar = *s;
    gxb_boolean_result r;
    answer a = {0, 0, 0, 0, {0}};
    size_t i;
    for (i = 0; i < s->count; i++) {
        const gxb_operand o = operand_of(&s->operand[i]);
        REQUIRE(gxb_boolean_add(b, &o, NULL) == GX_OK, "operand %zu refused the second time", i);
        if (!each && i + 1 < s->count) continue;
        sofar.count = i + 1;
        a = evaluate(b, &sofar, &r);
    }
    gxb_boolean_destroy(b);
    return a;
}

/* Volumes are right to 1e-7 of themselves at least; with fine, to their last digits. */
static int near(double x, double y, double size, int fine) { return fabs(x - y) <= (fine ? 1e-12 : 4e-7) * size; }

static void check_parts(const char *how, const answer *a, const double *part, int fine) {
    size_t i;
    for (i = 0; i < a->components && a->components <= PARTS; i++)
        REQUIRE(near(a->part[i], part[i], part[i], fine), "%s: component of %.17g, %.17g", how, a->part[i], part[i]);
}

static void check_same(const char *how, const answer *a, const answer *b, int fine) {
    REQUIRE(a->components == b->components, "%s: %zu components, %zu", how, a->components, b->components);
    REQUIRE(a->euler == b->euler, "%s: Euler characteristic %ld, %ld", how, a->euler, b->euler);
    REQUIRE(near(a->volume, b->volume, b->volume, fine), "%s: volume %.17g, %.17g", how, a->volume, b->volume);
    check_parts(how, a, b->part, fine);
}

/* ---- results: the code with which an operand should be refused ---- */

static gx_result check_coordinate(double x, int shift) {
    uint64_t bits; /* denormal numbers compare as 0 where the processor is told to flush them */
    int e;
    memcpy(&bits, &x, sizeof bits);
    if (!(fabs(x) < INFINITY)) return GX_ERROR_NOT_FINITE;
    if (bits << 1 == 0) return GX_OK;
    if (fabs(x) < ldexp(1, -1022)) return GX_ERROR_RANGE;
    frexp(x, &e);
    return e - 1 + shift < -128 || e - 1 + shift > 127 ? GX_ERROR_RANGE : GX_OK;
}

/* A scene's scale is that of its first operand if it is outside of 2^-60 ... 2^60. Beyond 2^-200 ... 2^200 there is
   none. */
static int scale_of(const case_operand *first) {
    int largest = -2000, e;
    size_t i;
    for (i = 0; i < 3 * first->mesh.vertices; i++) {
        const double x = fabs((&first->mesh.x[0][0])[i]);
        if (!(x < INFINITY) || x < ldexp(1, -1022)) continue;
        frexp(x, &e);
        if (e - 1 > largest) largest = e - 1;
    }
    return largest == -2000 || (largest >= -60 && largest <= 60) ? 0 : -largest;
}

static gx_result expected(const case_operand *c, int shift) {
    uint32_t name[CASE_VERTICES], i, j;
    if (c->mesh.vertices == 0 || c->mesh.triangles == 0) return GX_ERROR_EMPTY;
    for (i = 0; i < 3 * c->mesh.triangles; i++)
        if ((&c->mesh.t[0][0])[i] >= c->mesh.vertices) return GX_ERROR_INDEX;
    if (shift < -200 || shift > 200) return GX_ERROR_RANGE;
    for (i = 0; i < c->mesh.vertices; i++)
        for (j = 0; j < 3; j++) {
            const gx_result result = check_coordinate(c->mesh.x[i][j], shift);
            if (result != GX_OK) return result;
        }
    if (c->operation == GXB_SPLIT) return GX_OK;
    for (i = 0; i < c->mesh.vertices; i++)
        for (name[i] = 0; !(c->mesh.x[name[i]][0] == c->mesh.x[i][0] && c->mesh.x[name[i]][1] == c->mesh.x[i][1] &&
                            c->mesh.x[name[i]][2] == c->mesh.x[i][2]);
             name[i]++) {}
    return is_closed(&c->mesh.t[0][0], c->mesh.triangles, name) ? GX_OK : GX_ERROR_NOT_CLOSED;
}

/* Adds all operands. Those that are refused are removed from the case. */
static void add_operands(gxb_boolean *b, test_case *c) {
    size_t i, n = 0;
    int shift = 0;
    for (i = 0; i < c->operands; i++) {
        const gxb_operand o = operand_of(&c->operand[i]);
        gx_failure failure;
        gx_result result, right;
        if (n == 0) shift = scale_of(&c->operand[i]);
        right = expected(&c->operand[i], shift);
        result = gxb_boolean_add(b, &o, &failure);
        REQUIRE(result == right, "operand %zu: result %d, should be %d", i, (int)result, (int)right);
        REQUIRE(failure.result == result, "operand %zu: failure %d", i, (int)failure.result);
        if (result == GX_OK) {
            if (n != i) c->operand[n] = c->operand[i];
            n++;
        } else
            count.refused++;
    }
    c->operands = n;
}

/* ---- provenance: exact points from their origins ---- */

static void source_corners(const scene *s, uint32_t operand, uint32_t triangle, const double *x[3]) {
    const case_mesh *m = &s->operand[operand].mesh;
    int k;
    for (k = 0; k < 3; k++) x[k] = m->x[m->t[triangle][k]];
}

static void source_plane(const scene *s, uint32_t operand, uint32_t triangle, oracle_plane *p) {
    const double *x[3];
    source_corners(s, operand, triangle, x);
    REQUIRE(oracle_plane_of(x[0], x[1], x[2], p), "a source without area");
}

/* A plane through edge k of a triangle, and across it */
static void edge_plane(const scene *s, uint32_t operand, uint32_t half_edge, oracle_plane *own, oracle_plane *across) {
    oracle_triangle t;
    const double *x[3];
    int k;
    source_plane(s, operand, half_edge / 3, own);
    source_corners(s, operand, half_edge / 3, x);
    for (k = 0; k < 3; k++) memcpy(t.corner[k], x[k], sizeof t.corner[k]);
    for (t.axis = 0, k = 1; k < 3; k++)
        if (big_compare_abs(own->h[k], own->h[t.axis]) > 0) t.axis = k;
    *across = oracle_edge_plane(&t, (int)(half_edge % 3));
}

/* Is a point of a triangle's plane in the triangle, or on its edges? */
static int is_in_source(const scene *s, uint32_t operand, uint32_t triangle, const big h[4]) {
    const double *x[3];
    uint32_t k;
    source_corners(s, operand, triangle, x);
    for (k = 0; k < 3; k++) {
        oracle_plane own, across;
        edge_plane(s, operand, 3 * triangle + k, &own, &across);
        if (oracle_side(&across, h) * big_sign(h[3]) * oracle_side_of(&across, x[(k + 2) % 3]) < 0) return 0;
    }
    return 1;
}

/* Is the point in each triangle, and on each edge, that defines it? */
static int is_in_sources(const scene *s, const gxb_origin *o, const big h[4]) {
    const uint32_t count = o->kind == GXB_FROM_VERTEX ? 0 : o->kind == GXB_FROM_THREE_TRIANGLES ? 3 : 2;
    uint32_t k;
    for (k = 0; k < count; k++) {
        const int edge = o->kind == GXB_FROM_EDGE_EDGE || (o->kind == GXB_FROM_EDGE_TRIANGLE && k == 0);
        if (!is_in_source(s, o->operand[k], edge ? o->index[k] / 3 : o->index[k], h)) return 0;
    }
    return 1;
}

/* The point that an origin names; 0: its triangles and edges do not meet in one point */
static int exact_point(const scene *s, const gxb_origin *o, big h[4]) {
    oracle_plane p[4];
    int k;
    switch (o->kind) {
    case GXB_FROM_VERTEX: oracle_homogeneous(s->operand[o->operand[0]].mesh.x[o->index[0]], h); return 1;
    case GXB_FROM_EDGE_TRIANGLE:
        edge_plane(s, o->operand[0], o->index[0], &p[0], &p[1]);
        source_plane(s, o->operand[1], o->index[1], &p[2]);
        return oracle_meet(&p[0], &p[1], &p[2], h);
    case GXB_FROM_EDGE_EDGE:
        for (k = 0; k < 2; k++) edge_plane(s, o->operand[k], o->index[k], &p[2 * k], &p[2 * k + 1]);
        if (oracle_meet(&p[0], &p[1], &p[2], h)) return oracle_side(&p[3], h) == 0;
        return oracle_meet(&p[0], &p[1], &p[3], h) && oracle_side(&p[2], h) == 0;
    default:
        for (k = 0; k < 3; k++) source_plane(s, o->operand[k], o->index[k], &p[k]);
        return oracle_meet(&p[0], &p[1], &p[2], h);
    }
}

/* Is no double nearer to num / den > 0 than x? */
static int is_nearest(double x, big num, big den) {
    const double beside[2] = {nextafter(x, 0), nextafter(x, INFINITY)};
    const big twice = big_add(num, num);
    int k, good = 1;
    for (k = 0; k < 2; k++) {
        const big middle = big_mul(big_add(big_from_double(x), big_from_double(beside[k])), den);
        good = good && (k == 0 ? big_compare(twice, middle) >= 0 : big_compare(twice, middle) <= 0);
    }
    return good;
}

/* Fine vertices are the doubles nearest to the exact point; others are within 1e-10 of its largest coordinate. */
static void check_rounding(const double *x, const big h[4], int fine, size_t vertex) {
    double size = 0, exact[3];
    int k;
    for (k = 0; k < 3; k++) {
        exact[k] = rat_to_double(rat_ratio(h[k], h[3]));
        size = fmax(size, fabs(exact[k]));
    }
    for (k = 0; k < 3; k++) {
        REQUIRE(fine || fabs(x[k] - exact[k]) <= 1.1e-10 * size, "vertex %zu: %.17g should be %.17g", vertex, x[k],
                exact[k]);
        REQUIRE(!fine || (x[k] < 0) == (h[k].sign * h[3].sign < 0), "vertex %zu: %.17g should be %.17g", vertex, x[k],
                exact[k]);
        REQUIRE(!fine || is_nearest(fabs(x[k]), big_abs(h[k]), big_abs(h[3])),
                "vertex %zu: %.17g is not the double nearest to it", vertex, x[k]);
    }
}

static void check_provenance(const scene *s, const gxb_boolean_result *r, int fine) {
    const rat_mark mark = rat_arena_mark();
    big(*h)[4] = (big(*)[4])malloc((r->vertex_count + 1) * sizeof *h);
    size_t i, k;
    count.provenances++;
    for (i = 0; i < r->vertex_count; i++) {
        const gxb_origin *o = &r->vertex_origin[i];
        REQUIRE(exact_point(s, o, h[i]), "vertex %zu: its origin (%u) is no point", i, (unsigned)o->kind);
        REQUIRE(is_in_sources(s, o, h[i]), "vertex %zu: not in all that it is of (%u)", i, (unsigned)o->kind);
        if (o->kind == GXB_FROM_VERTEX)
            for (k = 0; k < 3; k++)
                REQUIRE(r->vertices[3 * i + k] == s->operand[o->operand[0]].mesh.x[o->index[0]][k], "vertex %zu moved",
                        i);
        else
            check_rounding(r->vertices + 3 * i, h[i], fine, i);
    }
    for (i = 0; i < r->triangle_count; i++) {
        oracle_plane p;
        const big *x[3];
        big u[4], v[4], n[3];
        const double *corner[3];
        source_plane(s, r->triangle_operand[i], r->triangle_source[i], &p);
        source_corners(s, r->triangle_operand[i], r->triangle_source[i], corner);
        for (k = 0; k < 3; k++) {
            x[k] = h[r->triangles[3 * i + k]];
            REQUIRE(oracle_side(&p, x[k]) == 0, "triangle %zu: corner %zu is not in its source's plane", i, k);
            REQUIRE(is_in_source(s, r->triangle_operand[i], r->triangle_source[i], x[k]),
                    "triangle %zu: corner %zu is not in its source", i, k);
        }
        for (k = 0; k < 3; k++) {
            u[k] = big_det2(x[0][3], x[0][k], x[1][3], x[1][k]);
            v[k] = big_det2(x[0][3], x[0][k], x[2][3], x[2][k]);
        }
        big_cross(u, v, n);
        REQUIRE(big_dot(n, p.h).sign == (r->triangle_reversed[i] ? -1 : 1), "triangle %zu does not face as it says", i);
    }
    free(h);
    rat_arena_release(mark);
}

/* ---- volumes, and sameness ---- */

static void check_volumes(gxb_boolean *b, scene *s, double box, int fine) {
    answer a[WHATS];
    gxb_boolean_result r;
    double size, sum;
    for (s->what = WHAT_A; s->what < WHATS; s->what++) {
        s->states = 0;
        a[s->what] = evaluate(b, s, &r);
    }
    size = a[WHAT_A].euler + a[WHAT_B].euler > 2 * (long)(a[WHAT_A].components + a[WHAT_B].components)
             ? box
             : a[WHAT_A].volume + a[WHAT_B].volume;
    sum = a[WHAT_A].volume + a[WHAT_B].volume;
    REQUIRE(near(a[WHAT_ANY].volume + a[WHAT_BOTH].volume, sum, size, fine),
            "A %.17g, B %.17g, A or B %.17g, A and B %.17g", a[WHAT_A].volume, a[WHAT_B].volume, a[WHAT_ANY].volume,
            a[WHAT_BOTH].volume);
    REQUIRE(near(a[WHAT_MINUS].volume + a[WHAT_BOTH].volume, a[WHAT_A].volume, size, fine),
            "A %.17g, A less B %.17g, A and B %.17g", a[WHAT_A].volume, a[WHAT_MINUS].volume, a[WHAT_BOTH].volume);
    REQUIRE(near(a[WHAT_ONE].volume + a[WHAT_BOTH].volume, a[WHAT_ANY].volume, size, fine),
            "A or B %.17g, one %.17g, A and B %.17g", a[WHAT_ANY].volume, a[WHAT_ONE].volume, a[WHAT_BOTH].volume);
}

/* A volume to compare others with: of the box around all operands */
static double size_of(const test_case *c) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, size = 1;
    size_t i, j;
    int k;
    for (i = 0; i < c->operands; i++)
        for (j = 0; j < c->operand[i].mesh.vertices; j++)
            for (k = 0; k < 3; k++) {
                low[k] = fmin(low[k], c->operand[i].mesh.x[j][k]);
                high[k] = fmax(high[k], c->operand[i].mesh.x[j][k]);
            }
    for (k = 0; k < 3; k++) size *= high[k] - low[k];
    return size;
}

static void swap_axes(case_mesh *m) {
    uint32_t i;
    for (i = 0; i < m->vertices; i++) {
        const double x = m->x[i][0];
        m->x[i][0] = m->x[i][1];
        m->x[i][1] = m->x[i][2];
        m->x[i][2] = x;
    }
}

static void mirror_order(case_mesh *m) {
    uint32_t i, k;
    for (i = 0; i < m->triangles / 2; i++)
        for (k = 0; k < 3; k++) {
            const uint32_t t = m->t[i][k];
            m->t[i][k] = m->t[m->triangles - 1 - i][(k + 1) % 3];
            m->t[m->triangles - 1 - i][(k + 1) % 3] = t;
        }
}

/* The same operands with other axes, other orders of triangles and, where allowed, of operands */
static void check_sameness(const test_case *c, const answer *a, int fine) {
    static test_case other;
    scene s = {other.operand, c->operands, WHAT_CHAIN, 0};
    size_t i;
    int commutes = 1;
    answer b;
    for (i = 0; i < c->operands; i++) {
        other.operand[i] = c->operand[i];
        swap_axes(&other.operand[i].mesh);
        mirror_order(&other.operand[i].mesh);
        if (other.operand[i].operation != (i == 0 ? other.operand[0].operation : (uint32_t)GXB_UNION) ||
            other.operand[0].operation == GXB_SPLIT)
            commutes = 0;
    }
    b = combine(&s, fine, 1);
    check_same("in sequence, other axes", &b, a, fine);
    if (!commutes || c->operands < 2 || scale_of(&c->operand[0]) != scale_of(&c->operand[c->operands - 1])) return;
    for (i = 0; i < c->operands; i++) other.operand[i] = c->operand[c->operands - 1 - i];
    for (i = 0; i < c->operands; i++) other.operand[i].operation = GXB_UNION;
    b = combine(&s, fine, 0);
    check_same("operands the other way round", &b, a, fine);
}

/* The largest change of volume when vertices move by 1e-10 of the largest coordinate: that times the surface's area,
   overestimated */
static double rounding_of(const gxb_boolean_result *r) {
    double area = 0, largest = 0;
    size_t i;
    int k;
    for (i = 0; i < 3 * r->vertex_count; i++) largest = fmax(largest, fabs(r->vertices[i]));
    for (i = 0; i < r->triangle_count; i++) {
        const double *x[3];
        for (k = 0; k < 3; k++) x[k] = r->vertices + 3 * (size_t)r->triangles[3 * i + (size_t)k];
        for (k = 0; k < 3; k++) {
            const int p = (k + 1) % 3;
            area += fabs((x[1][k] - x[0][k]) * (x[2][p] - x[0][p])) + fabs((x[1][p] - x[0][p]) * (x[2][k] - x[0][k])) +
                    largest * largest * 1e-10;
        }
    }
    return 4e-10 * largest * area;
}

/* A rounded result is a closed surface. Its triangles may cross each other because of the rounding. */
static void check_again(const gxb_boolean_result *r, const answer *a, double size) {
    gxb_boolean *b = NULL;
    gxb_boolean_result again;
    gxb_components parts;
    gxb_operand o;
    gx_result result;
    if (r->triangle_count == 0 || 3 * r->triangle_count > 2000) return;
    memset(&o, 0, sizeof o);
    o.vertices = r->vertices;
    o.vertex_count = r->vertex_count;
    o.triangles = r->triangles;
    o.triangle_count = r->triangle_count;
    REQUIRE(gxb_boolean_create(NULL, &b, NULL) == GX_OK, "create");
    result = gxb_boolean_add(b, &o, NULL);
    REQUIRE(result == GX_OK || result == GX_ERROR_RANGE, "the result as an operand: error %d", (int)result);
    if (result == GX_OK) {
        result = gxb_boolean_evaluate(b, &again, NULL);
        REQUIRE(result == GX_OK, "the result again: error %d", (int)result);
        result = gxb_boolean_components(b, &parts, NULL);
        REQUIRE(result == GX_OK, "components of the result again: error %d", (int)result);
        REQUIRE(fabs(parts.total_volume - a->volume) <= 1e-6 * size + rounding_of(r),
                "the result again: volume %.17g, was %.17g", parts.total_volume, a->volume);
    }
    gxb_boolean_destroy(b);
}

/* The sign that makes a triangle a defect, or none, in rationals */
static int is_upright(const scene *s, const gxb_boolean_result *r, size_t t) {
    const rat_mark mark = rat_arena_mark();
    const double *x[3];
    oracle_plane p, q;
    int k, sign;
    source_plane(s, r->triangle_operand[t], r->triangle_source[t], &p);
    for (k = 0; k < 3; k++) x[k] = r->vertices + 3 * (size_t)r->triangles[3 * t + (size_t)k];
    oracle_plane_of(x[0], x[1], x[2], &q);
    sign = big_dot(p.h, q.h).sign * (r->triangle_reversed[t] ? -1 : 1);
    rat_arena_release(mark);
    return sign > 0;
}

static void check_defects(const scene *s, const gxb_boolean_result *r, const gxb_defects *d) {
    size_t t, i = 0;
    for (t = 0; t < r->triangle_count; t++) {
        const int listed = i < d->count && d->triangles[i] == t;
        REQUIRE(is_upright(s, r, t) != listed, "triangle %zu is %sa defect", t,
                listed ? "listed as, but not " : "not listed, but ");
        i += (size_t)listed;
    }
}

/* Vertices - edges + triangles, by their numbers. *plain: no edge has more than two triangles. */
static long count_euler(const gxb_boolean_result *r, int *plain) {
    size_t i, pairs = 0, vertices = 0;
    static uint8_t seen[1 << 16];
    *plain = r->vertex_count <= sizeof seen && r->triangle_count < EDGE_TABLE / 6;
    if (!*plain) return 0;
    memset(seen, 0, r->vertex_count);
    edge_stamp++;
    for (i = 0; i < 3 * r->triangle_count; i++) {
        edge_entry *e = find_edge(r->triangles[i], r->triangles[i % 3 == 2 ? i - 2 : i + 1]);
        pairs += e->sum == 0;
        if (++e->sum > 2) *plain = 0;
        vertices += !seen[r->triangles[i]];
        seen[r->triangles[i]] = 1;
    }
    return (long)vertices - (long)pairs + (long)r->triangle_count;
}

/* Mended: closed, of the same topology, no more defects than before, and exactly the listed ones */
static void check_mending(scene *s, const answer *a) {
    gxb_boolean_result r[2];
    gxb_defects d[2];
    gxb_boolean *b[2] = {NULL, NULL};
    answer m;
    int plain;
    size_t i, k;
    for (k = 0; k < 2; k++) {
        b[k] = create(s, 1, 0);
        REQUIRE(gxb_boolean_set_mend(b[k], (int)k, NULL) == GX_OK, "mend");
        for (i = 0; i < s->count; i++) {
            const gxb_operand o = operand_of(&s->operand[i]);
            REQUIRE(gxb_boolean_add(b[k], &o, NULL) == GX_OK, "operand %zu refused the second time", i);
        }
        m = evaluate(b[k], s, &r[k]);
        check_same("mended", &m, a, 0);
        d[k] = defects_of(b[k], &r[k]);
        if (3 * r[k].triangle_count < EDGE_TABLE / 2) check_defects(s, &r[k], &d[k]);
    }
    REQUIRE(d[1].count + d[1].mended_count == d[0].count, "%zu defects, %zu mended, %zu left", d[0].count,
            d[1].mended_count, d[1].count);
    if (count_euler(&r[0], &plain) == a->euler && plain) { /* it touches itself nowhere */
        const long euler = count_euler(&r[1], &plain);
        REQUIRE(plain && euler == a->euler, "Euler characteristic %ld, mended %ld%s", a->euler, euler,
                plain ? "" : ", not a manifold any more");
    }
    count.defects += d[0].count;
    count.mended += d[1].mended_count;
    for (k = 0; k < 2; k++) gxb_boolean_destroy(b[k]);
}

static uint64_t allocations_of(const gxb_boolean *b) {
    gxb_statistics s;
    REQUIRE(gxb_boolean_statistics(b, &s, NULL) == GX_OK, "statistics");
    return s.allocations;
}

/* One allocation fails somewhere: the call reports it and works when it is made again. */
static void check_memory(const scene *s, const answer *a, int fine, uint64_t fail_at) {
    memory m = plenty();
    gxb_boolean_desc desc;
    gxb_boolean_result r;
    gxb_components components;
    gxb_defects defects;
    gxb_boolean *b = NULL;
    answer again;
    size_t i;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    fail_from(&m, (size_t)fail_at, 0);
    desc.allocator = allocator_of(&m);
    while ((result = gxb_boolean_create(&desc, &b, NULL)) == GX_ERROR_MEMORY) {}
    if (result == GX_OK) result = gxb_boolean_set_fine(b, fine, NULL);
    for (i = 0; i < s->count && result == GX_OK; i++) {
        const gxb_operand o = operand_of(&s->operand[i]);
        while ((result = gxb_boolean_add(b, &o, NULL)) == GX_ERROR_MEMORY) {}
    }
    while (result == GX_OK && (result = gxb_boolean_evaluate(b, &r, NULL)) == GX_ERROR_MEMORY) result = GX_OK;
    while (result == GX_OK && (result = gxb_boolean_components(b, &components, NULL)) == GX_ERROR_MEMORY)
        result = GX_OK;
    while (result == GX_OK && (result = gxb_boolean_defects(b, &defects, NULL)) == GX_ERROR_MEMORY) result = GX_OK;
    REQUIRE(result == GX_OK, "after a lack of memory: error %d", (int)result);
    again = check_result(b, s, &r);
    check_same("after a lack of memory", &again, a, fine);
    gxb_boolean_destroy(b);
    REQUIRE(m.blocks == NULL, "%zu bytes are left", bytes_alive(&m));
    REQUIRE(!m.wrong && !m.overrun, "a block was released with another size, or written beyond its end");
}

/* 0: too large for the oracle */
static int ask_oracle(const test_case *c, truth *t) {
    oracle_surface surface[CASE_OPERANDS + CASE_SHEETS];
    size_t vertex_count[CASE_OPERANDS + CASE_SHEETS], i;
    scene s = {c->operand, c->operands, WHAT_CHAIN, 0};
    truth_question question;
    for (i = 0; i < c->operands; i++) {
        surface[i].vertices = &c->operand[i].mesh.x[0][0];
        surface[i].triangles = &c->operand[i].mesh.t[0][0];
        surface[i].triangle_count = c->operand[i].mesh.triangles;
        surface[i].solid = c->operand[i].operation != GXB_SPLIT;
        vertex_count[i] = c->operand[i].mesh.vertices;
    }
    question.surface = surface;
    question.vertex_count = vertex_count;
    question.count = c->operands;
    question.planes = ORACLE_PLANES;
    question.pieces = TRUTH_PARTS;
    question.inside = is_inside;
    question.user = &s;
    return truth_ask(&question, t);
}

static void check_oracle(const test_case *c, const answer *a) {
    truth t;
    if (!ask_oracle(c, &t)) return;
    count.oracles++;
    REQUIRE(a->components == t.components, "%zu components, by the oracle %zu", a->components, t.components);
    REQUIRE(a->euler == t.euler, "Euler characteristic %ld, by the oracle %ld", a->euler, t.euler);
    if (t.components <= PARTS) {
        qsort(t.part, t.components, sizeof t.part[0], compare_doubles);
        check_parts("by the oracle", a, t.part, c->fine);
    }
    REQUIRE(near(a->volume, t.volume, t.volume, c->fine), "volume %.17g, by the oracle %.17g", a->volume, t.volume);
}

static void test_boolean(test_case *c, int ask) {
    scene s = {c->operand, 0, WHAT_CHAIN, 0};
    gxb_boolean *b = create(&s, c->fine, 1);
    gxb_boolean_result r;
    answer chain, rules;
    double size;
    add_operands(b, c);
    s.count = c->operands;
    if (s.count == 0) {
        REQUIRE(gxb_boolean_evaluate(b, &r, NULL) == GX_ERROR_SEQUENCE, "no operands, and no error");
        gxb_boolean_destroy(b);
        return;
    }
    chain = evaluate(b, &s, &r);
    size = size_of(c);
    if (ask) check_oracle(c, &chain);
    switch (c->check) {
    case CHECK_VOLUMES:
        if (s.count >= 2 && s.operand[0].operation != GXB_SPLIT && s.operand[1].operation != GXB_SPLIT)
            check_volumes(b, &s, size, c->fine);
        break;
    case CHECK_SAMENESS: check_sameness(c, &chain, c->fine); break;
    case CHECK_RULES:
        rules = combine(&s, c->fine, 0);
        check_same("by rules", &rules, &chain, c->fine);
        break;
    case CHECK_PROVENANCE: check_provenance(&s, &r, c->fine); break;
    case CHECK_AGAIN: check_again(&r, &chain, size); break;
    case CHECK_MENDING: check_mending(&s, &chain); break;
    case CHECK_MEMORY: check_memory(&s, &chain, c->fine, c->number % (allocations_of(b) + 1)); break;
    default: break;
    }
    gxb_boolean_destroy(b);
}

/* ---- the cell complex ---- */

/* The sign that decides whether four points are an element */
static int element_sign(const test_case *c, const uint32_t *n) {
    const rat_mark mark = rat_arena_mark();
    const int sign = big_sign(big_orient3d(c->nodes[n[0]], c->nodes[n[1]], c->nodes[n[2]], c->nodes[n[3]]));
    rat_arena_release(mark);
    return sign;
}

static gxb_complex *create_complex(const test_case *c) {
    gxb_complex *cx = NULL;
    gxb_mesh mesh;
    gx_result result, right = GX_OK;
    uint32_t i;
    mesh.positions = &c->nodes[0][0];
    mesh.node_count = c->node_count;
    mesh.elements = &c->elements[0][0];
    mesh.element_count = c->element_count;
    for (i = 0; i < c->element_count && right == GX_OK; i++) {
        const int sign = element_sign(c, c->elements[i]);
        right = sign > 0 ? GX_OK : sign == 0 ? GX_ERROR_FLAT : GX_ERROR_INVERTED;
    }
    result = gxb_complex_create(&mesh, NULL, &cx, NULL);
    if (right == GX_OK && c->element_count > 1) right = result; /* moved nodes may make elements overlap */
    REQUIRE(result == right, "complex: result %d, should be %d", (int)result, (int)right);
    return cx;
}

/* 0: the triangle has no area */
static int cut_complex(gxb_complex *cx, const test_case *c, size_t cut) {
    const double(*x)[3] = (const double(*)[3])c->operand[cut].mesh.x;
    gxb_triangle t;
    gx_result result = GX_OK;
    uint32_t i;
    memset(&t, 0, sizeof t);
    t.label = (uint32_t)cut;
    t.wall = 1;
    for (i = 0; i < 3 && result == GX_OK; i++) result = gxb_complex_add_point(cx, x[i], &t.point[i]);
    REQUIRE(result == GX_OK, "complex: a point of cut %zu: error %d", cut, (int)result);
    result = gxb_complex_add_plane(cx, &t);
    if (result == GX_ERROR_FLAT) return 0;
    REQUIRE(result == GX_OK, "complex: the plane of cut %zu: error %d", cut, (int)result);
    for (i = 0; i < c->element_count; i++) {
        result = gxb_complex_insert(cx, &t, i, NULL, NULL);
        REQUIRE(result == GX_OK, "complex: cut %zu, element %lu: error %d", cut, (unsigned long)i, (int)result);
    }
    return 1;
}

enum { SAVED = 1 << 21 };
static unsigned char saved[2][SAVED];

static size_t save_complex(gxb_complex *cx, unsigned char *bytes) {
    gxb_stream s;
    memset(&s, 0, sizeof s);
    s.out = bytes;
    s.size = SAVED;
    gxb_complex_save(cx, &s);
    REQUIRE(s.result == GX_OK || s.result == GX_ERROR_CAPACITY, "complex: saving: error %d", (int)s.result);
    return s.result == GX_OK ? s.at : 0;
}

/* A complex that does not trust saved bytes checks all of them, exactly. */
static void load_complex(const test_case *c, const unsigned char *bytes, size_t size) {
    gxb_complex *cx = create_complex(c);
    gxb_stream s;
    gx_result result;
    memset(&s, 0, sizeof s);
    s.in = bytes;
    s.size = size;
    result = gxb_complex_load(cx, &s, 0);
    REQUIRE(result == GX_OK, "complex: loading what was saved: error %d", (int)result);
    gxb_complex_destroy(cx);
}

/* Pieces: leaves joined by open facets */
static size_t count_pieces(gxb_complex *cx) {
    size_t *parent = oracle_singles(cx->leaf_count), i, pieces = 0;
    for (i = 0; i < cx->facet_count; i++) {
        const gxb_facet *f = &cx->facets[i];
        if (f->child == GXB_NONE && !f->wall && f->leaf[0] != GXB_NONE && f->leaf[1] != GXB_NONE)
            oracle_join(parent, f->leaf[0], f->leaf[1]);
    }
    for (i = 0; i < cx->leaf_count; i++) pieces += oracle_root(parent, i) == i;
    free(parent);
    return pieces;
}

static void test_complex(test_case *c, int ask) {
    gxb_complex *cx = create_complex(c);
    scene s = {c->operand, c->operands, WHAT_CHAIN, 0};
    size_t i, size[2];
    answer a;
    if (cx == NULL) return;
    count.complexes++;
    gxb_complex_begin(cx);
    for (i = 0; i < c->element_count; i++)
        REQUIRE(gxb_complex_open_element(cx, (uint32_t)i) == GX_OK, "complex: opening element %zu", i);
    gxb_complex_commit(cx);
    for (i = 1; i < c->operands; i++) {
        if (c->style % 4 == 0) {
            size[0] = save_complex(cx, saved[0]);
            gxb_complex_begin(cx);
            cut_complex(cx, c, i + 1 < c->operands ? i + 1 : 1); /* other operand than the following one */
            gxb_complex_rollback(cx);
            size[1] = save_complex(cx, saved[1]);
            REQUIRE(size[0] == size[1] && memcmp(saved[0], saved[1], size[0]) == 0,
                    "complex: cut %zu, rolled back, left something", i);
        }
        gxb_complex_begin(cx);
        if (cut_complex(cx, c, i))
            gxb_complex_commit(cx);
        else
            gxb_complex_rollback(cx);
    }
    size[0] = save_complex(cx, saved[0]);
    if (size[0] != 0) load_complex(c, saved[0], size[0]);
    a = combine(&s, 0, 0);
    i = count_pieces(cx);
    REQUIRE(i == a.components, "complex: %zu pieces, as a Boolean %zu", i, a.components);
    gxb_complex_destroy(cx);
    if (ask) check_oracle(c, &a);
}

/* ---- cases ---- */

static void test_bytes(const uint8_t *bytes, size_t size) {
    static test_case c;
    const int ask = asked.every > 0 && asked.number++ % asked.every == 0;
    case_decode(bytes, size, &c);
    if (c.complex)
        test_complex(&c, ask);
    else
        test_boolean(&c, ask);
}

static void begin_fuzz(void) {
    asked.number = 0;
    asked.start = rat_arena_mark();
}

static void drop_case(void) { rat_arena_release(asked.start); }

static void end_fuzz(void) { rat_arena_free(); }

static void print_counts(void) {
    printf("%llu evaluations, %llu complexes, %llu operands refused, %llu provenances, %llu oracles, %llu defects, "
           "%llu mended",
           (unsigned long long)count.evaluations, (unsigned long long)count.complexes,
           (unsigned long long)count.refused, (unsigned long long)count.provenances, (unsigned long long)count.oracles,
           (unsigned long long)count.defects, (unsigned long long)count.mended);
}

static int take_option(const char *argument) {
    if (strncmp(argument, "--oracle=", 9) != 0) return 0;
    asked.every = strtoull(argument + 9, NULL, 10);
    return 1;
}
