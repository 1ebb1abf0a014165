/* body.h - bodies for tests: random numbers, a body of a workload, cut at once or in sequence, and queries. Include
   gxfem.h with its implementation first. */
#ifndef GXFEM_TESTS_BODY_H
#define GXFEM_TESTS_BODY_H

#include "../bench/splitmix.h"
#include "workloads.h"
#include "runner.h"
#include "scarce.h"

#define CHECK_SEED(condition, seed) ck_assert_msg(condition, "seed %llu: %s", (unsigned long long)(seed), #condition)

/* ---- random numbers ---- */

static uint64_t random_state;

static inline uint64_t random_bits(void) { return splitmix64(&random_state); }
static inline int random_below(int n) { return (int)(random_bits() % (uint64_t)n); }
static inline double random_real(double low, double high) {
    return low + (high - low) * ldexp((double)(random_bits() >> 11), -53);
}
static inline void random_seed(uint64_t seed) { random_state = seed * UINT64_C(0x2545f4914f6cdd1d) + 11; }

/* ---- bodies and cuts ---- */

static inline gx_body_desc desc_of(const workload *w) {
    gx_body_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.positions = w->positions;
    desc.node_count = w->node_count;
    desc.elements = w->elements;
    desc.element_count = w->element_count;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    return desc;
}

static inline gx_body *body_of(const workload *w) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    gx_result result = gx_body_create(&desc, &body, NULL);
    ck_assert_msg(result == GX_OK, "create: %s", gx_result_text(result));
    return body;
}

/* A step under gravity along z */
static inline gx_step_desc falling(double dt) {
    gx_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = dt;
    step.gravity[2] = -9.81;
    return step;
}

/* A body in memory that may be made to run out */
static inline gx_body *body_in(memory *m, const workload *w) {
    gx_body_desc desc = desc_of(w);
    gx_body *body = NULL;
    gx_result result;
    *m = plenty();
    desc.allocator = allocator_of(m);
    result = gx_body_create(&desc, &body, NULL);
    ck_assert_msg(result == GX_OK, "create: %s", gx_result_text(result));
    return body;
}

static inline gx_surface surface_of(const wl_surface *s) {
    gx_surface surface;
    memset(&surface, 0, sizeof surface);
    surface.vertices = s->vertices;
    surface.vertex_count = s->vertex_count;
    surface.triangles = s->triangles;
    surface.triangle_count = s->triangle_count;
    surface.kind = (uint32_t)(s->solid < 3 ? s->solid : GX_SURFACE_MATERIAL); /* the oracle has the same numbers */
    surface.material = s->solid < 3 ? 0 : (uint32_t)s->solid - 3;
    return surface;
}

/* Cuts by surfaces first ... first+count-1 of the workload, all in one call. */
static inline gx_cut_report cut_by(gx_body *body, const workload *w, size_t first, size_t count) {
    gx_surface surfaces[WL_SURFACES];
    gx_cut_desc desc;
    gx_cut_report report;
    gx_result result;
    size_t i;
    for (i = 0; i < count; i++) surfaces[i] = surface_of(&w->surfaces[first + i]);
    memset(&desc, 0, sizeof desc);
    desc.surfaces = surfaces;
    desc.surface_count = count;
    result = gx_body_cut(body, &desc, &report, NULL);
    ck_assert_msg(result == GX_OK, "cut: %s", gx_result_text(result));
    return report;
}

static inline gx_body *cut_at_once(const workload *w) {
    gx_body *body = body_of(w);
    if (w->surface_count > 0) cut_by(body, w, 0, w->surface_count);
    return body;
}

static inline gx_body *cut_in_sequence(const workload *w) {
    gx_body *body = body_of(w);
    size_t i;
    for (i = 0; i < w->surface_count; i++) cut_by(body, w, i, 1);
    return body;
}

/* A step without loads but gravity, for a solver without a body */
static inline gxs_step_desc solver_step(const gx_step_desc *like) {
    gxs_step_desc step;
    memset(&step, 0, sizeof step);
    step.dt = like->dt;
    memcpy(step.gravity, like->gravity, sizeof step.gravity);
    step.integrator = like->integrator;
    step.newton_iterations = like->newton_iterations;
    step.newton_tolerance = like->newton_tolerance;
    step.cg_iterations = like->cg_iterations;
    step.cg_tolerance = like->cg_tolerance;
    return step;
}

static inline gx_view view_of(gx_body *body) {
    gx_view view;
    gx_result result = gx_body_view(body, &view, NULL);
    ck_assert_msg(result == GX_OK, "view: %s", gx_result_text(result));
    return view;
}

static inline uint64_t hash_of(gx_body *body) {
    gx_failure failure;
    uint64_t hash = gx_body_topology_hash(body, &failure);
    ck_assert_int_eq(failure.result, GX_OK);
    return hash;
}

/* ---- comparison of two bodies ---- */

typedef struct sized_cell {
    uint32_t element;
    double volume;
} sized_cell;

