/* jelly.c: a body for a web page, as a WebAssembly module without imports. worker.js calls it; `make web` builds it.

   There is one body: a generated one, or all inside of a model's surface. It hangs by its top, or lies on a ground at
   z = 0. Its pieces touch each other and the ground. A stroke is a blade that cuts while the body moves. Functions
   return 0, or the number of an error in words (jelly_error_text). Numbers go through one array, jelly_numbers.

   contents
     >>body       shapes, models, what holds them
     >>drawing    the skin, and where it is
     >>cutting    strokes, going back
     >>moving     a hand that pulls, steps */
#define GXFEM_STATIC
#ifdef __wasm__ /* what the page loads should be small */
#define GXFEM_SMALL
#define EXPORT(name) __attribute__((export_name(#name), used))
#else
#define EXPORT(name) /* bench/web.c has it as a part of a native program */
#endif
#define GXFEM_IMPLEMENTATION
#include "../../gxfem.h"
#include "../gxshape.h"

enum { NUMBERS = 16, MARKS = 12, MODEL = 4, SHAPE_FAILED = 1000 };

static gx_body *body;
static gx_blade *blade;
static gx_skin skin;
static double numbers[NUMBERS];
static float *positions, *normals; /* skin.vertex_count x 3, in space, m */
static gx_anchor grip;
static gxs_spring spring;
static int holding;
static double youngs; /* Pa */
static gx_body *marks[MARKS];
static size_t mark_count;
static gx_failure failure;     /* of the last new body */
static double *model_vertices; /* model_vertex_count x 3; the page's */
static uint32_t *model_triangles;
static uint32_t model_vertex_count, model_triangle_count;

/* ---------------------------------------------------------------------------------------------- >>drawing */

static int refresh(void) {
    gx_skin_desc shading;
    float *p, *n;
    gx_result result;
    memset(&shading, 0, sizeof shading);
    shading.crease_angle = 0.6;
    shading.smooth_cuts = 1;
    result = gx_body_skin(body, &shading, &skin, NULL);
    if (result != GX_OK) return (int)result;
    p = (float *)realloc(positions, (3 * skin.vertex_count + 1) * sizeof *p);
    if (p) positions = p;
    n = (float *)realloc(normals, (3 * skin.vertex_count + 1) * sizeof *n);
    if (n) normals = n;
    return p && n ? GX_OK : GX_ERROR_MEMORY;
}

/* Where the skin is now: fills what jelly_positions and jelly_normals show. */
EXPORT(jelly_draw) int jelly_draw(void) {
    static const double origin[3] = {0, 0, 0};
    return (int)gx_body_skin_vertices(body, origin, positions, normals, NULL);
}

EXPORT(jelly_vertex_count) uint32_t jelly_vertex_count(void) { return (uint32_t)skin.vertex_count; }
EXPORT(jelly_triangle_count) uint32_t jelly_triangle_count(void) { return (uint32_t)skin.triangle_count; }
EXPORT(jelly_positions) const float *jelly_positions(void) { return positions; }
EXPORT(jelly_normals) const float *jelly_normals(void) { return normals; }
EXPORT(jelly_triangles) const uint32_t *jelly_triangles(void) { return skin.triangles; }
EXPORT(jelly_fragments) const uint32_t *jelly_fragments(void) { return skin.triangle_fragment; }
EXPORT(jelly_surfaces) const uint32_t *jelly_surfaces(void) { return skin.triangle_surface; }
EXPORT(jelly_numbers) double *jelly_numbers(void) { return numbers; }
EXPORT(jelly_error_text) const char *jelly_error_text(int result) {
    return result >= SHAPE_FAILED ? "the shape could not be filled with elements" : gx_result_text((gx_result)result);
}

/* The triangle that the last model was refused for, or -1 */
EXPORT(jelly_error_triangle) int jelly_error_triangle(void) {
    const int known = failure.result != GX_OK && failure.field && strstr(failure.field, "triangles") != NULL;
    return known && failure.index < model_triangle_count ? (int)failure.index : -1;
}

/* What there is: fragments, elements, unknowns. And each fragment's number for life, by its place in jelly_fragments */
EXPORT(jelly_ids) const uint32_t *jelly_ids(void) {
    gx_view view;
    memset(&view, 0, sizeof view);
    gx_body_view(body, &view, NULL);
    numbers[0] = (double)view.fragment_count;
    numbers[1] = (double)view.element_count;
    numbers[2] = 3 * (double)view.copy_count;
    return view.fragment_id;
}

