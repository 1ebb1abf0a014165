/* method.h - ways of cutting behind one interface: the library, RXFEM (rxfem.h), virtual nodes (vna.h), the literal
   Algorithm 1 (literal.h). Each repeats a scene (replay.h) by the same time step, gxfem_solve.h's, so that only what
   is compared differs. Include after replay.h. */
#ifndef GXFEM_BENCH_METHOD_H
#define GXFEM_BENCH_METHOD_H

#include "clock.h"
#include "literal.h"
#include "rxfem_model.h"
#include "vna.h"

/* Of one frame */
typedef struct method_times {
    double booleans;         /* s: finding the parts and their copies */
    double integrals;        /* s: volumes and masses of the pieces */
    double derivatives;      /* s: Hessians of the elastic energy */
    double derivatives_once; /* s: RXFEM's with one evaluation for each part; not in total */
    double solve;            /* s: preconditioner and conjugate gradients */
    double total;            /* s: of the frame, the cut included */
    size_t domains;          /* nodal and element subdomains that were visited; 0: no cut */
} method_times;

/* Functions that can fail return NULL, or the reason. */
typedef struct method {
    const char *name;
    void *(*create)(const replay *scene);
    const char *(*cut)(void *state, const replay_cut *cut, method_times *times);
    const char *(*step)(void *state, method_times *times);
    size_t (*unknowns)(void *state);
    /* Parts, copies and the copies' displacements as they are now; borrowed */
    void (*look)(void *state, gxs_model *model, const double **displacement);
    void (*destroy)(void *state);
} method;

static inline void method_must(gx_result result, const char *what) {
    if (result == GX_OK) return;
    fprintf(stderr, "%s: %s\n", what, gx_result_text(result));
    exit(1);
}

static inline void *method_memory(void *old, size_t count, size_t size) {
    void *memory = realloc(old, count * size + 1);
    method_must(memory ? GX_OK : GX_ERROR_MEMORY, "bench");
    return memory;
}

static inline gx_step_desc method_step_desc(const replay *scene) {
    gx_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = scene->dt;
    memcpy(desc.gravity, scene->gravity, sizeof desc.gravity);
    desc.newton_iterations = (uint32_t)scene->newton_iterations;
    desc.clock = seconds;
    return desc;
}

static inline void method_take_report(const gx_step_report *report, method_times *times) {
    times->derivatives += report->seconds_linearise;
    times->solve += report->seconds_prepare + report->seconds_solve;
}

/* The same for a solver without a body */
static inline gxs_step_desc method_solver_desc(const replay *scene) {
    const gx_step_desc like = method_step_desc(scene);
    gxs_step_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.dt = like.dt;
    memcpy(desc.gravity, like.gravity, sizeof desc.gravity);
    desc.newton_iterations = like.newton_iterations;
    desc.clock = like.clock;
    return desc;
}

/* A solver's step of copies, begun at `start` */
static inline const char *method_solve(gxs_solver *solver, const replay *scene, double *displacement, double *velocity,
                                       double start, method_times *times) {
    const gxs_step_desc desc = method_solver_desc(scene);
    gx_step_report report;
    const gx_result result = gxs_solver_step(solver, &desc, displacement, velocity, &report, NULL);
    if (result != GX_OK) return gx_result_text(result);
    method_take_report(&report, times);
    times->total += seconds(NULL) - start;
    return NULL;
}

/* ---- the library's body, which the library and virtual nodes cut ---- */

typedef struct method_body {
    const replay *scene;
    gx_body *body;
    gxs_solver *solver; /* virtual nodes: of the replicas */
    gxs_element *replicas;
    int changed; /* virtual nodes: the solver does not have the model of the body as it is now */
} method_body;