static inline int by_cell_size(const void *a, const void *b) {
    const sized_cell *p = (const sized_cell *)a, *q = (const sized_cell *)b;
    if (p->element != q->element) return p->element < q->element ? -1 : 1;
    return (p->volume > q->volume) - (p->volume < q->volume);
}

static inline sized_cell *sorted_cells(const gx_view *view, double scale) {
    sized_cell *cells = (sized_cell *)oracle_memory(NULL, view->cell_count + 1, sizeof *cells);
    size_t i;
    for (i = 0; i < view->cell_count; i++) {
        cells[i].element = view->cell_element[i];
        cells[i].volume = view->cell_volume[i] / (scale * scale * scale);
    }
    qsort(cells, view->cell_count, sizeof *cells, by_cell_size);
    return cells;
}

static inline sized_cell *sorted_fragments(const gx_view *view, double scale) {
    sized_cell *f = (sized_cell *)oracle_memory(NULL, view->fragment_count + 1, sizeof *f);
    size_t i;
    for (i = 0; i < view->fragment_count; i++) {
        f[i].element = 0;
        f[i].volume = view->fragment_volume[i] / (scale * scale * scale);
    }
    qsort(f, view->fragment_count, sizeof *f, by_cell_size);
    return f;
}

/* Same topology; volumes within `relative` of themselves or `absolute` of the body's. b is `scale` times as long as a.
 */
static inline void expect_same(gx_body *a, gx_body *b, double scale, double relative, double absolute, const char *what,
                               uint64_t seed) {
    gx_view p = view_of(a), q = view_of(b);
    sized_cell *s, *t;
    size_t i;
    ck_assert_msg(p.cell_count == q.cell_count && p.copy_count == q.copy_count && p.fragment_count == q.fragment_count,
                  "seed %llu, %s: %zu, %zu cells; %zu, %zu copies; %zu, %zu fragments", (unsigned long long)seed, what,
                  p.cell_count, q.cell_count, p.copy_count, q.copy_count, p.fragment_count, q.fragment_count);
    s = sorted_cells(&p, 1);
    t = sorted_cells(&q, scale);
    for (i = 0; i < p.cell_count; i++)
        ck_assert_msg(s[i].element == t[i].element &&
                          fabs(s[i].volume - t[i].volume) <= relative * s[i].volume + absolute * p.volume,
                      "seed %llu, %s: cell of element %u, volume %.17g and %.17g", (unsigned long long)seed, what,
                      s[i].element, s[i].volume, t[i].volume);
    free(s);
    free(t);
    s = sorted_fragments(&p, 1);
    t = sorted_fragments(&q, scale);
    for (i = 0; i < p.fragment_count; i++)
        ck_assert_msg(fabs(s[i].volume - t[i].volume) <= relative * s[i].volume + absolute * p.volume,
                      "seed %llu, %s: fragment volume %.17g and %.17g", (unsigned long long)seed, what, s[i].volume,
                      t[i].volume);
    free(s);
    free(t);
    ck_assert_msg(hash_of(a) == hash_of(b), "seed %llu, %s: topology hashes differ", (unsigned long long)seed, what);
}

/* ---- scenes ---- */

static inline workload grid(size_t nx, size_t ny, size_t nz, int tets) {
    wl_frame axes = wl_axes();
    return wl_grid(nx, ny, nz, tets, &axes);
}

/* The plane x[axis] = value, exactly, far beyond the body */
static inline void add_axis_plane(workload *w, int axis, double value) {
    double x[4][3];
    int i;
    for (i = 0; i < 4; i++) {
        x[i][axis] = value;
        x[i][(axis + 1) % 3] = i == 1 || i == 2 ? 64 : -64;
        x[i][(axis + 2) % 3] = i >= 2 ? 64 : -64;
    }
    wl_add_quad(wl_add_surface(w, 0), x[0], x[1], x[2], x[3]);
}

/* A triangle around p, across n; the circle of `radius` about p fits in */
static inline void add_plane(workload *w, const double p[3], const double n[3], double radius) {
    wl_surface *s = wl_add_surface(w, 0);
    double u[3], v[3], x[3], length = 0;
    int i, k, small = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) < fabs(n[small])) small = 2;
    for (k = 0; k < 3; k++) u[k] = 0;
    u[(small + 1) % 3] = n[(small + 2) % 3];
    u[(small + 2) % 3] = -n[(small + 1) % 3];
    for (k = 0; k < 3; k++) v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
    for (k = 0; k < 3; k++) length += n[k] * n[k];
    length = sqrt(length);
    for (i = 0; i < 3; i++) {
        double a = 2.0943951023931953 * i, unit = 0;
        for (k = 0; k < 3; k++) unit += u[k] * u[k];
        unit = sqrt(unit);
        for (k = 0; k < 3; k++) x[k] = p[k] + 2.1 * radius / unit * (cos(a) * u[k] + sin(a) * v[k] / length);
        wl_add_vertex(s, x);
    }
    wl_add_triangle(s, 0, 1, 2);
}