/* ------------------------------------------------------------------------------------------------- >>body */

static void drop(void) {
    size_t i;
    for (i = 0; i < mark_count; i++) gx_body_destroy(marks[i]);
    mark_count = 0;
    gx_body_destroy(body);
    body = NULL;
    blade = NULL;
    holding = 0;
}

/* A block of cubes, six elements each, with its lowest corner at `low` */
static int make_block(gxshape_mesh *mesh, const size_t n[3], const double low[3], double edge) {
    static const int ways[6][2] = {{1, 2}, {2, 4}, {4, 1},
                                   {2, 1}, {1, 4}, {4, 2}}; /* first two steps to the far corner */
    const size_t row = n[0] + 1, layer = row * (n[1] + 1);
    size_t x, y, z, count = 0;
    int i;
    mesh->node_count = layer * (n[2] + 1);
    mesh->element_count = 6 * n[0] * n[1] * n[2];
    mesh->positions = (double *)malloc(mesh->node_count * 3 * sizeof(double));
    mesh->elements = (uint32_t *)malloc(mesh->element_count * 4 * sizeof(uint32_t));
    if (!mesh->positions || !mesh->elements) return GX_ERROR_MEMORY;
    for (z = 0; z <= n[2]; z++)
        for (y = 0; y <= n[1]; y++)
            for (x = 0; x <= n[0]; x++) {
                mesh->positions[count++] = low[0] + edge * (double)x;
                mesh->positions[count++] = low[1] + edge * (double)y;
                mesh->positions[count++] = low[2] + edge * (double)z;
            }
    count = 0;
    for (z = 0; z < n[2]; z++)
        for (y = 0; y < n[1]; y++)
            for (x = 0; x < n[0]; x++)
                for (i = 0; i < 6; i++) {
                    const size_t first = x + row * y + layer * z, step[5] = {0, 1, row, 0, layer};
                    uint32_t *e = mesh->elements + count;
                    e[0] = (uint32_t)first;
                    e[1] = (uint32_t)(first + step[ways[i][0]]);
                    e[2] = (uint32_t)(e[1] + step[ways[i][1]]);
                    e[3] = (uint32_t)(first + 1 + row + layer);
                    if (i >= 3) {
                        const uint32_t last = e[3];
                        e[3] = e[2];
                        e[2] = last;
                    }
                    count += 4;
                }
    return GX_OK;
}

/* Room for a model: the page writes it, jelly_new(MODEL, ...) takes it. */
EXPORT(jelly_model_room) int jelly_model_room(uint32_t vertices, uint32_t triangles) {
    free(model_vertices);
    free(model_triangles);
    model_vertices = (double *)malloc(((size_t)vertices + 1) * 3 * sizeof(double));
    model_triangles = (uint32_t *)malloc(((size_t)triangles + 1) * 3 * sizeof(uint32_t));
    model_vertex_count = vertices;
    model_triangle_count = triangles;
    return model_vertices && model_triangles ? GX_OK : GX_ERROR_MEMORY;
}

EXPORT(jelly_model_vertices) double *jelly_model_vertices(void) { return model_vertices; }
EXPORT(jelly_model_triangles) uint32_t *jelly_model_triangles(void) { return model_triangles; }

/* Scales positions to 1.4 m across, with the lowest at a height. middle: receives their mean */
static void settle_positions(double *positions_of, size_t count, double height, double middle[3]) {
    double lowest[3] = {1e300, 1e300, 1e300}, highest[3] = {-1e300, -1e300, -1e300}, widest = 0;
    size_t i;
    for (i = 0; i < 3 * count; i++) {
        const double x = positions_of[i];
        lowest[i % 3] = x < lowest[i % 3] ? x : lowest[i % 3];
        highest[i % 3] = x > highest[i % 3] ? x : highest[i % 3];
    }
    for (i = 0; i < 3; i++) {
        widest = highest[i] - lowest[i] > widest ? highest[i] - lowest[i] : widest;
        middle[i] = 0;
    }
    for (i = 0; i < 3 * count; i++) {
        const double from = i % 3 == 2 ? lowest[2] : 0.5 * (lowest[i % 3] + highest[i % 3]);
        positions_of[i] = (positions_of[i] - from) * (1.4 / widest) + (i % 3 == 2 ? height : 0);
        middle[i % 3] += positions_of[i] / (double)count;
    }
}

