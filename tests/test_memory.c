/* test_memory.c - memory runs out. The n-th allocation fails, once or from then on, for n = 0, 1, 2 ... until the
   call succeeds. Every failed call returns GX_ERROR_MEMORY and leaves the body's state hash alone. Nothing leaks,
   released sizes are allocated sizes, nothing is written behind a block. The same call made again gives the topology
   that it gives without a failure. A call may also succeed in spite of a failure, because exact coordinates are only
   cached where there is room; the outcome must then be the same. Allocators that fail once have no reallocate; those
   that fail from then on, or again and again, have one.

   Each test runs in a process of its own (Check's fork), so the tests can be run under valgrind with CK_FORK=no. */
#ifndef GXFEM_LINKED
#define GXFEM_IMPLEMENTATION
#endif
#include "../gxfem.h"
#include "runner.h"
#include "scarce.h"

static void check_empty(const memory *m, const char *what) {
    ck_assert_msg(m->blocks == NULL, "%s: %zu bytes are lost", what, bytes_alive(m));
    ck_assert_msg(!m->wrong, "%s: a block was given back with another size", what);
    ck_assert_msg(!m->overrun, "%s: something was written behind a block", what);
}

/* ---- bodies and cuts ---- */

static const double cube[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
static const uint32_t five[20] = {0, 5, 3, 6, 1, 3, 0, 5, 2, 0, 3, 6, 4, 5, 0, 6, 7, 3, 5, 6};
static const double sheet_a[9] = {0.4, -9, -9, 0.4, 9, -9, 0.4, 0, 19},
                    sheet_b[9] = {-9, 0.45, -9, 9, 0.55, -9, 0, 0.5, 19},
                    sheet_part[9] = {0.1, 0.2, 0.6, 0.7, 0.1, 0.65, 0.3, 0.8, 0.7};
static const uint32_t one_triangle[3] = {0, 1, 2};
static const double box[24] = {-1, -1, 0.3, 0.6, -1, 0.3, -1, 0.6, 0.3, 0.6, 0.6, 0.3,
                               -1, -1, 0.7, 0.6, -1, 0.7, -1, 0.6, 0.7, 0.6, 0.6, 0.7};
static const uint32_t box_triangles[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                           2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

static gx_surface surface(const double *vertices, size_t vertex_count, const uint32_t *triangles, size_t triangle_count,
                          uint32_t kind) {
    gx_surface s;
    memset(&s, 0, sizeof s);
    s.vertices = vertices;
    s.vertex_count = vertex_count;
    s.triangles = triangles;
    s.triangle_count = triangle_count;
    s.kind = kind;
    return s;
}
static gx_surface sheet(const double *vertices) { return surface(vertices, 3, one_triangle, 1, GX_SURFACE_SHEET); }
static gx_surface solid(void) { return surface(box, 8, box_triangles, 12, GX_SURFACE_SOLID); }

typedef struct mesh {
    const double *positions;
    size_t node_count;
    const uint32_t *elements;
    size_t element_count;
} mesh;
static const mesh cube_mesh = {&cube[0][0], 8, five, 5};
static const mesh *mesh_of_bodies = &cube_mesh;
static double support_below, affine_below; /* of bodies made next */
static int is_mixed;                       /* likewise: are they of two materials? */
static const gx_shape *shape_of_bodies;
static gx_allocator allocator; /* of the body made last */

static gx_result create(memory *m, gx_body **body) {
    gx_material materials[2];
    gx_body_desc desc;
    int i;
    memset(&desc, 0, sizeof desc);
    memset(materials, 0, sizeof materials);
    for (i = 0; i < 2; i++) {
        materials[i].elastic.young = i == 0 ? 1e6 : 1e5;
        materials[i].elastic.poisson = 0.4;
        materials[i].density = 1000;
    }
    desc.shape = shape_of_bodies;
    if (desc.shape == NULL) {
        desc.positions = mesh_of_bodies->positions;
        desc.node_count = mesh_of_bodies->node_count;
        desc.elements = mesh_of_bodies->elements;
        desc.element_count = mesh_of_bodies->element_count;
    }
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    if (is_mixed) desc.materials = materials;
    if (is_mixed) desc.material_count = 2;
    desc.support_below = support_below;
    desc.affine_below = affine_below;
    allocator = allocator_of(m);
    desc.allocator = allocator;
    return gx_body_create(&desc, body, NULL);
}

static gx_result cut(gx_body *body, const gx_surface *surfaces, size_t count, double sever_below, int scoped) {
    static const uint32_t first = 0;
    gx_cut_desc desc;
    gx_cut_report report;
    gx_failure failure;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = count;
    desc.sever_below = sever_below;
    if (scoped) {
        desc.scope_fragments = &first;
        desc.scope_fragment_count = 1;
    }
    result = gx_body_cut(body, &desc, &report, &failure);
    ck_assert_int_eq(failure.result, (int)result);
    /* nothing is to blame */
    if (result == GX_ERROR_MEMORY) ck_assert(failure.index == SIZE_MAX && failure.surface == SIZE_MAX);
    /* otherwise the test tries nothing */
    if (result == GX_OK && sever_below > 0) ck_assert_uint_gt(report.severed_links, 0);
    return result;
}

/* ---- the actions ---- */

typedef gx_result (*action)(gx_body *body);

static gx_result cut_sheet(gx_body *body) {
    gx_surface s = sheet(sheet_a);
    return cut(body, &s, 1, 0, 0);
}
static gx_result cut_second_sheet(gx_body *body) {
    gx_surface s = sheet(sheet_b);
    return cut(body, &s, 1, 0, 0);
}
static gx_result cut_part(gx_body *body) {
    gx_surface s = sheet(sheet_part);
    return cut(body, &s, 1, 0, 0);
}
static gx_result cut_solid(gx_body *body) {
    gx_surface s = solid();
    return cut(body, &s, 1, 0, 0);
}
static gx_result cut_keep(gx_body *body) {
    gx_surface s = solid();
    s.kind = GX_SURFACE_KEEP;
    return cut(body, &s, 1, 0, 0);
}
static gx_result cut_scoped(gx_body *body) {
    gx_surface s = sheet(sheet_b);
    return cut(body, &s, 1, 0, 1);
}
static gx_result cut_scoped_solid(gx_body *body) {
    gx_surface s = solid();
    return cut(body, &s, 1, 0, 1);
}
/* Surfaces with scopes of their own beside one without */
static gx_result cut_slots(gx_body *body) {
    static const uint32_t slots[4] = {0, 1, 4, 5};
    gx_surface s[3];
    s[0] = sheet(sheet_b);
    s[1] = solid();
    s[2] = sheet(sheet_part);
    s[0].scope_slots = slots;
    s[0].scope_slot_count = 4;
    s[1].scope_slots = slots + 1;
    s[1].scope_slot_count = 2;
    return cut(body, s, 3, 0, 1);
}
static gx_result cut_severing(gx_body *body) {
    gx_surface s = sheet(sheet_b);
    return cut(body, &s, 1, 0.4, 0);
}
static gx_result cut_all(gx_body *body) {
    gx_surface s[4];
    s[0] = sheet(sheet_a);
    s[1] = solid();
    s[2] = sheet(sheet_b);
    s[3] = sheet(sheet_part);
    return cut(body, s, 4, 0.01, 0);
}

/* A ring of squares of two triangles around z inside the middle element: enough for free planes to divide its leaves */
static gx_result cut_ring(gx_body *body) {
    enum { ROUND = 16, HIGH = 4 };
    double vertices[3 * ROUND * (HIGH + 1)];
    uint32_t triangles[6 * ROUND * HIGH], i, j, n = 0;
    gx_surface s;
    for (j = 0; j <= HIGH; j++)
        for (i = 0; i < ROUND; i++) {
            double *x = vertices + 3 * (ROUND * j + i);
            const double radius = 0.1 + 0.013 * j * (HIGH - j);
            x[0] = 0.511 + radius * cos(6.28318530717958 * i / ROUND);
            x[1] = 0.497 + radius * sin(6.28318530717958 * i / ROUND);
            x[2] = 0.41 + 0.04 * j;
        }
    for (j = 0; j < HIGH; j++)
        for (i = 0; i < ROUND; i++, n += 6) {
            const uint32_t a = ROUND * j + i, b = ROUND * j + (i + 1) % ROUND,
                           corners[6] = {a, b, b + ROUND, a, b + ROUND, a + ROUND};
            memcpy(triangles + n, corners, sizeof corners);
        }
    s = surface(vertices, ROUND * (HIGH + 1), triangles, 2 * ROUND * HIGH, GX_SURFACE_SHEET);
    return cut(body, &s, 1, 0, 0);
}
/* The corner that the solid has, and all of the body, get the second material; what has it comes off. */
static gx_result give_material(gx_body *body) {
    gx_surface s = solid();
    s.kind = GX_SURFACE_MATERIAL;
    s.material = 1;
    return cut(body, &s, 1, 0, 0);
}
static gx_result give_all(gx_body *body) {
    double all[24];
    gx_surface s;
    int i;
    for (i = 0; i < 24; i++) all[i] = box[i] < 0.5 ? -1 : 2;
    s = surface(all, 8, box_triangles, 12, GX_SURFACE_MATERIAL);
    s.material = 1;
    return cut(body, &s, 1, 0, 0);
}
static gx_result release_part(gx_body *body, int scoped) {
    static const uint32_t pair[2] = {1, GX_ANY_MATERIAL}, first = 0;
    gx_cut_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.release = pair;
    desc.release_count = 1;
    desc.scope_fragments = &first;
    desc.scope_fragment_count = scoped ? 1 : 0;
    return gx_body_cut(body, &desc, NULL, NULL);
}
static gx_result release(gx_body *body) { return release_part(body, 0); }
static gx_result release_in_scope(gx_body *body) { return release_part(body, 1); }
static gx_result look(gx_body *body) {
    gx_view view;
    return gx_body_view(body, &view, NULL);
}
static gx_result draw(gx_body *body) {
    gx_skin skin;
    return gx_body_skin(body, NULL, &skin, NULL);
}
static gx_result hold(gx_body *body) {
    const gx_region regions[2] = {gx_region_half_space(2, 1, 0.9), gx_region_half_space(0, -1, 0.2)};
    return gx_body_hold(body, regions, 2, NULL);
}
/* Regions of all other kinds */
static gx_result hold_kinds(gx_body *body) {
    const double low[3] = {-1, -1, -1}, high[3] = {0.45, 0.6, 2}, center[3] = {1, 1, 1};
    const uint32_t nodes[2] = {1, 2};
    const gx_anchor anchor = {0, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}};
    static const double corner[12] = {-1, -1, -1, 3, -1, -1, -1, 3, -1, -1, -1, 3};
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const gx_surface shell = surface(corner, 4, triangles, 4, GX_SURFACE_SOLID);
    gx_region regions[5];
    memset(regions, 0, sizeof regions);
    regions[0] = gx_region_sphere(center, 0.9);
    regions[1] = gx_region_box(low, high);
    regions[2].kind = GX_REGION_SURFACE;
    regions[2].surface = &shell;
    regions[3].kind = GX_REGION_NODES;
    regions[3].nodes = nodes;
    regions[3].node_count = 2;
    regions[4].kind = GX_REGION_ANCHORS;
    regions[4].anchors = &anchor;
    regions[4].anchor_count = 1;
    return gx_body_hold(body, regions, 5, NULL);
}
static gx_result posed_step(gx_body *body) {
    static const double poses[60] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.01};
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.region_poses = poses;
    return gx_body_step(body, &desc, NULL, NULL);
}
static gx_result hold_and_look(gx_body *body) {
    const gx_region region = gx_region_half_space(2, 1, 0.8);
    gx_result result = gx_body_hold(body, &region, 1, NULL);
    return result == GX_OK ? look(body) : result;
}
static gx_result step(gx_body *body) {
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.gravity[2] = -9.81;
    return gx_body_step(body, &desc, NULL, NULL);
}
/* The middle of the first element, between sheets and beside them */
static gx_result anchor(gx_body *body) {
    static const double x[3] = {0.5, 0.5, 0.5};
    gx_anchor a;
    return gx_body_anchor(body, 0, x, &a, NULL);
}
static gx_result anchored_step(gx_body *body) {
    gx_anchor anchors[2] = {{0, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}}, {0, {0.3, 0.4, 0.4}, {0.5, 0.5, 0.5}}};
    const double push[6] = {0, 0, 10, 20, 0, 0};
    gxs_spring springs[2];
    gx_step_desc desc;
    memset(springs, 0, sizeof springs);
    springs[1].stiffness = 100;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.springs = springs;
    desc.spring_anchors = desc.point_anchors = desc.force_anchors = anchors;
    desc.spring_count = desc.point_count = desc.force_count = 2;
    desc.anchor_forces = push;
    return gx_body_step(body, &desc, NULL, NULL);
}
/* A blade's whole life: it comes near, cuts with all that it has passed, and is lifted. One call changes the body. */
static gx_result blade_life(gx_body *body, int waits) {
    static const double before[6] = {-9, -0.4, 0.45, 9, -0.3, 0.55}, behind[6] = {-9, 1.3, 0.45, 9, 1.4, 0.55};
    gx_blade_desc desc;
    gx_blade_report report;
    gx_blade *blade = NULL;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    desc.min_advance = waits ? 100 : 0;
    result = gx_blade_create(body, &desc, &blade, NULL);
    ck_assert((result == GX_OK) == (blade != NULL));
    if (result == GX_OK) result = gx_blade_move(blade, before, 2, NULL, 0, &report, NULL);
    if (result == GX_OK) ck_assert_uint_eq(report.triangle_count, 0);
    if (result == GX_OK) result = gx_blade_move(blade, behind, 2, NULL, 0, &report, NULL);
    if (result == GX_OK) ck_assert((report.triangle_count > 0) == !waits);
    if (waits && result == GX_OK) result = gx_blade_lift(blade, &report, NULL);
    if (result == GX_OK) ck_assert_uint_gt(report.cut.touched_elements, 0);
    gx_blade_destroy(blade);
    return result;
}
static gx_result blade_that_moves(gx_body *body) { return blade_life(body, 0); }
static gx_result blade_that_waits(gx_body *body) { return blade_life(body, 1); }
/* Of a blade that is in the body already */
static gx_result blade_contacts(gx_body *body) {
    gx_blade_contact contacts[16];
    size_t count = 0;
    const gx_result result = gx_blade_contacts(gx_body_blade(body, 0), contacts, 16, &count, NULL);
    ck_assert((result == GX_OK) == (count > 0));
    return result;
}
static gx_result blade_in_scope(gx_body *body) {
    static const double before[6] = {-9, -0.4, 0.45, 9, -0.3, 0.55}, behind[6] = {-9, 1.3, 0.45, 9, 1.4, 0.55};
    static const uint32_t first = 0;
    gx_blade *blade = NULL;
    gx_result result = gx_blade_create(body, NULL, &blade, NULL);
    if (result == GX_OK) result = gx_blade_move(blade, before, 2, &first, 1, NULL, NULL);
    if (result == GX_OK) result = gx_blade_move(blade, behind, 2, &first, 1, NULL, NULL);
    gx_blade_destroy(blade);
    return result;
}
/* The tool is as large as the solid, so that a corner of the cube goes. */
static gx_result carve(gx_body *body) {
    const gx_surface tool = solid();
    gx_cut_report report;
    const gx_result result = gx_body_carve(body, &tool, &report, NULL);
    if (result == GX_OK) ck_assert(report.removed_volume > 0);
    return result;
}
static gx_result hash(gx_body *body) {
    gx_failure failure;
    gx_body_topology_hash(body, &failure);
    return failure.result;
}

