/* hash_boolean.c - prints a hash of Booleans of random cases: what hashes.sh compares between compilers and flags.

   Coordinates are integers, so that they are the same whatever the flags: lattice points, as they are, with 16 random bits below them (nothing
   coincides), or with one or two far below (nearly everything does). All of a result counts: triangles in their order, where
   they come from, components, Euler characteristics, and as vertices are asked for to the last bit, those, what rounding turned over and what was mended. */
#define GXFEM_BOOLEAN_IMPLEMENTATION
#include "../gxfem_boolean.h"
#include "fuzz_cases.h"

#include <stdio.h>

enum { CASES = 400 };

static uint64_t hash = UINT64_C(14695981039346656037);

static void mix(const void *data, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)data;
    size_t i;
    for (i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
}

#define MIX(array, count) mix(array, (count) * sizeof *(array))

static uint64_t scramble(uint64_t z)
{
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    return z ^ z >> 27;
}

/* Steps of the lattice become 2^16 or 2^44 of them. */
static void place(case_mesh *m, uint64_t seed)
{
    uint32_t i, k;
    for (i = 0; i < m->vertices && seed % 3 != 0; ++i)
        for (k = 0; k < 3; ++k) {
            const uint64_t random = scramble(seed << 32 ^ i << 8 ^ k) >> 20;
            m->x[i][k] = seed % 3 == 1 ? m->x[i][k] * 65536 + (double)(random & 0xffff) : m->x[i][k] * 17592186044416.0 + (double)(random & 3);
        }
}

static void hash_result(const gxb_boolean_result *r, size_t operands)
{
    size_t i;
    mix(&r->vertex_count, sizeof r->vertex_count);
    MIX(r->triangles, 3 * r->triangle_count);
    MIX(r->triangle_operand, r->triangle_count);
    MIX(r->triangle_source, r->triangle_count);
    MIX(r->triangle_reversed, r->triangle_count);
    MIX(r->triangle_component, r->triangle_count);
    MIX(r->component_euler, r->component_count);
    MIX(r->component_side, r->component_count * operands);
    MIX(r->vertices, 3 * r->vertex_count);
    MIX(r->defects, r->defect_count);
    for (i = 0; i < r->vertex_count; ++i) MIX(&r->vertex_origin[i], 1);
}

static void run_case(uint64_t seed)
{
    static test_case c;
    uint8_t bytes[CASE_BYTES];
    gxb_boolean_desc desc;
    gxb_boolean_result r;
    gxb_boolean *b = NULL;
    size_t i, operands = 0;
    int result = 0;
    case_fill(seed, bytes);
    bytes[0] &= 0xf8;               /* a Boolean */
    bytes[1] = 0;                   /* of lattice points */
    case_decode(bytes, CASE_BYTES, &c);
    memset(&desc, 0, sizeof desc);
    desc.fine = 1;
    desc.mend = seed / 3 % 2;
    if (gxb_boolean_create(&desc, &b) != GX_OK) return;
    for (i = 0; i < c.operands; ++i) {
        gxb_operand o;
        memset(&o, 0, sizeof o);
        place(&c.operand[i].mesh, seed + 3 * i);
        o.vertices = &c.operand[i].mesh.x[0][0]; o.vertex_count = c.operand[i].mesh.vertices;
        o.triangles = &c.operand[i].mesh.t[0][0]; o.triangle_count = c.operand[i].mesh.triangles;
        o.operation = c.operand[i].operation; o.rule = c.operand[i].rule;
        result = (int)gxb_boolean_add(b, &o, NULL);
        operands += result == GX_OK;
        mix(&result, sizeof result);
        if (operands == 0) continue;
        result = (int)gxb_boolean_evaluate(b, &r);
        mix(&result, sizeof result);
        if (result == GX_OK) hash_result(&r, operands);
    }
    gxb_boolean_destroy(b);
}

int main(void)
{
    uint64_t seed;
    for (seed = 1; seed <= CASES; ++seed) run_case(seed);
    printf("%08lx%08lx\n", (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffff));
    return 0;
}