/* Turns positions about the x axis, by quarters: y becomes z. */
static void turn(double *x, size_t count, int quarters) {
    size_t i;
    for (; quarters > 0; quarters--)
        for (i = 0; i < 3 * count; i += 3) {
            const double y = x[i + 1];
            x[i + 1] = -x[i + 2];
            x[i + 2] = y;
        }
}

/* kind 0: a cube of jelly that hangs; 1: a slab of one element's thickness that hangs; 2: an octopus, held by its head;
   3: a bunny, which stands on the ground. *held: what holds it */
static int make_shape(gxshape_mesh *mesh, int kind, gx_region *held) {
    static const size_t cube[3] = {12, 12, 12}, slab[3] = {12, 1, 12};
    static const double low[3] = {-0.5, -0.5, 0.6}, side[3] = {-0.5, -0.05, 0.6};
    static const char *const names[] = {"octopus", "bunny"};
    gxshape_field field;
    double middle[3];
    const gxshape_named *named;
    *held = gx_region_half_space(2, 1, 1.6 - 1e-6);
    if (kind == 0) return make_block(mesh, cube, low, 1.0 / 12);
    if (kind == 1) return make_block(mesh, slab, side, 1.0 / 12);
    named = gxshape_find(names[kind - 2], strlen(names[kind - 2]));
    memset(&field, 0, sizeof field);
    named->make(&field);
    if (gxshape_fill(&field, (kind == 2 ? 0.8 : 0.65) * named->coarsest, mesh) != NULL) return SHAPE_FAILED;
    turn(mesh->positions, mesh->node_count, kind == 2 ? 2 : 1); /* heads up: it was along -z, and along y */
    settle_positions(mesh->positions, mesh->node_count, kind == 2 ? 0.5 : 0, middle);
    *held = kind == 2 ? gx_region_sphere(middle, 0.15) : gx_region_half_space(2, -1, 0.08);
    return GX_OK;
}

/* The blade of a new body, and of one that was restored. A stroke may begin in the material. */
static int take_blade(void) {
    gx_blade_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.starts_inside = 1;
    blade = gx_body_blade(body, 0);
    return blade ? GX_OK : (int)gx_blade_create(body, &desc, &blade, NULL);
}

/* What is inside of the model stands on the ground, which holds its feet; 14 cubes along its longest side. */
static int make_model(gx_body_desc *desc, gx_region *held, gx_body **made) {
    gx_surface surface;
    gx_shape shape;
    double middle[3];
    settle_positions(model_vertices, model_vertex_count, 0, middle);
    memset(&surface, 0, sizeof surface);
    memset(&shape, 0, sizeof shape);
    surface.vertices = model_vertices;
    surface.vertex_count = model_vertex_count;
    surface.triangles = model_triangles;
    surface.triangle_count = model_triangle_count;
    shape.surfaces = &surface;
    shape.surface_count = 1;
    shape.cells = 14;
    desc->shape = &shape;
    *held = gx_region_half_space(2, -1, 0.05);
    return (int)gx_body_create(desc, made, &failure);
}

/* The body of a generated mesh */
static int make_mesh(gx_body_desc *desc, int kind, gx_region *held, gx_body **made) {
    gxshape_mesh mesh;
    int result;
    memset(&mesh, 0, sizeof mesh);
    result = make_shape(&mesh, kind, held);
    desc->positions = mesh.positions;
    desc->node_count = mesh.node_count;
    desc->elements = mesh.elements;
    desc->element_count = mesh.element_count;
    if (result == GX_OK) result = (int)gx_body_create(desc, made, &failure);
    gxshape_mesh_release(&mesh);
    return result;
}

/* A new body: of a kind that make_shape has, or the page's model. young: Pa. After an error the old one goes on. */
EXPORT(jelly_new) int jelly_new(int kind, double young) {
    gx_body_desc desc;
    gx_contact_desc contact;
    gx_region held;
    gx_body *made = NULL;
    int result;
    memset(&failure, 0, sizeof failure);
    memset(&desc, 0, sizeof desc);
    memset(&contact, 0, sizeof contact);
    contact.friction = 0.5;
    desc.affine_below = kind == 1;
    desc.young = young;
    desc.poisson = 0.4;
    desc.density = 1000;
    result = kind == MODEL ? make_model(&desc, &held, &made) : make_mesh(&desc, kind, &held, &made);
    if (result == GX_OK) result = (int)gx_body_hold(made, &held, 1, &failure);
    if (result == GX_OK) result = (int)gx_body_contact(made, &contact, &failure);
    if (result != GX_OK) {
        gx_body_destroy(made);
        return result;
    }
    drop();
    body = made;
    youngs = young;
    result = take_blade();
    return result == GX_OK ? refresh() : result;
}