static gx_result motion(gx_body *body) {
    gx_motion motions[64];
    return gx_body_motion(body, motions, 64, NULL);
}

enum { POINTS = 27 };
static gx_hit located[POINTS]; /* by the first call since the test set this to 0 */

/* Points inside, near faces of cuts, outside and on faces. Whatever failed before, the hits are the same. */
static gx_result locate(gx_body *body) {
    double points[3 * POINTS];
    gx_hit hits[POINTS];
    gx_result result;
    int i;
    for (i = 0; i < 3 * POINTS; i++) points[i] = 0.11 + 0.37 * (i * 7 % 5) - 0.3 * (i % 81 > 60);
    result = gx_body_locate(body, points, POINTS, hits, NULL);
    if (result != GX_OK) return result;
    if (located[0].copy_count == 0) memcpy(located, hits, sizeof located);
    ck_assert(memcmp(located, hits, sizeof located) == 0);
    return GX_OK;
}
static gx_result locate_all(gx_body *body) {
    static const double corner[3] = {0, 0, 0};
    gx_hit hits[32];
    size_t count;
    return gx_body_locate_all(body, corner, hits, 32, &count, NULL);
}
static gx_result pick(gx_body *body) {
    static const double below[3] = {0.3, 0.35, -1}, up[3] = {0.01, 0.02, 1};
    gx_hit hit;
    const gx_result result = gx_body_pick(body, below, up, &hit, NULL);
    ck_assert(result != GX_OK || hit.triangle != UINT32_MAX);
    return result;
}