static inline void *method_body_create(const replay *scene) {
    method_body *m = (method_body *)method_memory(NULL, 1, sizeof *m);
    gx_body_desc desc;
    gx_view view;
    memset(m, 0, sizeof *m);
    memset(&desc, 0, sizeof desc);
    m->scene = scene;
    m->changed = 1;
    desc.positions = scene->positions;
    desc.node_count = scene->node_count;
    desc.elements = scene->elements;
    desc.element_count = scene->element_count;
    desc.young = scene->young;
    desc.poisson = scene->poisson;
    desc.density = scene->density;
    desc.affine_below = scene->affine_below;
    desc.clock = seconds;
    method_must(gx_body_create(&desc, &m->body, NULL), "body");
    method_must(gx_body_hold(m->body, scene->regions, scene->region_count, NULL), "hold");
    method_must(gx_body_view(m->body, &view, NULL), "view");
    memcpy(view.displacement, scene->displacement, 3 * scene->node_count * sizeof(double));
    memcpy(view.velocity, scene->velocity, 3 * scene->node_count * sizeof(double));
    return m;
}

static inline const char *method_body_cut(void *state, const replay_cut *cut, method_times *times) {
    method_body *m = (method_body *)state;
    const gx_surface strip = replay_strip(cut);
    const double start = seconds(NULL);
    gx_cut_desc desc;
    gx_cut_report report;
    gx_result result;
    memset(&desc, 0, sizeof desc);
    desc.surfaces = &strip;
    desc.surface_count = 1;
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

static inline const char *method_library_step(void *state, method_times *times) {
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

static inline size_t method_body_unknowns(void *state) {
    gx_view view;
    method_must(gx_body_view(((method_body *)state)->body, &view, NULL), "view");
    return 3 * view.copy_count;
}

static inline void method_library_look(void *state, gxs_model *model, const double **displacement) {
    gx_view view;
    method_must(gx_body_view(((method_body *)state)->body, &view, NULL), "view");
    method_must(gx_body_model(((method_body *)state)->body, model, NULL), "model");
    *displacement = view.displacement;
}

static inline void method_body_destroy(void *state) {
    method_body *m = (method_body *)state;
    gx_body_destroy(m->body);
    gxs_solver_destroy(m->solver);
    free(m->replicas);
    free(m);
}

/* ---- virtual nodes ---- */

static inline void method_vna_renew(method_body *m) {
    gxs_model model;
    method_must(gx_body_model(m->body, &model, NULL), "model");
    m->replicas = (gxs_element *)method_memory(m->replicas, model.element_count, sizeof *m->replicas);
    vna_replicate(model.elements, model.element_count, &m->scene->density, m->replicas);
    model.elements = m->replicas;
    if (!m->solver) method_must(gxs_solver_create(NULL, &m->solver, NULL), "solver");
    method_must(gxs_solver_set_model(m->solver, &model, NULL), "model");
    m->changed = 0;
}

static inline const char *method_vna_step(void *state, method_times *times) {
    method_body *m = (method_body *)state;
    const double start = seconds(NULL);
    gx_view view;
    method_must(gx_body_view(m->body, &view, NULL), "view");
    if (m->changed) method_vna_renew(m);
    return method_solve(m->solver, m->scene, view.displacement, view.velocity, start, times);
}

static inline void method_vna_look(void *state, gxs_model *model, const double **displacement) {
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

static inline void *method_literal_create(const replay *scene) {
    method_literal *m = (method_literal *)method_memory(NULL, 1, sizeof *m);
    literal_desc desc;
    memset(m, 0, sizeof *m);
    memset(&desc, 0, sizeof desc);
    m->scene = scene;
    m->changed = 1;
    m->material.kind = GXS_STABLE_NEO_HOOKEAN;
    m->material.young = scene->young;
    m->material.poisson = scene->poisson;
    desc.positions = scene->positions;
    desc.node_count = scene->node_count;
    desc.elements = scene->elements;
    desc.element_count = scene->element_count;
    desc.density = scene->density;
    m->cutter = literal_create(&desc);
    memcpy(m->cutter->displacement, scene->displacement, 3 * scene->node_count * sizeof(double));
    memcpy(m->cutter->velocity, scene->velocity, 3 * scene->node_count * sizeof(double));
    method_must(gxs_solver_create(NULL, &m->solver, NULL), "solver");
    return m;
}

/* With everything that a Boolean allows today: results in few triangles, and defects of rounding mended */
static inline void *method_mended_create(const replay *scene) {
    method_literal *m = (method_literal *)method_literal_create(scene);
    m->cutter->desc.mended = 1;
    return m;
}

/* The path so far as a solid; vertices and triangles are the caller's to free. */
static inline gx_surface method_solidify(const gx_surface *sheet, double thickness) {
    double *vertices = (double *)method_memory(NULL, 6 * sheet->vertex_count, sizeof(double));
    uint32_t *triangles = (uint32_t *)method_memory(NULL, 24 * sheet->triangle_count, sizeof(uint32_t));
    gx_surface solid;
    memset(&solid, 0, sizeof solid);
    method_must(gx_surface_solidify(sheet, thickness, vertices, &solid.vertex_count, triangles, &solid.triangle_count,
                                    NULL, NULL),
                "solid");
    solid.vertices = vertices;
    solid.triangles = triangles;
    solid.kind = GX_SURFACE_SOLID;
    return solid;
}

static inline const char *method_literal_cut(void *state, const replay_cut *cut, method_times *times) {
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

static inline void method_literal_renew(method_literal *m, method_times *times) {
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

static inline const char *method_literal_step(void *state, method_times *times) {
    method_literal *m = (method_literal *)state;
    const double start = seconds(NULL);
    if (m->changed) method_literal_renew(m, times);
    return method_solve(m->solver, m->scene, m->cutter->displacement, m->cutter->velocity, start, times);
}

static inline size_t method_literal_unknowns(void *state) { return 3 * ((method_literal *)state)->cutter->copy_count; }

static inline void method_literal_look(void *state, gxs_model *model, const double **displacement) {
    method_literal *m = (method_literal *)state;
    literal_model(m->cutter, model);
    *displacement = m->cutter->displacement;
}

static inline void method_literal_destroy(void *state) {
    method_literal *m = (method_literal *)state;
    literal_destroy(m->cutter);
    gxs_solver_destroy(m->solver);
    free(m->held);
    free(m);
}

/* ---- RXFEM ---- */

/* To RXFEM a cut that advances is one surface, to whose patches its enrichments belong. With each strip the mesh is
   cut from scratch by the paths of all blades so far. The time of the cut is the share of new patches. Elastic
   derivatives are taken at the rule's 24 points, as published; their time is added to that of the common step.
   derivatives_once is their time with one evaluation for each part, in which F is constant. It is in no sum. */
typedef struct method_rxfem {
    const replay *scene;
    rx_rules *rules;
    rx_body *body;
    rx_model *model;
    /* of each blade, as far as it is cut */
    const replay_cut **paths;
    size_t path_count;
    gxs_solver *solver;
    gxs_material material;
    uint8_t *held;
    double *displacement, *velocity; /* copies x 3 */
    double *forces, *stiffness;      /* of rx_elastic */
    int changed;
} method_rxfem;

static inline rx_body *method_rxfem_body(const method_rxfem *m) {
    rx_body *body = rx_body_create(m->rules, m->scene->positions, m->scene->node_count, m->scene->elements,
                                   m->scene->element_count);
    body->clock = seconds;
    return body;
}

static inline void *method_rxfem_create(const replay *scene) {
    method_rxfem *m = (method_rxfem *)method_memory(NULL, 1, sizeof *m);
    size_t i;
    memset(m, 0, sizeof *m);
    m->scene = scene;
    m->changed = 1;
    m->material.kind = GXS_STABLE_NEO_HOOKEAN;
    m->material.young = scene->young;
    m->material.poisson = scene->poisson;
    m->rules = rx_rules_create(2, 0);
    m->body = method_rxfem_body(m);
    m->model = rx_model_create(m->body, scene->density);
    m->paths = (const replay_cut **)method_memory(NULL, scene->cut_count, sizeof *m->paths);
    m->displacement = (double *)method_memory(NULL, 3 * m->model->value_count, sizeof(double));
    m->velocity = (double *)method_memory(NULL, 3 * m->model->value_count, sizeof(double));
    for (i = 0; i < m->model->value_count; i++) {
        memcpy(m->displacement + 3 * i, scene->displacement + 3 * (size_t)m->model->values[i].node, 3 * sizeof(double));
        memcpy(m->velocity + 3 * i, scene->velocity + 3 * (size_t)m->model->values[i].node, 3 * sizeof(double));
    }
    method_must(gxs_solver_create(NULL, &m->solver, NULL), "solver");
    return m;
}

/* The centre of a piece */
static inline void method_rxfem_center(const rx_body *b, const rx_piece *piece, double x[3]) {
    const double *o = rx_corner(b, piece->element, 0);
    int i, k;
    for (i = 0; i < 3; i++) {
        x[i] = o[i];
        for (k = 0; k < 3 && piece->moments[0] > 0; k++)
            x[i] += piece->moments[1 + k] / piece->moments[0] * (rx_corner(b, piece->element, k + 1)[i] - o[i]);
    }
}

/* New copies start with the values of the part from which they come. */
static inline double *method_rxfem_carry(const method_rxfem *m, const rx_body *body, const rx_model *model,
                                         const double *old) {
    double *now = (double *)method_memory(NULL, 3 * model->value_count, sizeof(double));
    size_t i, k;
    memset(now, 0, 3 * model->value_count * sizeof(double));
    for (i = 0; i < body->piece_count; i++) {
        double x[3];
        size_t from;
        method_rxfem_center(body, &body->pieces[i], x);
        from = rx_piece_at(m->body, body->pieces[i].element, x);
        for (k = 0; k < 4; k++)
            memcpy(now + 3 * (size_t)model->corners[4 * i + k], old + 3 * (size_t)m->model->corners[4 * from + k],
                   3 * sizeof(double));
    }
    return now;
}

static inline void method_rxfem_take(method_rxfem *m, rx_body *body) {
    rx_model *model = rx_model_create(body, m->scene->density);
    double *displacement = method_rxfem_carry(m, body, model, m->displacement),
           *velocity = method_rxfem_carry(m, body, model, m->velocity);
    rx_body_destroy(m->body);
    rx_model_destroy(m->model);
    free(m->displacement);
    free(m->velocity);
    m->body = body;
    m->model = model;
    m->displacement = displacement;
    m->velocity = velocity;
    m->changed = 1;
}

static inline const char *method_rxfem_text(rx_result result) {
    switch (result) {
    case RX_OK: return NULL;
    case RX_ERROR_CROSSING: return "cuts cross or meet in an element";
    case RX_ERROR_MANIFOLD: return "the surface is not manifold or not oriented";
    case RX_ERROR_DEGENERATE: return "signs stay 0";
    default: return "too many patches in an element";
    }
}

/* The path that the cut continues; path_count: none, it begins a new one */
static inline size_t method_rxfem_blade(const method_rxfem *m, const replay_cut *cut) {
    size_t i;
    for (i = 0; i < m->path_count && cut->first > 0; i++) {
        const gx_surface *path = &m->paths[i]->path;
        if (path->triangle_count == cut->first &&
            memcmp(path->vertices, cut->path.vertices, 3 * path->vertex_count * sizeof(double)) == 0)
            return i;
    }
    return m->path_count;
}

static inline const char *method_rxfem_cut(void *state, const replay_cut *cut, method_times *times) {
    method_rxfem *m = (method_rxfem *)state;
    const size_t before = m->body->patch_count;
    rx_body *body;
    rx_result result = RX_OK;
    double share;
    size_t i;
    if (cut->path.kind == GX_SURFACE_SOLID) return "solids: it knows sheets only";
    i = method_rxfem_blade(m, cut);
    m->paths[i] = cut;
    if (i == m->path_count) m->path_count++;
    body = method_rxfem_body(m);
    for (i = 0; i < m->path_count && result == RX_OK; i++) {
        rx_surface path;
        path.vertices = m->paths[i]->path.vertices;
        path.vertex_count = m->paths[i]->path.vertex_count;
        path.triangles = m->paths[i]->path.triangles;
        path.triangle_count = m->paths[i]->path.triangle_count;
        result = rx_body_cut(body, &path);
    }
    if (result != RX_OK) {
        rx_body_destroy(body);
        return method_rxfem_text(result);
    }
    share = body->patch_count > before ? (double)(body->patch_count - before) / (double)body->patch_count : 0;
    times->booleans += share * body->seconds_path;
    times->integrals += share * body->seconds_rules;
    times->total += share * (body->seconds_path + body->seconds_rules);
    times->domains += body->patch_count > before ? body->patch_count - before : 1;
    method_rxfem_take(m, body);
    return NULL;
}

static inline void method_rxfem_renew(method_rxfem *m) {
    gxs_model model = m->model->model;
    size_t i;
    m->held = (uint8_t *)method_memory(m->held, model.copy_count, 1);
    for (i = 0; i < model.copy_count; i++) m->held[i] = (uint8_t)replay_is_held(m->scene, m->model->values[i].node);
    model.held = m->held;
    model.materials = &m->material;
    model.material_count = 1;
    method_must(gxs_solver_set_model(m->solver, &model, NULL), "model");
    m->forces =
        (double *)method_memory(m->forces, 3 * (m->body->node_count + m->body->enrichment_count), sizeof(double));
    m->stiffness = (double *)method_memory(m->stiffness, 144 * m->body->piece_count, sizeof(double));
    m->changed = 0;
}

/* The time of an evaluation of forces and tangents: at the rule's points, as published, or once for each part. It is
   measured at rest, since it does not depend on the state. */
static inline double method_rxfem_elastic(method_rxfem *m, int published) {
    const size_t count = 3 * (m->body->node_count + m->body->enrichment_count);
    double *unknowns = (double *)calloc(count, sizeof(double)), start;
    method_must(unknowns ? GX_OK : GX_ERROR_MEMORY, "bench");
    start = seconds(NULL);
    rx_elastic(m->body, m->model, m->scene->young, m->scene->poisson, unknowns, published, m->forces, m->stiffness);
    start = seconds(NULL) - start;
    free(unknowns);
    return start;
}

static inline const char *method_rxfem_step(void *state, method_times *times) {
    method_rxfem *m = (method_rxfem *)state;
    const double start = seconds(NULL), derivatives = times->derivatives;
    const char *why;
    double elastic;
    if (m->changed) method_rxfem_renew(m);
    why = method_solve(m->solver, m->scene, m->displacement, m->velocity, start, times);
    if (why) return why;
    elastic = method_rxfem_elastic(m, 1);
    times->derivatives = derivatives + elastic;
    times->derivatives_once += method_rxfem_elastic(m, 0);
    times->total += elastic;
    return NULL;
}

static inline size_t method_rxfem_unknowns(void *state) {
    const method_rxfem *m = (method_rxfem *)state;
    return 3 * (m->body->node_count + m->body->enrichment_count);
}

static inline void method_rxfem_look(void *state, gxs_model *model, const double **displacement) {
    const method_rxfem *m = (method_rxfem *)state;
    *model = m->model->model;
    *displacement = m->displacement;
}

static inline void method_rxfem_destroy(void *state) {
    method_rxfem *m = (method_rxfem *)state;
    rx_body_destroy(m->body);
    rx_model_destroy(m->model);
    rx_rules_destroy(m->rules);
    gxs_solver_destroy(m->solver);
    free((void *)m->paths);
    free(m->held);
    free(m->displacement);
    free(m->velocity);
    free(m->forces);
    free(m->stiffness);
    free(m);
}

/* ---- all ---- */

/* clang-format off */
static const method methods[] = {
    {"gxfem", method_body_create, method_body_cut, method_library_step, method_body_unknowns, method_library_look, method_body_destroy},
    {"RXFEM", method_rxfem_create, method_rxfem_cut, method_rxfem_step, method_rxfem_unknowns, method_rxfem_look, method_rxfem_destroy},
    {"VNA", method_body_create, method_body_cut, method_vna_step, method_body_unknowns, method_vna_look, method_body_destroy},
    {"Algorithm 1", method_literal_create, method_literal_cut, method_literal_step, method_literal_unknowns, method_literal_look, method_literal_destroy},
    {"Algorithm 1 mended", method_mended_create, method_literal_cut, method_literal_step, method_literal_unknowns, method_literal_look,
     method_literal_destroy}};
/* clang-format on */

enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

static inline size_t method_index(const char *name) {
    size_t i = 0;
    while (strcmp(methods[i].name, name) != 0) i++;
    return i;
}

#endif
