/* hash_boolean.c - prints a hash of Booleans of random cases. hashes.sh compares it between compilers and flags.

   Coordinates are integers, so that they are the same whatever the flags: lattice points as they are, with 16 random
   bits below them (nothing coincides), or with one or two bits far below (nearly everything coincides). The hash
   contains the vertices to the last bit, the number of triangles from each source, the components and their Euler
   characteristics. */
#ifndef GXFEM_LINKED
#define GXFEM_BOOLEAN_IMPLEMENTATION
#endif
#include "../gxfem_boolean.h"
#include "fuzz_cases.h"

#include <stdio.h>

enum { CASES = 400 };

static uint64_t hash = UINT64_C(14695981039346656037);

/* The bytes of a number, the lowest first whatever the machine's order is */
static uint64_t hash_number(uint64_t h, uint64_t number, size_t bytes) {
    size_t i;
    for (i = 0; i < bytes; i++) h = (h ^ (number >> 8 * i & 255)) * UINT64_C(1099511628211);
    return h;
}

static uint64_t hash_double(uint64_t h, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return hash_number(h, bits, sizeof bits);
}

static uint64_t scramble(uint64_t z) {
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    return z ^ z >> 27;
}

/* Steps of the lattice become 2^16 or 2^44 of them. Points off the lattice (copies turned a little) are moved back
   to it first. */
static void place(case_mesh *m, uint64_t seed) {
    uint32_t i, k;
    for (i = 0; i < m->vertices; i++)
        for (k = 0; k < 3; k++) m->x[i][k] = fabs(m->x[i][k]) < 64 ? floor(m->x[i][k] + 0.3) : m->x[i][k];
    for (i = 0; i < m->vertices && seed % 3 != 0; i++)
        for (k = 0; k < 3; k++) {
            const uint64_t random = scramble(seed << 32 ^ i << 8 ^ k) >> 20;
            m->x[i][k] = seed % 3 == 1 ? m->x[i][k] * 65536 + (double)(random & 0xffff)
                                       : m->x[i][k] * 17592186044416.0 + (double)(random & 3);
        }
}

/* A triangle by its origin and its component, without its corners. A flat polygon has several triangulations, and
   the order of boxes decides between them; boxes are sorted by rounded numbers. */
static uint64_t hash_triangle(const gxb_boolean_result *r, const gxb_components *c, size_t t, size_t operands) {
    const uint32_t component = c->triangle[t];
    uint64_t h = UINT64_C(14695981039346656037);
    size_t i;
    h = hash_number(h, r->triangle_operand[t], sizeof *r->triangle_operand);
    h = hash_number(h, r->triangle_source[t], sizeof *r->triangle_source);
    h = hash_number(h, r->triangle_reversed[t], sizeof *r->triangle_reversed);
    h = hash_number(h, (uint64_t)c->euler[component], sizeof *c->euler);
    for (i = 0; i < operands; i++) h = hash_number(h, c->side[component * operands + i], 1);
    return h;
}

/* Sums, since triangles and vertices may be in another order */
static void hash_result(const gxb_boolean_result *r, const gxb_components *c, size_t operands) {
    uint64_t sum = c->count;
    size_t i;
    for (i = 0; i < r->triangle_count; i++) sum += scramble(hash_triangle(r, c, i, operands));
    for (i = 0; i < r->vertex_count; i++) {
        const double *x = r->vertices + 3 * i;
        sum += scramble(hash_double(hash_double(hash_double(1, x[0]), x[1]), x[2]) + r->vertex_origin[i].kind);
    }
    hash = hash_number(hash, sum, sizeof sum);
}

/* Two sheets of 5 x 5 squares, one above the other, closed around: enough triangles to be sorted, at thirds,
   elevenths and 31sts of their box */
static void add_terrain(case_operand *o, uint64_t seed, int axis) {
    static const double at[6] = {0, 2, 5, 6, 9, 11};
    case_mesh *m = &o->mesh;
    uint32_t i, j, level;
    memset(o, 0, sizeof *o);
    o->operation = axis == 0 ? GXB_UNION : GXB_DIFFERENCE;
    for (level = 0; level < 2; level++)
        for (j = 0; j < 6; j++)
            for (i = 0; i < 6; i++) {
                const double height = (double)(scramble(seed << 16 ^ j << 8 ^ i) % 8) + (level == 0 ? 0 : 3);
                const uint32_t v = case_vertex(m, 0, 0, 0);
                m->x[v][axis] = 31 * at[i];
                m->x[v][(axis + 1) % 3] = 31 * at[j];
                m->x[v][(axis + 2) % 3] = 31 * height;
            }
    for (j = 0; j < 5; j++)
        for (i = 0; i < 5; i++)
            for (level = 0; level < 2; level++) {
                const uint32_t a = 36 * level + 6 * j + i, b = a + (level ? 1 : 6), c = a + (level ? 6 : 1);
                case_triangle(m, a, b, c);
                case_triangle(m, b, a + 7, c);
            }
    for (i = 0; i < 5; i++) {
        const uint32_t rim[4][2] = {{i, i + 1}, {31 + i, 30 + i}, {6 * i + 6, 6 * i}, {6 * i + 5, 6 * i + 11}};
        for (j = 0; j < 4; j++) {
            case_triangle(m, rim[j][0], rim[j][1], rim[j][1] + 36);
            case_triangle(m, rim[j][0], rim[j][1] + 36, rim[j][0] + 36);
        }
    }
}

static void run_operands(const test_case *c, uint64_t seed, int moved) {
    gxb_boolean_result r;
    gxb_components parts;
    gxb_boolean *b = NULL;
    size_t i, operands = 0;
    int result = 0;
    if (gxb_boolean_create(NULL, &b, NULL) != GX_OK) return;
    gxb_boolean_set_fine(b, 1, NULL);
    for (i = 0; i < c->operands; i++) {
        static case_mesh m;
        gxb_operand o;
        memset(&o, 0, sizeof o);
        m = c->operand[i].mesh;
        if (moved) place(&m, seed + 3 * i);
        o.vertices = &m.x[0][0];
        o.vertex_count = m.vertices;
        o.triangles = &m.t[0][0];
        o.triangle_count = m.triangles;
        o.operation = c->operand[i].operation;
        o.rule = c->operand[i].rule;
        result = (int)gxb_boolean_add(b, &o, NULL);
        operands += result == GX_OK;
        hash = hash_number(hash, (uint64_t)result, sizeof result);
        if (operands == 0) continue;
        result = (int)gxb_boolean_evaluate(b, &r, NULL);
        if (result == GX_OK) result = (int)gxb_boolean_components(b, &parts, NULL);
        hash = hash_number(hash, (uint64_t)result, sizeof result);
        if (result == GX_OK) hash_result(&r, &parts, operands);
    }
    gxb_boolean_destroy(b);
}

static void run_case(uint64_t seed) {
    static test_case c;
    uint8_t bytes[CASE_BYTES];
    case_fill(seed, bytes, CASE_BYTES);
    bytes[0] &= 0xf8; /* a Boolean */
    bytes[1] = 0;     /* of lattice points */
    case_decode(bytes, CASE_BYTES, &c);
    run_operands(&c, seed, 1);
    if (seed % 20 != 0) return;
    add_terrain(&c.operand[0], seed, 0);
    add_terrain(&c.operand[1], seed + 1, (int)(seed / 20 % 3));
    c.operands = 2;
    run_operands(&c, seed, 0);
}

int main(void) {
    uint64_t seed;
    for (seed = 1; seed <= CASES; seed++) run_case(seed);
    printf("%08lx%08lx\n", (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffff));
    return 0;
}