/* If a copy was made, it is right. */
static gx_result compare_and_destroy(gx_result result, gx_body *body, gx_body *copy) {
    ck_assert((result == GX_OK) == (copy != NULL));
    if (copy != NULL) ck_assert(gx_body_state_hash(copy) == gx_body_state_hash(body));
    gx_body_destroy(copy);
    return result;
}
static gx_result clone(gx_body *body) {
    gx_body *copy = NULL;
    gx_result result = gx_body_clone(body, &copy, NULL);
    return compare_and_destroy(result, body, copy);
}
static gx_result save_and_load(gx_body *body) {
    static unsigned char bytes[1 << 20];
    gx_body_desc desc;
    gx_body *copy = NULL;
    gx_result result;
    size_t size;
    result = gx_body_save(body, bytes, sizeof bytes, &size, NULL); /* which may have to make the surface of contact */
    if (result != GX_OK) return result;
    memset(&desc, 0, sizeof desc);
    desc.allocator = allocator;
    result = gx_body_load(bytes, size, &desc, &copy, NULL);
    return compare_and_destroy(result, body, copy);
}

static gx_body *source; /* bodies become this one again; its own memory lasts */
static gx_result restore(gx_body *body) {
    const uint64_t state = gx_body_state_hash(source);
    const gx_result result = gx_body_restore(body, source, NULL);
    ck_assert(gx_body_state_hash(source) == state && (result != GX_OK || gx_body_state_hash(body) == state));
    return result;
}

/* Before the action: the history of the body */
static gx_body *prepared(memory *m, const action *before) {
    gx_body *body = NULL;
    ck_assert_int_eq(create(m, &body), GX_OK);
    for (; *before != NULL; before++) ck_assert_int_eq((*before)(body), GX_OK);
    return body;
}

static uint64_t topology(gx_body *body) {
    gx_failure failure;
    uint64_t h = gx_body_topology_hash(body, &failure);
    ck_assert_int_eq(failure.result, GX_OK);
    return h;
}

/* The body after the action without a failure */
typedef struct outcome {
    uint64_t topology, state;
    size_t cells, copies, fragments;
    double volume;
} outcome;

static outcome outcome_of(gx_body *body) {
    outcome o;
    gx_view view;
    memset(&o, 0, sizeof o);
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    o.topology = topology(body);
    o.state = gx_body_state_hash(body);
    o.cells = view.cell_count;
    o.copies = view.copy_count;
    o.fragments = view.fragment_count;
    o.volume = view.volume;
    return o;
}

static void check_failure(gx_result result, uint64_t before, gx_body *body, const char *what, size_t n,
                          int from_then_on) {
    ck_assert_msg(result == GX_ERROR_MEMORY, "%s, allocation %zu%s: %s", what, n, from_then_on ? " and on" : "",
                  gx_result_text(result));
    ck_assert_msg(gx_body_state_hash(body) == before, "%s, allocation %zu%s: the body has changed", what, n,
                  from_then_on ? " and on" : "");
}

static void check_outcome(gx_body *body, const outcome *truth, const char *what, size_t n) {
    outcome o = outcome_of(body);
    ck_assert_msg(o.topology == truth->topology, "%s, allocation %zu: another topology", what, n);
    ck_assert_msg(o.cells == truth->cells && o.copies == truth->copies && o.fragments == truth->fragments,
                  "%s, allocation %zu: %zu cells, %zu copies, %zu fragments", what, n, o.cells, o.copies, o.fragments);
    ck_assert_msg(o.state == truth->state && o.volume == truth->volume, "%s, allocation %zu: another state", what, n);
}

