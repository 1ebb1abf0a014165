/* method.h - ways of cutting behind one interface: the library, virtual nodes (vna.h), the literal Algorithm 1 (literal.h). Each repeats a
   scene (replay.h) by the same time step, gxfem_solve.h's: only what is compared differs. Include after replay.h. */
#ifndef GXFEM_BENCH_METHOD_H
#define GXFEM_BENCH_METHOD_H

#include "clock.h"
#include "literal.h"
#include "vna.h"

/* Of a frame */
typedef struct method_times {
    double booleans;        /* s: what finds the pieces, and which copies they have */
    double integrals;       /* s: volumes and masses of the pieces */
    double derivatives;     /* s: Hessians of the elastic energy */
    double solve;           /* s: preconditioner and conjugate gradients */
    double total;           /* s: of the frame, the cut included */
    size_t domains;         /* nodal and element subdomains that were looked at; 0: no cut */
} method_times;

/* Those that can fail return NULL, or why they can't. */
typedef struct method {
    const char *name;
    void *(*create)(const replay *scene);
    const char *(*cut)(void *state, const replay_cut *cut, method_times *times);
    const char *(*step)(void *state, method_times *times);
    size_t (*unknowns)(void *state);
    /* Parts and copies as they are now, and where the copies are; borrowed */
    void (*look)(void *state, gxs_model *model, const double **displacement);
    void (*destroy)(void *state);
} method;

static inline void method_must(gx_result result, const char *what)
{
    if (result == GX_OK) return;
    fprintf(stderr, "%s: %s\n", what, gx_result_text(result));
    exit(1);
}

static inline void *method_memory(void *old, size_t count, size_t size)
{
    void *memory = realloc(old, count * size + 1);
    method_must(memory ? GX_OK : GX_ERROR_MEMORY, "bench");
    return memory;
}

static inline gx_step_desc method_step_desc(const replay *scene)
{
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = scene->dt;
    memcpy(desc.gravity, scene->gravity, sizeof desc.gravity);
    desc.newton_iterations = (uint32_t)scene->newton_iterations;
    desc.clock = seconds;
    return desc;
}

static inline void method_take_report(const gx_step_report *report, method_times *times)
{
    times->derivatives += report->seconds_linearise;
    times->solve += report->seconds_prepare + report->seconds_solve;
}

/* ---- the library's body, which the library and virtual nodes cut ---- */

typedef struct method_body {
    const replay *scene;
    gx_body *body;
    gxs_solver *solver;         /* virtual nodes: of the replicas */
    gxs_element *replicas;
    int changed;                /* virtual nodes: the solver does not have the model of the body as it is now */
} method_body;

static inline void *method_body_create(const replay *scene)
{
    method_body *m = (method_body *)method_memory(NULL, 1, sizeof *m);
    gx_body_desc desc;
    gx_view view;
    memset(m, 0, sizeof *m);
    memset(&desc, 0, sizeof desc);
    m->scene = scene;
    m->changed = 1;
    desc.positions = scene->positions; desc.node_count = scene->node_count;
    desc.elements = scene->elements; desc.element_count = scene->element_count;
    desc.young = scene->young; desc.poisson = scene->poisson; desc.density = scene->density;
    desc.clock = seconds;
    method_must(gx_body_create(&desc, &m->body, NULL), "body");
    method_must(gx_body_hold(m->body, scene->regions, scene->region_count), "hold");
    method_must(gx_body_view(m->body, &view), "view");
    memcpy(view.displacement, scene->displacement, 3 * scene->node_count * sizeof(double));
    memcpy(view.velocity, scene->velocity, 3 * scene->node_count * sizeof(double));
    return m;
}

static inline const char *method_body_cut(void *state, const replay_cut *cut, method_times *times)
{
    method_body *m = (method_body *)state;
    const gx_surface strip = replay_strip(cut);
    const double start = seconds(NULL);
    gx_cut_desc desc;
    gx_cut_report report;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &strip; desc.surface_count = 1;
    desc.sever_below = m->scene->sever_below;
    result = gx_body_cut(m->body, &desc, &report, NULL);
    if (result != GX_OK) return gx_result_text(result);
    times->booleans += report.seconds_arrangement + report.seconds_enrichment;
    times->integrals += report.seconds_integrals;
    times->domains += report.touched_elements;
    times->total += seconds(NULL) - start;
    m->changed = 1;
    return NULL;
}