/* ---------------------------------------------------------------------------------------------- >>cutting */

/* Remembers the body, to go back to. The oldest of many is forgotten. */
EXPORT(jelly_mark) int jelly_mark(void) {
    gx_result result;
    if (mark_count == MARKS) {
        gx_body_destroy(marks[0]);
        memmove(marks, marks + 1, --mark_count * sizeof *marks);
    }
    result = gx_body_clone(body, &marks[mark_count], NULL);
    if (result == GX_OK) mark_count++;
    return (int)result;
}

/* Goes back to the last mark. numbers[0]: how many marks are left */
EXPORT(jelly_undo) int jelly_undo(void) {
    gx_result result;
    if (mark_count == 0) return GX_OK;
    result = gx_body_restore(body, marks[mark_count - 1], NULL);
    if (result != GX_OK) return (int)result;
    gx_body_destroy(marks[--mark_count]);
    holding = 0;
    return take_blade() == GX_OK ? refresh() : GX_ERROR_MEMORY;
}

EXPORT(jelly_mark_count) uint32_t jelly_mark_count(void) { return (uint32_t)mark_count; }

/* Moves the edge to the two points in numbers[0] .. [5]; lift 1: ends the stroke. numbers[6]: 1 if something was cut */
EXPORT(jelly_stroke) int jelly_stroke(int lift) {
    gx_blade_report report = {0};
    gx_result result = gx_blade_move(blade, numbers, 2, NULL, 0, &report, NULL);
    int cut = result == GX_OK && report.triangle_count > 0;
    if (lift) {
        const gx_result lifted = gx_blade_lift(blade, &report, NULL);
        cut |= lifted == GX_OK && report.triangle_count > 0;
        if (result == GX_OK) result = lifted;
    }
    numbers[6] = cut;
    if (cut) {
        const int shown = refresh();
        if (result == GX_OK) return shown;
    }
    return (int)result;
}

/* ----------------------------------------------------------------------------------------------- >>moving */

/* Takes hold where the ray of numbers[0] .. [5], a point and a direction, meets the body. numbers[6]: 1 if it does */
EXPORT(jelly_grab) int jelly_grab(void) {
    gx_hit hit;
    gx_result result = gx_body_pick(body, numbers, numbers + 3, &hit, NULL);
    holding = 0;
    if (result == GX_OK && hit.triangle != UINT32_MAX) {
        result = gx_hit_anchor(body, &hit, &grip, NULL);
        holding = result == GX_OK;
        memset(&spring, 0, sizeof spring);
        memcpy(spring.target, hit.position, sizeof hit.position);
        memcpy(numbers, hit.position, sizeof hit.position);
        spring.stiffness = 0.3 * youngs; /* m of its size */
    }
    numbers[6] = holding;
    return (int)result;
}

/* Pulls towards the point in numbers[0] .. [2]. */
EXPORT(jelly_pull) void jelly_pull(void) { memcpy(spring.target, numbers, sizeof spring.target); }

EXPORT(jelly_release) void jelly_release(void) { holding = 0; }

/* A step of numbers[0] seconds under gravity numbers[1], m/s2 */
EXPORT(jelly_step) int jelly_step(void) {
    gx_step_desc step;
    gx_collider ground;
    memset(&step, 0, sizeof step);
    memset(&ground, 0, sizeof ground);
    step.dt = numbers[0];
    step.gravity[2] = -numbers[1];
    step.integrator = GXS_BDF2;
    step.mass_damping = 0.4;
    step.sleep_speed = 0.01;
    ground.kind = GX_COLLIDER_PLANE;
    ground.pose[0] = ground.pose[5] = ground.pose[10] = 1;
    ground.friction = 0.5;
    step.colliders = &ground;
    step.collider_count = 1;
    step.springs = &spring;
    step.spring_anchors = &grip;
    step.spring_count = holding ? 1 : 0;
    return (int)gx_body_step(body, &step, NULL, NULL);
}