/* Which allocation fails next: each, or each of the first and then every so many-th, others in each sweep: under a
   sanitizer, and in large bodies that ask for memory wherever an array could grow */
#ifdef TIGHT
enum { FIRST = 50, LARGE = 47, APART = 7 };
#else
enum { FIRST = 100, LARGE = 1, APART = 1 };
#endif
static size_t sweeps, stride = FEWER * APART;
static size_t next(size_t n) {
    if (n + 1 == FIRST) return FIRST + 7 * sweeps++ % stride;
    return n < FIRST ? n + 1 : n + stride;
}

/* A new body for every n */
static void sweep_fresh(const char *what, const action *before, action act, const outcome *truth, int from_then_on) {
    size_t n;
    for (n = 0;; n = next(n)) {
        memory m;
        gx_body *body;
        gx_result result;
        uint64_t state;
        m = plenty();
        m.grows = from_then_on;
        body = prepared(&m, before);
        state = gx_body_state_hash(body);
        fail_from(&m, n, from_then_on);
        result = act(body);
        if (!m.failed) {
            ck_assert_int_eq(result, GX_OK);
            gx_body_destroy(body);
            check_empty(&m, what);
            return;
        }
        if (result != GX_OK) check_failure(result, state, body, what, n, from_then_on);
        never_fail(&m);
        if (result != GX_OK) ck_assert_int_eq(act(body), GX_OK);
        check_outcome(body, truth, what, n);
        gx_body_destroy(body);
        check_empty(&m, what);
    }
}

/* One body on which the same call fails again and again, at ever later allocations */
static void sweep_stubborn(const char *what, const action *before, action act, const outcome *truth) {
    memory m;
    gx_body *body;
    gx_result result = GX_ERROR_MEMORY;
    uint64_t state;
    size_t n;
    m = plenty();
    m.grows = 1;
    body = prepared(&m, before);
    state = gx_body_state_hash(body);
    for (n = 0; result != GX_OK; n = next(n)) {
        fail_from(&m, n, n % 2 == 1);
        result = act(body);
        if (result != GX_OK) check_failure(result, state, body, what, n, n % 2 == 1);
    }
    never_fail(&m);
    check_outcome(body, truth, what, n);
    gx_body_destroy(body);
    check_empty(&m, what);
}

/* All three sweeps of one action */
static void sweep(const char *what, const action *before, action act) {
    memory m;
    gx_body *body;
    outcome truth;
    m = plenty();
    body = prepared(&m, before);
    ck_assert_int_eq(act(body), GX_OK);
    truth = outcome_of(body);
    gx_body_destroy(body);
    check_empty(&m, what);
    sweep_fresh(what, before, act, &truth, 0);
    sweep_fresh(what, before, act, &truth, 1);
    sweep_stubborn(what, before, act, &truth);
}

/* A blade that stays in the middle of the body */
static gx_result blade_inside(gx_body *body) {
    static const double before[6] = {-9, -0.4, 0.45, 9, -0.3, 0.55}, inside[6] = {-9, 0.6, 0.45, 9, 0.7, 0.55};
    gx_blade *blade = NULL;
    gx_result result = gx_blade_create(body, NULL, &blade, NULL);
    if (result == GX_OK) result = gx_blade_move(blade, before, 2, NULL, 0, NULL, NULL);
    return result == GX_OK ? gx_blade_move(blade, inside, 2, NULL, 0, NULL, NULL) : result;
}

static const action nothing[] = {NULL}, with_a_blade[] = {blade_inside, NULL}, after_a_cut[] = {cut_sheet, NULL},
                    held_kinds[] = {hold_kinds, cut_sheet, NULL}, after_two[] = {cut_sheet, cut_part, look, NULL},
                    after_solid[] = {cut_solid, NULL}, after_a_ring[] = {cut_ring, NULL},
                    held[] = {hold, cut_sheet, step, NULL}, drawn[] = {cut_sheet, draw, NULL}, found[] = {locate, NULL},
                    found_and_moved[] = {cut_sheet, locate_all, step, NULL},
                    cut_since[] = {locate_all, cut_sheet, NULL},
                    drawn_and_cut[] = {draw, cut_sheet, draw, cut_second_sheet, NULL};

static void sweep_creation(void) {
    int from_then_on;
    size_t n;
    for (from_then_on = 0; from_then_on < 2; from_then_on++)
        for (n = 0;; n = next(n)) {
            memory m;
            gx_body *body = NULL;
            gx_result result;
            m = plenty();
            fail_from(&m, n, from_then_on);
            result = create(&m, &body);
            ck_assert_msg(result == (body == NULL ? GX_ERROR_MEMORY : GX_OK), "creation, allocation %zu: %s", n,
                          gx_result_text(result));
            if (shape_of_bodies == NULL) ck_assert((body == NULL) == m.failed); /* caches of a cut may be left out */
            gx_body_destroy(body);
            check_empty(&m, "creation");
            if (m.failed) continue;
            ck_assert_uint_gt(n, 5);
            break;
        }
}

START_TEST(creation) { sweep_creation(); }
END_TEST

/* Of a shape of two materials, one in the other */
START_TEST(creation_of_a_shape) {
    double inner[24];
    gx_surface surfaces[2];
    gx_shape shape;
    int i;
    for (i = 0; i < 24; i++) inner[i] = -0.2 + 0.5 * (box[i] + 0.2) + 0.01 * (i % 3);
    surfaces[0] = solid();
    surfaces[1] = surface(inner, 8, box_triangles, 12, GX_SURFACE_SOLID);
    surfaces[1].material = 1;
    memset(&shape, 0, sizeof shape);
    shape.surfaces = surfaces;
    shape.surface_count = 2;
    shape.cells = 1;
    shape_of_bodies = &shape;
    is_mixed = 1;
    sweep_creation();
    shape_of_bodies = NULL;
    is_mixed = 0;
}
END_TEST

START_TEST(materials) {
    static const action given[] = {give_material, NULL}, released[] = {give_material, release, NULL};
    is_mixed = 1;
    sweep("a material", nothing, give_material);
    sweep("a material of all", after_a_cut, give_all);
    sweep("a release", given, release);
    sweep("a release in a scope", given, release_in_scope);
    sweep("a cut across materials", given, cut_second_sheet);
    sweep("a cut of what was released", released, cut_second_sheet);
    is_mixed = 0;
}
END_TEST

START_TEST(first_cut) { sweep("a sheet", nothing, cut_sheet); }
END_TEST

START_TEST(partial_cut) { sweep("a part of a sheet", nothing, cut_part); }
END_TEST

START_TEST(cut_of_many_triangles) {
    stride *= LARGE;
    sweep("a ring", nothing, cut_ring);
    sweep("a sheet after a ring", after_a_ring, cut_second_sheet);
    stride /= LARGE;
}
END_TEST