static inline wl_surface *add_box(workload *w, int solid, double x0, double y0, double z0, double x1, double y1,
                                  double z1) {
    wl_surface *s = wl_add_surface(w, solid);
    double low[3], high[3];
    low[0] = x0;
    low[1] = y0;
    low[2] = z0;
    high[0] = x1;
    high[1] = y1;
    high[2] = z1;
    wl_add_aligned_box(s, low, high);
    return s;
}

/* n x n squares of two triangles of a sphere of radius 2, over and beyond the unit square across an axis, bulging in
   the axis's direction */
static inline void add_cap(workload *w, uint32_t n, int axis) {
    wl_surface *s = wl_add_surface(w, 0);
    uint32_t i, j;
    for (j = 0; j <= n; j++)
        for (i = 0; i <= n; i++) {
            const double u = -0.0513 + 1.1027 * i / n, v = -0.0541 + 1.1027 * j / n;
            double x[3];
            x[axis] = sqrt(4 - (u - 0.4) * (u - 0.4) - (v - 0.45) * (v - 0.45)) - 1.4;
            x[(axis + 1) % 3] = u;
            x[(axis + 2) % 3] = v;
            wl_add_vertex(s, x);
        }
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++) {
            const uint32_t a = j * (n + 1) + i, b = a + n + 1;
            wl_add_triangle(s, a, a + 1, b + 1);
            wl_add_triangle(s, a, b + 1, b);
        }
}

#ifndef GXFEM_LINKED
/* Nodes with free planes: no facet of such a plane has a label */
static inline size_t free_planes(const gx_body *body) {
    const gxb_complex *cx = body->complex;
    uint8_t *labelled = (uint8_t *)calloc(cx->store.plane_count, 1);
    size_t count = 0;
    uint32_t i;
    for (i = 0; i < cx->facet_count; i++)
        if (cx->facets[i].labels != GXB_NONE) labelled[cx->facets[i].plane] = 1;
    for (i = 0; i < cx->tree_count; i++) count += !labelled[cx->nodes[i].plane];
    free(labelled);
    return count;
}
#endif

static inline workload corner_tet(void) { return wl_tetrahedron(wl_corner_tetrahedron); }

/* ---- random scenes ---- */

static inline void random_point(const workload *w, double x[3]) {
    double low, high;
    size_t i;
    int k;
    for (k = 0; k < 3; k++) {
        low = high = w->positions[k];
        for (i = 0; i < w->node_count; i++) {
            low = fmin(low, w->positions[3 * i + (size_t)k]);
            high = fmax(high, w->positions[3 * i + (size_t)k]);
        }
        x[k] = random_real(low, high);
    }
}

static inline void add_random_plane(workload *w, double radius) {
    double p[3], n[3];
    int k;
    random_point(w, p);
    for (k = 0; k < 3; k++) n[k] = random_real(-1, 1);
    add_plane(w, p, n, radius);
}

/* Planes, small triangles that end inside, wavy sheets, axis planes through nodes, solid boxes */
static inline void add_random_cut(workload *w, int solids) {
    wl_frame f = wl_rotated();
    double p[3];
    int k;
    random_point(w, p);
    switch (random_below(solids ? 8 : 6)) {
    case 0:
    case 1: add_random_plane(w, 40); break;
    case 2: add_random_plane(w, random_real(0.05, 0.5)); break;
    case 3:
        for (k = 0; k < 3; k++) f.origin[k] = p[k];
        wl_add_wave(wl_add_surface(w, 0), &f, 6, random_real(0.5, 3));
        break;
    case 4: add_axis_plane(w, random_below(3), random_below(5) / 4.0); break;
    case 5: add_box(w, 0, p[0] - 0.2, p[1] - 0.3, p[2] - 0.1, p[0] + 0.1, p[1] + 0.3, p[2] + 0.2); break;
    case 6: add_box(w, 1, p[0] - 0.2, p[1] - 0.3, p[2] - 0.1, p[0] + 0.1, p[1] + 0.3, p[2] + 0.2); break;
    default:
        for (k = 0; k < 3; k++) f.origin[k] = p[k];
        wl_add_box(wl_add_surface(w, 1), &f, 3, 3, random_real(1e-9, 0.1));
        break;
    }
}

static inline workload random_mesh(void) {
    workload w;
    size_t i;
    switch (random_below(4)) {
    case 0: w = corner_tet(); break;
    case 1: w = grid(1, 1, 1, 5); break;
    case 2: w = grid(2, 1, 1, 5); break;
    default: w = grid(1, 2, 1, 6); break;
    }
    if (random_below(2))
        for (i = 0; i < 3 * w.node_count; i++) w.positions[i] += random_real(-0.1, 0.1);
    return w;
}

static inline workload random_scene(uint64_t seed, int cuts, int solids) {
    workload w;
    random_seed(seed);
    w = random_mesh();
    while (cuts-- > 0) add_random_cut(&w, solids);
    return w;
}

#endif /* GXFEM_TESTS_BODY_H */