static inline const char *method_library_step(void *state, method_times *times)
{
    method_body *m = (method_body *)state;
    const gx_step_desc desc = method_step_desc(m->scene);
    const double start = seconds(NULL);
    gx_step_report report;
    const gx_result result = gx_body_step(m->body, &desc, &report, NULL);
    if (result != GX_OK) return gx_result_text(result);
    method_take_report(&report, times);
    times->total += seconds(NULL) - start;
    return NULL;
}

static inline size_t method_body_unknowns(void *state)
{
    gx_view view;
    method_must(gx_body_view(((method_body *)state)->body, &view), "view");
    return 3 * view.copy_count;
}

static inline void method_library_look(void *state, gxs_model *model, const double **displacement)
{
    gx_view view;
    method_must(gx_body_view(((method_body *)state)->body, &view), "view");
    method_must(gx_body_model(((method_body *)state)->body, model), "model");
    *displacement = view.displacement;
}

static inline void method_body_destroy(void *state)
{
    method_body *m = (method_body *)state;
    gx_body_destroy(m->body);
    gxs_solver_destroy(m->solver);
    free(m->replicas);
    free(m);
}

/* ---- virtual nodes ---- */

static inline void method_vna_renew(method_body *m)
{
    gxs_model model;
    method_must(gx_body_model(m->body, &model), "model");
    m->replicas = (gxs_element *)method_memory(m->replicas, model.element_count, sizeof *m->replicas);
    vna_replicate(model.elements, model.element_count, &m->scene->density, m->replicas);
    model.elements = m->replicas;
    if (!m->solver) method_must(gxs_solver_create(NULL, &m->solver), "solver");
    method_must(gxs_solver_set_model(m->solver, &model, NULL), "model");
    m->changed = 0;
}

static inline const char *method_vna_step(void *state, method_times *times)
{
    method_body *m = (method_body *)state;
    const gx_step_desc desc = method_step_desc(m->scene);
    const double start = seconds(NULL);
    gx_step_report report;
    gx_result result;
    gx_view view;
    method_must(gx_body_view(m->body, &view), "view");
    if (m->changed) method_vna_renew(m);
    result = gxs_solver_step(m->solver, &desc, view.displacement, view.velocity, &report, NULL);
    if (result != GX_OK) return gx_result_text(result);
    method_take_report(&report, times);
    times->total += seconds(NULL) - start;
    return NULL;
}

static inline void method_vna_look(void *state, gxs_model *model, const double **displacement)
{
    method_body *m = (method_body *)state;
    method_library_look(m, model, displacement);
    m->replicas = (gxs_element *)method_memory(m->replicas, model->element_count, sizeof *m->replicas);
    vna_replicate(model->elements, model->element_count, &m->scene->density, m->replicas);
    model->elements = m->replicas;
}

/* ---- the literal Algorithm 1 ---- */

typedef struct method_literal {
    const replay *scene;
    literal *cutter;
    gxs_solver *solver;
    gxs_material material;
    uint8_t *held;
    int changed;
} method_literal;

static inline void *method_literal_create(const replay *scene)
{
    method_literal *m = (method_literal *)method_memory(NULL, 1, sizeof *m);
    literal_desc desc;
    memset(m, 0, sizeof *m);
    memset(&desc, 0, sizeof desc);
    m->scene = scene;
    m->changed = 1;
    m->material.kind = GXS_STABLE_NEO_HOOKEAN;
    m->material.young = scene->young;
    m->material.poisson = scene->poisson;
    desc.positions = scene->positions; desc.node_count = scene->node_count;
    desc.elements = scene->elements; desc.element_count = scene->element_count;
    desc.density = scene->density;
    m->cutter = literal_create(&desc);
    memcpy(m->cutter->displacement, scene->displacement, 3 * scene->node_count * sizeof(double));
    memcpy(m->cutter->velocity, scene->velocity, 3 * scene->node_count * sizeof(double));
    method_must(gxs_solver_create(NULL, &m->solver), "solver");
    return m;
}