START_TEST(solid_cut) {
    sweep("a solid", nothing, cut_solid);
    sweep("a solid that keeps", nothing, cut_keep);
}
END_TEST

START_TEST(cut_of_a_cut_body) {
    sweep("a second sheet", after_a_cut, cut_second_sheet);
    sweep("a solid after sheets", after_two, cut_solid);
    sweep("a sheet after a solid", after_solid, cut_second_sheet);
    sweep("the same sheet again", after_a_cut, cut_sheet);
}
END_TEST

START_TEST(scoped_cut) {
    sweep("a scoped sheet", after_a_cut, cut_scoped);
    sweep("a scoped solid", after_a_cut, cut_scoped_solid);
    sweep("surfaces in slots", after_a_cut, cut_slots);
}
END_TEST

START_TEST(blades) {
    stride *= 10 * LARGE; /* a move asks for memory some 100,000 times */
    sweep("a blade", nothing, blade_that_moves);
    sweep("a blade that waits", nothing, blade_that_waits);
    sweep("a blade in a cut body that has moved", held, blade_that_moves);
    sweep("a blade with a scope", after_a_cut, blade_in_scope);
    sweep("a tool", nothing, carve);
    sweep("a tool in a cut body that has moved", held, carve);
    sweep("contacts of a blade", with_a_blade, blade_contacts);
    sweep("a clone of a body with a blade", with_a_blade, clone);
    sweep("loading a body with a blade", with_a_blade, save_and_load);
    stride /= 10 * LARGE;
}
END_TEST

START_TEST(severing_cut) { sweep("a severing sheet", after_two, cut_severing); }
END_TEST

START_TEST(many_surfaces) { sweep("four surfaces", nothing, cut_all); }
END_TEST

START_TEST(view_hold_skin_hash) {
    sweep("a view", after_a_cut, look);
    sweep("a skin", after_a_cut, draw);
    sweep("a skin of an uncut body", nothing, draw);
    sweep("a skin after a solid", after_solid, draw);
    sweep("a cut of a body with a skin", drawn, cut_second_sheet);
    sweep("a solid in a body with a skin", drawn, cut_solid);
    sweep("a skin that follows a cut", drawn_and_cut, draw);
    sweep("a hash", after_a_cut, hash);
    sweep("an anchor", after_a_ring, anchor);
}
END_TEST

START_TEST(points_and_rays) {
    static const struct {
        const char *what;
        const action *before;
        action act;
    } calls[] = {{"locating", nothing, locate},
                 {"locating after a cut", after_a_cut, locate},
                 {"locating after a step", found_and_moved, locate},
                 {"locating after a cut of a located body", cut_since, locate},
                 {"locating all", after_solid, locate_all},
                 {"a cut of a located body", found, cut_all},
                 {"a ray", drawn, pick}};
    size_t i;
    for (i = 0; i < sizeof calls / sizeof *calls; i++) {
        memset(located, 0, sizeof located);
        sweep(calls[i].what, calls[i].before, calls[i].act);
    }
}
END_TEST

/* A region may be taken even if the view after it fails: the state is then the one with the region. */
START_TEST(holding) {
    sweep("a hold", after_a_cut, hold);
    sweep("a hold of all kinds", after_a_cut, hold_kinds);
    sweep("a view of what is held", held_kinds, look);
    sweep("a step with poses", held_kinds, posed_step);
    sweep("cloning what is held", held_kinds, clone);
    {
        memory m;
        gx_body *body;
        gx_view view;
        size_t n, i, count = 0;
        gx_result result = GX_ERROR_MEMORY;
        m = plenty();
        memset(&view, 0, sizeof view);
        body = prepared(&m, after_a_cut);
        for (n = 0; result != GX_OK; n++) {
            fail_from(&m, n, 0);
            result = hold_and_look(body);
            ck_assert(result == GX_OK || (m.failed && result == GX_ERROR_MEMORY));
        }
        never_fail(&m);
        ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
        for (i = 0; i < view.copy_count; i++) count += view.copy_held[i];
        ck_assert_uint_gt(count, 0);
        gx_body_destroy(body);
        check_empty(&m, "hold and look");
    }
}
END_TEST

START_TEST(stepping) {
    sweep("a first step", nothing, step);
    sweep("a step after a cut", after_a_cut, step);
    sweep("a further step", held, step);
    sweep("a step with anchors", after_a_cut, anchored_step);
    sweep("a further step with anchors", held, anchored_step);
}
END_TEST

static gx_result step_by_quality(gx_body *body) {
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.gravity[2] = -9.81;
    desc.quality = 0.03;
    return gx_body_step(body, &desc, NULL, NULL);
}

START_TEST(stepping_by_quality) {
    static const action stepped[] = {step_by_quality, NULL};
    sweep("a first step by quality", nothing, step_by_quality);
    sweep("a further step by quality", stepped, step_by_quality);
}
END_TEST

static gx_result step_bdf2(gx_body *body) {
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.gravity[2] = -9.81;
    desc.integrator = GXS_BDF2;
    return gx_body_step(body, &desc, NULL, NULL);
}
/* ---- contact ---- */

/* The upper piece lies on the lower one, which is held. */
static gx_result hold_low(gx_body *body) {
    const gx_region region = gx_region_half_space(1, -1, 0.1);
    return gx_body_hold(body, &region, 1, NULL);
}
static gx_result touch(gx_body *body) {
    gx_contact_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.friction = 0.5;
    return gx_body_contact(body, &desc, NULL);
}
static gx_result press(gx_body *body) {
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.gravity[1] = -9.81;
    desc.gravity[0] = 1;
    return gx_body_step(body, &desc, NULL, NULL);
}
static gx_result events(gx_body *body) {
    gx_contact_event told[16];
    size_t count = 0;
    const gx_result result = gx_body_contact_events(body, told, 16, &count, NULL);
    ck_assert((result == GX_OK) == (count > 0));
    return result;
}

START_TEST(contact) {
    static const action pressed[] = {cut_second_sheet, hold_low, touch, press, press, press, look, NULL},
                        cut_since_then[] = {cut_second_sheet, hold_low, touch, press, press, press, cut_sheet, NULL},
                        others[] = {cut_second_sheet, hold_low, touch, press, cut_sheet, NULL};
    static const action apart[] = {cut_second_sheet, hold_low, touch, NULL};
    memory m = plenty();
    sweep("a step in contact", pressed, press);
    sweep("events", pressed, events);
    sweep("cloning contact", pressed, clone);
    sweep("cloning contact after a cut", cut_since_then, clone);
    sweep("loading contact after a cut", cut_since_then, save_and_load);
    source = prepared(&m, cut_since_then);
    sweep("restoring contact after a cut", others, restore);
    sweep("restoring contact", pressed, restore);
    gx_body_destroy(source);
    source = prepared(&m, apart);
    sweep("restoring what does not touch", pressed, restore);
    sweep("restoring what does not touch in a body with other cuts", cut_since_then, restore);
    gx_body_destroy(source);
    check_empty(&m, "contact");
}
END_TEST

/* ---- thin pieces, whose copies are affine ---- */

static gx_result cut_thinner(gx_body *body) {
    static const double low[9] = {-9, -9, 0.3, 9, -9, 0.31, 0, 19, 0.3},
                        high[9] = {-9, -9, 0.5, 9, -9, 0.49, 0, 19, 0.5};
    gx_surface s[2];
    s[0] = sheet(low);
    s[1] = sheet(high);
    return cut(body, s, 2, 0, 0);
}
static gx_result ask_model(gx_body *body) {
    gxs_model model;
    return gx_body_model(body, &model, NULL);
}
/* Forces and targets of all copies */
static gx_result driven_step(gx_body *body) {
    static double zero[3 * 1000];
    gx_step_desc desc;
    gx_view view;
    memset(&desc, 0, sizeof desc);
    desc.dt = 0.01;
    desc.forces = desc.targets = zero;
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    desc.epoch = view.epoch;
    return gx_body_step(body, &desc, NULL, NULL);
}

static const action moved[] = {hold, cut_sheet, look, step_bdf2, cut_solid, NULL},
                    unmoved[] = {cut_sheet, look, cut_solid, NULL};

/* A step whose model is brought up to date. If that fails, the next step makes it anew, so that motion is the same to
   the solver's tolerance only. */
static void sweep_update(const char *what, const action *before, action act) {
    memory m = plenty(), other = plenty();
    gx_body *body = prepared(&m, before), *plain = prepared(&other, before);
    gx_result result = GX_ERROR_MEMORY;
    size_t n, i;
    ck_assert_int_eq(act(plain), GX_OK);
    for (n = 0; result != GX_OK; n = next(n)) {
        gx_body *copy = prepared(&m, before);
        uint64_t state = gx_body_state_hash(copy);
        fail_from(&m, n, n % 2 == 1);
        result = act(copy);
        if (result != GX_OK) check_failure(result, state, copy, what, n, n % 2 == 1);
        if (m.failed) result = GX_ERROR_MEMORY;
        never_fail(&m);
        if (result != GX_OK) ck_assert_int_eq(act(copy), GX_OK);
        gx_body_destroy(body);
        body = copy;
        {
            gx_view own, truth;
            ck_assert_int_eq(gx_body_view(body, &own, NULL), GX_OK);
            ck_assert_int_eq(gx_body_view(plain, &truth, NULL), GX_OK);
            ck_assert_uint_eq(own.copy_count, truth.copy_count);
            for (i = 0; i < 3 * own.copy_count; i++)
                ck_assert_double_le(fabs(own.displacement[i] - truth.displacement[i]), 1e-3);
        }
    }
    gx_body_destroy(body);
    gx_body_destroy(plain);
    check_empty(&m, what);
    check_empty(&other, what);
}

START_TEST(thin_pieces) {
    static const action thinner[] = {hold, step, cut_thinner, NULL},
                        thinner_yet[] = {hold, cut_thinner, step, cut_sheet, NULL},
                        in_motion[] = {hold, cut_thinner, look, step, NULL};
    memory m = plenty();
    gx_body *body;
    gx_view view;
    affine_below = 1;
    body = prepared(&m, in_motion);
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    ck_assert(view.copy_affine != NULL);
    gx_body_destroy(body);
    sweep("a cut that makes thin pieces", held, cut_thinner);
    sweep_update("a step after it", thinner, step);
    sweep_update("a step of thin pieces that were cut", thinner_yet, step);
    sweep_update("a model of thin pieces that were cut", thinner_yet, ask_model);
    sweep("a step with forces and targets", in_motion, driven_step);
    sweep("a step with anchors", in_motion, anchored_step);
    sweep("a blade in thin pieces", in_motion, blade_that_moves);
    affine_below = 0;
}
END_TEST

START_TEST(motions) { sweep("motions", after_a_cut, motion); }
END_TEST

START_TEST(copies) {
    sweep("a clone", nothing, clone);
    sweep("a clone of a cut body", moved, clone);
    sweep("loading", nothing, save_and_load);
    sweep("loading a cut body", moved, save_and_load);
}
END_TEST

/* To a body with other cuts, to one with another state only, to one with more room than before, to one with blades */
START_TEST(restoring) {
    static const action with_blades[] = {cut_sheet, blade_inside, blade_inside, NULL};
    static const action *const sources[5] = {nothing, moved, moved, moved, with_blades}, *const bodies[5] = {
                                                                                             moved, after_a_cut, moved,
                                                                                             unmoved, after_a_cut};
    memory m;
    int i;
    for (i = 0; i < 5; i++) {
        m = plenty();
        source = prepared(&m, sources[i]);
        if (i == 2) ck_assert_int_eq(step_bdf2(source), GX_OK);
        sweep("restoring", bodies[i], restore);
        gx_body_destroy(source);
        check_empty(&m, "restoring");
    }
}
END_TEST

START_TEST(cut_after_steps) { sweep("a cut between steps", held, cut_second_sheet); }
END_TEST

/* A solid removes the element at corner 1 and its copy of that corner. */
static gx_result cut_corner(gx_body *body) {
    static const double corner[12] = {-1, -1, 0, 3, 3, 0, 3, -1, 4, 3, -9, -9};
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    gx_surface s = surface(corner, 4, triangles, 4, GX_SURFACE_SOLID);
    return cut(body, &s, 1, 0, 0);
}
static const action stepped_and_smaller[] = {step, cut_corner, NULL};

/* A step of a body that has fewer copies than at the step before stays in its memory. */
START_TEST(step_with_fewer_copies) {
    memory m;
    gx_body *body;
    gx_view view;
    m = plenty();
    body = prepared(&m, stepped_and_smaller);
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    ck_assert_uint_lt(view.copy_count, 8);
    gx_body_destroy(body);
    sweep("a step with fewer copies", stepped_and_smaller, step);
}
END_TEST

/* Next to the face x = 0: copies with next to nothing around them */
static gx_result cut_thin(gx_body *body) {
    static const double thin[9] = {0.01, -9, -9, 0.012, 9, -9, 0.011, 0, 19};
    gx_surface s = sheet(thin);
    return cut(body, &s, 1, 0, 0);
}

/* Two fans around the edge from node 0 to node 1, which join in that edge only */
enum { FAN = 60, FANS_NODES = 2 + 2 * (FAN + 1) };
static double fan_angle(int fan, double i) { return 0.2 + 2.6 * i / FAN + 3.14159 * fan; }

static gx_result cut_fan(gx_body *body) {
    double x[9] = {0, 0, -9, 0, 0, 9, 0, 0, 0.5};
    gx_surface s = sheet(x);
    x[6] = 3 * cos(fan_angle(0, FAN / 2 + 0.5));
    x[7] = 3 * sin(fan_angle(0, FAN / 2 + 0.5));
    return cut(body, &s, 1, 0, 0);
}