/* The path so far as a solid; vertices and triangles are the caller's to free. */
static inline gx_surface method_solidify(const gx_surface *sheet, double thickness)
{
    double *vertices = (double *)method_memory(NULL, 6 * sheet->vertex_count, sizeof(double));
    uint32_t *triangles = (uint32_t *)method_memory(NULL, 24 * sheet->triangle_count, sizeof(uint32_t));
    gx_surface solid;
    memset(&solid, 0, sizeof solid);
    method_must(gx_surface_solidify(sheet, thickness, vertices, &solid.vertex_count, triangles, &solid.triangle_count, NULL), "solid");
    solid.vertices = vertices;
    solid.triangles = triangles;
    solid.kind = GX_SURFACE_SOLID;
    return solid;
}

static inline const char *method_literal_cut(void *state, const replay_cut *cut, method_times *times)
{
    method_literal *m = (method_literal *)state;
    const literal_report before = m->cutter->report;
    const gx_surface strip = replay_strip(cut);
    const double start = seconds(NULL);
    const int is_solid = cut->path.kind == GX_SURFACE_SOLID;
    gx_surface solid = is_solid ? cut->path : method_solidify(&cut->path, m->scene->thickness);
    literal_cut(m->cutter, &solid, 1, &strip);
    times->booleans += m->cutter->report.seconds_booleans - before.seconds_booleans;
    times->domains += m->cutter->report.booleans - before.booleans;
    times->total += seconds(NULL) - start;
    if (!is_solid) {
        free((void *)(uintptr_t)solid.vertices);
        free((void *)(uintptr_t)solid.triangles);
    }
    m->changed = 1;
    return m->cutter->report.failures > before.failures ? "a Boolean of rounded subdomains is refused" : NULL;
}

static inline void method_literal_renew(method_literal *m, method_times *times)
{
    const double before = m->cutter->report.seconds_integrals;
    gxs_model model;
    size_t i;
    literal_model(m->cutter, &model);
    times->integrals += m->cutter->report.seconds_integrals - before;
    m->held = (uint8_t *)method_memory(m->held, model.copy_count, 1);
    for (i = 0; i < model.copy_count; i++) m->held[i] = (uint8_t)replay_is_held(m->scene, m->cutter->copy_node[i]);
    model.held = m->held;
    model.materials = &m->material;
    model.material_count = 1;
    method_must(gxs_solver_set_model(m->solver, &model, NULL), "model");
    m->changed = 0;
}

static inline const char *method_literal_step(void *state, method_times *times)
{
    method_literal *m = (method_literal *)state;
    const gx_step_desc desc = method_step_desc(m->scene);
    const double start = seconds(NULL);
    gx_step_report report;
    gx_result result;
    if (m->changed) method_literal_renew(m, times);
    result = gxs_solver_step(m->solver, &desc, m->cutter->displacement, m->cutter->velocity, &report, NULL);
    if (result != GX_OK) return gx_result_text(result);
    method_take_report(&report, times);
    times->total += seconds(NULL) - start;
    return NULL;
}

static inline size_t method_literal_unknowns(void *state) { return 3 * ((method_literal *)state)->cutter->copy_count; }

static inline void method_literal_look(void *state, gxs_model *model, const double **displacement)
{
    method_literal *m = (method_literal *)state;
    literal_model(m->cutter, model);
    *displacement = m->cutter->displacement;
}

static inline void method_literal_destroy(void *state)
{
    method_literal *m = (method_literal *)state;
    literal_destroy(m->cutter);
    gxs_solver_destroy(m->solver);
    free(m->held);
    free(m);
}

/* ---- all ---- */

static const method methods[] = {
    {"gxfem", method_body_create, method_body_cut, method_library_step, method_body_unknowns, method_library_look, method_body_destroy},
    {"VNA", method_body_create, method_body_cut, method_vna_step, method_body_unknowns, method_vna_look, method_body_destroy},
    {"Algorithm 1", method_literal_create, method_literal_cut, method_literal_step, method_literal_unknowns, method_literal_look, method_literal_destroy}};

enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

#endif