/* A cut through an edge of many elements that fails leaves all of their copies as they were. */
START_TEST(cut_of_a_fan) {
    static double x[3 * FANS_NODES] = {0, 0, 0, 0, 0, 1};
    static uint32_t elements[4 * 2 * FAN];
    static const mesh fans = {x, FANS_NODES, elements, 2 * FAN};
    uint32_t n = 2, *e = elements;
    int fan, i;
    for (fan = 0; fan < 2; fan++)
        for (i = 0; i <= FAN; i++, n++) {
            x[3 * n] = cos(fan_angle(fan, i));
            x[3 * n + 1] = sin(fan_angle(fan, i));
            x[3 * n + 2] = 0.5;
            if (i > 0) {
                e[0] = 0;
                e[1] = n - 1;
                e[2] = n;
                e[3] = 1;
                e += 4;
            }
        }
    mesh_of_bodies = &fans;
    stride *= LARGE;
    sweep("a sheet in a fan", nothing, cut_fan);
    stride /= LARGE;
    mesh_of_bodies = &cube_mesh;
}
END_TEST

/* Two elements that share an edge. Cuts through it, with and without a scope, and all that looks at it */
static gx_result cut_pinch(gx_body *body) {
    static const double x[9] = {-8, -16, -9, -8, -16, 19, 12, 24, 5};
    gx_surface s = sheet(x);
    return cut(body, &s, 1, 0, 0);
}
static gx_result cut_pinch_scoped(gx_body *body) {
    static const double x[9] = {-8, -16, -9, -8, -16, 19, 12, 24, 5};
    gx_surface s = sheet(x);
    return cut(body, &s, 1, 0, 1);
}
static const action low_pinch[] = {cut_corner, NULL};

START_TEST(cut_of_a_pinch) {
    static const double x[6][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    static const uint32_t elements[8] = {0, 1, 2, 3, 0, 1, 4, 5};
    static const mesh pair = {&x[0][0], 6, elements, 2};
    mesh_of_bodies = &pair;
    sweep("a sheet through a shared edge", nothing, cut_pinch);
    sweep("a scoped sheet through a shared edge", nothing, cut_pinch_scoped);
    sweep("a sheet across a shared edge", nothing, cut_part);
    sweep("a skin at a shared edge", nothing, draw);
    sweep("a hash at a shared edge", low_pinch, hash);
    mesh_of_bodies = &cube_mesh;
}
END_TEST

/* Memory runs out while copies with little around them are made to follow others. */
START_TEST(followers) {
    static const action thin[] = {cut_thin, NULL};
    memory m;
    gx_body *body;
    gxs_model model;
    support_below = 0.2;
    m = plenty();
    body = prepared(&m, thin);
    ck_assert_int_eq(gx_body_model(body, &model, NULL), GX_OK);
    ck_assert_uint_gt(model.constraint_count, 0);
    gx_body_destroy(body);
    sweep("a step with followers", thin, step);
    support_below = 0;
}
END_TEST

/* If there is no memory for a model, a body can still step: it moves as if no model had been requested. */
START_TEST(step_after_a_failed_model) {
    static const action one_step[] = {step, NULL}, two_steps[] = {step, step, NULL};
    gxs_model model;
    memory m;
    gx_body *body;
    gx_result result;
    uint64_t state;
    int from_then_on;
    size_t n;
    m = plenty();
    body = prepared(&m, two_steps);
    state = gx_body_state_hash(body);
    gx_body_destroy(body);
    for (from_then_on = 0; from_then_on < 2; from_then_on++)
        for (n = 0, result = GX_ERROR_MEMORY; result != GX_OK; n = next(n)) {
            body = prepared(&m, one_step);
            fail_from(&m, n, from_then_on);
            result = gx_body_model(body, &model, NULL);
            ck_assert_int_eq(result, m.failed ? GX_ERROR_MEMORY : GX_OK);
            never_fail(&m);
            ck_assert_int_eq(step(body), GX_OK);
            ck_assert_msg(gx_body_state_hash(body) == state, "allocation %zu: another motion", n);
            gx_body_destroy(body);
            check_empty(&m, "a step after a model");
        }
}
END_TEST

/* ---- strokes ---- */

/* A tower of cubes, each of five elements */
enum { STOREYS = 7, MOST_STOREYS = 60 };
static const mesh *tower(uint32_t storeys) {
    static double x[3 * 4 * (MOST_STOREYS + 1)];
    static uint32_t elements[20 * MOST_STOREYS];
    static mesh m = {x, 0, elements, 0};
    static const uint32_t mirror[8] = {1, 0, 3, 2, 5, 4, 7, 6};
    uint32_t i, k;
    for (i = 0; i < 4 * (storeys + 1); i++) {
        x[3 * i] = i % 2;
        x[3 * i + 1] = i / 2 % 2;
        x[3 * i + 2] = i / 4;
    }
    for (i = 0; i < storeys; i++)
        for (k = 0; k < 20; k++) {
            const uint32_t odd = k % 4 > 1 ? k ^ 1 : k; /* a mirrored element has two of its nodes exchanged */
            elements[20 * i + k] = 4 * i + (i % 2 ? mirror[five[odd]] : five[k]);
        }
    m.node_count = 4 * ((size_t)storeys + 1);
    m.element_count = 5 * (size_t)storeys;
    return &m;
}

/* Parts the upper half of the tower into two arms. */
static gx_result cut_slit(gx_body *body) {
    static const double slit[9] = {0.45, -9, 2.1, 0.47, 9, 2.1, 0.46, 0.5, 99};
    gx_surface s = sheet(slit);
    return cut(body, &s, 1, 0, 0);
}

/* Steps after a cut that ran out of memory and was made again are those after a cut that did not. */
START_TEST(steps_after_a_failed_cut) {
    static const action in_motion[] = {hold, cut_slit, step, NULL};
    memory m;
    gx_body *body;
    int failed;
    uint64_t state;
    size_t n;
    mesh_of_bodies = tower(MOST_STOREYS);
    m = plenty();
    body = prepared(&m, in_motion);
    ck_assert(cut_part(body) == GX_OK && step(body) == GX_OK && step(body) == GX_OK);
    state = gx_body_state_hash(body);
    gx_body_destroy(body);
    for (n = 0, failed = 1; failed; n = next(n)) {
        gx_result result;
        body = prepared(&m, in_motion);
        fail_from(&m, n, 0);
        result = cut_part(body);
        failed = m.failed;
        never_fail(&m);
        if (result != GX_OK) ck_assert_int_eq(cut_part(body), GX_OK);
        ck_assert(step(body) == GX_OK && step(body) == GX_OK);
        ck_assert_msg(gx_body_state_hash(body) == state, "allocation %zu: another motion", n);
        gx_body_destroy(body);
        check_empty(&m, "steps after a cut");
    }
    mesh_of_bodies = &cube_mesh;
}
END_TEST

enum { MOST_MOVES = 12 };
typedef struct stroke {
    const char *what;
    const action *before;
    double min_advance;
    int count;
    double y[MOST_MOVES], z[MOST_MOVES]; /* of the edge, which lies along x */
    double shift[MOST_MOVES];            /* of the body along y, before a move */
} stroke;

static const action in_a_slit[] = {cut_slit, NULL};
static const stroke strokes[] = {
    {"down both arms",
     in_a_slit,
     0.7,
     11,
     {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5},
     {7.7, 6.8, 6.1, 5.6, 5.0, 4.3, 3.6, 3.2, 2.4, 1.3, -0.7},
     {0}},
    {"up into both arms",
     in_a_slit,
     0.7,
     11,
     {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5},
     {-0.7, 0.4, 1.6, 2.3, 2.8, 3.3, 4.0, 4.6, 5.5, 6.4, 7.8},
     {0}},
    {"out of its cut through the side",
     nothing,
     0.7,
     8,
     {0.5, 0.5, 0.5, 0.5, 0.8, 0.9, 1.2, 1.8},
     {7.6, 6.7, 6.0, 5.3, 5.3, 4.9, 4.9, 4.9},
     {0}},
    {"in a body that is shifted",
     nothing,
     0,
     5,
     {0.5, 0.5, 2.9, 2.9, 2.9},
     {7.6, 5.1, 3.6, 1.4, -0.9},
     {0, 0, 2.4, 0, 0}},
};
enum { STROKES = sizeof strokes / sizeof *strokes };

static void shift_body(gx_body *body, double y) {
    gx_view view;
    size_t i;
    if (!(y > 0)) return;
    ck_assert_int_eq(gx_body_view(body, &view, NULL), GX_OK);
    for (i = 0; i < view.copy_count; i++) view.displacement[3 * i + 1] += y;
}

static gx_result move_along(gx_body *body, const stroke *s, int k) {
    const double edge[6] = {-9, s->y[k], s->z[k], 9, s->y[k] + 0.03, s->z[k] + 0.05};
    gx_blade *blade = gx_body_blade(body, 0);
    return k == s->count ? gx_blade_lift(blade, NULL, NULL) : gx_blade_move(blade, edge, 2, NULL, 0, NULL, NULL);
}

/* At each move of a stroke memory runs out again and again, at ever later allocations. The body is as it was, and the
   blade goes on as if nothing had been. */
START_TEST(memory_of_strokes) {
    const stroke *s = &strokes[_i];
    memory m = plenty(), other = plenty();
    gx_body *body, *plain;
    gx_blade_desc desc;
    gx_blade *blade;
    size_t failures = 0;
    int k;
    memset(&desc, 0, sizeof desc);
    desc.min_advance = s->min_advance;
    mesh_of_bodies = tower(STOREYS);
    body = prepared(&m, s->before);
    plain = prepared(&other, s->before);
    ck_assert_int_eq(gx_blade_create(body, &desc, &blade, NULL), GX_OK);
    ck_assert_int_eq(gx_blade_create(plain, &desc, &blade, NULL), GX_OK);
    for (k = 0; k <= s->count; k++) {
        gx_result result = GX_ERROR_MEMORY;
        uint64_t state;
        size_t n;
        shift_body(body, s->shift[k]);
        shift_body(plain, s->shift[k]);
        state = gx_body_state_hash(body);
        for (n = 0; result != GX_OK; n++) {
            fail_from(&m, n, n % 2 == 1);
            result = move_along(body, s, k);
            if (result == GX_OK) break;
            check_failure(result, state, body, s->what, n, n % 2 == 1);
            failures++;
        }
        never_fail(&m);
        ck_assert_int_eq(move_along(plain, s, k), GX_OK);
        ck_assert_msg(gx_body_state_hash(body) == gx_body_state_hash(plain), "%s, move %d: another state", s->what, k);
    }
    ck_assert_uint_gt(failures, 50);
    gx_body_destroy(body);
    gx_body_destroy(plain);
    check_empty(&m, s->what);
    mesh_of_bodies = &cube_mesh;
}
END_TEST

START_TEST(solidifying) {
    static const double square[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const uint32_t two[6] = {0, 1, 2, 0, 2, 3};
    gx_surface s = surface(square, 4, two, 2, GX_SURFACE_SHEET);
    gx_result result = GX_ERROR_MEMORY;
    memory m;
    gx_allocator a;
    double vertices[24];
    uint32_t triangles[48];
    size_t n, v = 99, t = 98;
    m = plenty();
    a = allocator_of(&m);
    for (n = 0; result != GX_OK; n++) {
        fail_from(&m, n, 0);
        result = gx_surface_solidify(&s, 0.1, vertices, &v, triangles, &t, &a, NULL);
        if (!m.failed) continue;
        ck_assert_int_eq(result, GX_ERROR_MEMORY);
        ck_assert(v == 99 && t == 98);
        check_empty(&m, "solidify");
    }
    ck_assert(v == 8 && t == 12);
    check_empty(&m, "solidify");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("memory");
    TCase *tests = tcase_create("memory"), *strokes_ = tcase_create("strokes");
    tcase_set_timeout(tests, 120);
    tcase_set_timeout(strokes_, 120);
    tcase_add_test(tests, creation);
    tcase_add_test(tests, creation_of_a_shape);
    tcase_add_test(tests, materials);
    tcase_add_test(tests, contact);
    tcase_add_test(tests, thin_pieces);
    tcase_add_test(tests, first_cut);
    tcase_add_test(tests, partial_cut);
    tcase_add_test(tests, cut_of_many_triangles);
    tcase_add_test(tests, solid_cut);
    tcase_add_test(tests, cut_of_a_cut_body);
    tcase_add_test(tests, scoped_cut);
    tcase_add_test(tests, blades);
    tcase_add_test(tests, severing_cut);
    tcase_add_test(tests, many_surfaces);
    tcase_add_test(tests, view_hold_skin_hash);
    tcase_add_test(tests, points_and_rays);
    tcase_add_test(tests, holding);
    tcase_add_test(tests, stepping);
    tcase_add_test(tests, stepping_by_quality);
    tcase_add_test(tests, motions);
    tcase_add_test(tests, copies);
    tcase_add_test(tests, restoring);
    tcase_add_test(tests, cut_after_steps);
    tcase_add_test(tests, step_with_fewer_copies);
    tcase_add_test(tests, cut_of_a_fan);
    tcase_add_test(tests, cut_of_a_pinch);
    tcase_add_test(tests, followers);
    tcase_add_test(tests, step_after_a_failed_model);
    tcase_add_test(tests, steps_after_a_failed_cut);
    tcase_add_loop_test(strokes_, memory_of_strokes, 0, STROKES);
    tcase_add_test(tests, solidifying);
    suite_add_tcase(suite, tests);
    suite_add_tcase(suite, strokes_);
    return run_suite(suite);
}
