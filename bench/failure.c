/* failure.c - hard cases by every method: right, wrong (how), refused (why), crashed, or still busy after a minute.

   make bench-failure builds and runs it; it prints CSV and writes it to build/bench/failure.csv, a table to stderr.

   A cube of 2 x 2 x 2 cells of five tetrahedra (or one tetrahedron) is cut, and falls for twenty steps. Right is: as many pieces as
   the cuts leave, found by hand for each case (parts that share no copy are apart); the volume and the mass that are left; and a motion
   without numbers that are not finite or faster than ten times a fall. Each run has a process of its own. */
#define _POSIX_C_SOURCE 200112L
#define GXFEM_IMPLEMENTATION
#include "../gxfem.h"
#include "csv.h"
#include "replay.h"
#include "method.h"
#include <signal.h>
#include <stdarg.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STEPS = 20, MOST_SECONDS = 60, TEXT = 120 };

/* ---- scenes ---- */

typedef struct trial {
    replay scene;
    size_t pieces;          /* expected */
    double volume;          /* of the mesh, m3 */
    double removed;         /* by solids, m3 */
    double tolerance;       /* of volumes, share of the mesh's: what a solid's thickness takes away */
} trial;

static uint32_t add_node(replay *r, double x, double y, double z)
{
    const double p[3] = {x, y, z};
    r->positions = (double *)replay_array(r, r->positions, 3 * (r->node_count + 1), sizeof(double));
    memcpy(r->positions + 3 * r->node_count, p, sizeof p);
    return (uint32_t)r->node_count++;
}

static void add_element(replay *r, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const double *x = r->positions;
    const double tet[12] = {x[3 * a], x[3 * a + 1], x[3 * a + 2], x[3 * b], x[3 * b + 1], x[3 * b + 2],
                            x[3 * c], x[3 * c + 1], x[3 * c + 2], x[3 * d], x[3 * d + 1], x[3 * d + 2]};
    const int turned = gxi_tet_volume(tet) < 0;
    const uint32_t nodes[4] = {a, b, turned ? d : c, turned ? c : d};
    r->elements = (uint32_t *)replay_array(r, r->elements, 4 * (r->element_count + 1), sizeof(uint32_t));
    memcpy(r->elements + 4 * r->element_count++, nodes, sizeof nodes);
}

static void make_cube(replay *r)
{
    static const uint32_t five[5][4] = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
    uint32_t x, y, z, t, k, n[4];
    for (z = 0; z < 3; z++) for (y = 0; y < 3; y++) for (x = 0; x < 3; x++) add_node(r, 0.5 * x, 0.5 * y, 0.5 * z);
    for (z = 0; z < 2; z++)
        for (y = 0; y < 2; y++)
            for (x = 0; x < 2; x++)
                for (t = 0; t < 5; t++) {
                    for (k = 0; k < 4; k++) {
                        const uint32_t c = five[t][k] ^ ((x + y + z) & 1 ? 7u : 0u);
                        n[k] = 9 * (z + (c >> 2)) + 3 * (y + (c >> 1 & 1)) + x + (c & 1);
                    }
                    add_element(r, n[0], n[1], n[2], n[3]);
                }
}

static void make_tetrahedron(replay *r)
{
    add_node(r, 0, 0, 0);
    add_node(r, 1, 0, 0);
    add_node(r, 0, 1, 0);
    add_node(r, 0, 0, 1);
    add_element(r, 0, 1, 2, 3);
}

/* ---- cuts ---- */

static gx_surface *add_cut(replay *r, size_t frame, uint32_t kind)
{
    r->cuts = (replay_cut *)replay_array(r, r->cuts, r->cut_count + 1, sizeof *r->cuts);
    memset(&r->cuts[r->cut_count], 0, sizeof *r->cuts);
    r->cuts[r->cut_count].frame = frame;
    r->cuts[r->cut_count].path.kind = kind;
    return &r->cuts[r->cut_count++].path;
}

static uint32_t add_vertex(const replay *r, gx_surface *s, double x, double y, double z)
{
    const double p[3] = {x, y, z};
    double *grown = (double *)replay_array(r, (void *)(uintptr_t)s->vertices, 3 * (s->vertex_count + 1), sizeof(double));
    memcpy(grown + 3 * s->vertex_count, p, sizeof p);
    s->vertices = grown;
    return (uint32_t)s->vertex_count++;
}

static void add_triangle(const replay *r, gx_surface *s, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t t[3] = {a, b, c};
    uint32_t *grown = (uint32_t *)replay_array(r, (void *)(uintptr_t)s->triangles, 3 * (s->triangle_count + 1), sizeof(uint32_t));
    memcpy(grown + 3 * s->triangle_count++, t, sizeof t);
    s->triangles = grown;
}

/* Parallelogram p + a u + b v, 0 <= a, b <= 1 */
static gx_surface *add_quad(replay *r, size_t frame, const double p[3], const double u[3], const double v[3])
{
    gx_surface *s = add_cut(r, frame, GX_SURFACE_SHEET);
    add_vertex(r, s, p[0], p[1], p[2]);
    add_vertex(r, s, p[0] + u[0], p[1] + u[1], p[2] + u[2]);
    add_vertex(r, s, p[0] + u[0] + v[0], p[1] + u[1] + v[1], p[2] + u[2] + v[2]);
    add_vertex(r, s, p[0] + v[0], p[1] + v[1], p[2] + v[2]);
    add_triangle(r, s, 0, 1, 2);
    add_triangle(r, s, 0, 2, 3);
    return s;
}

/* z = at + a (x - 1/2) + b (y - 1/2), over -1 to 2 */
static void add_level(replay *r, size_t frame, double at, double a, double b)
{
    const double p[3] = {-1, -1, at - 1.5 * a - 1.5 * b}, u[3] = {3, 0, 3 * a}, v[3] = {0, 3, 3 * b};
    add_quad(r, frame, p, u, v);
}

/* The plane through c with the normal n, 3 to each side */
static void add_plane(replay *r, size_t frame, const double c[3], const double n[3])
{
    const int k = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0 : fabs(n[1]) <= fabs(n[2]) ? 1 : 2;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    double u[3], v[3], p[3], length = 0;
    int d;
    u[k] = 0; u[i] = -n[j]; u[j] = n[i];
    for (d = 0; d < 3; d++) v[d] = n[(d + 1) % 3] * u[(d + 2) % 3] - n[(d + 2) % 3] * u[(d + 1) % 3];
    for (d = 0; d < 3; d++) length += v[d] * v[d];
    for (d = 0; d < 3; d++) { v[d] *= 6 / sqrt(length); u[d] *= 6 / sqrt(u[i] * u[i] + u[j] * u[j] > 0 ? length : 1); }
    for (d = 0; d < 3; d++) p[d] = c[d] - 0.5 * u[d] - 0.5 * v[d];
    add_quad(r, frame, p, u, v);
}

/* The strip over a polyline in the x-z plane, along y */
static void add_strip(replay *r, const double (*at)[2], uint32_t count)
{
    gx_surface *s = add_cut(r, 0, GX_SURFACE_SHEET);
    uint32_t i;
    for (i = 0; i < count; i++) {
        add_vertex(r, s, at[i][0], -0.2, at[i][1]);
        add_vertex(r, s, at[i][0], 1.2, at[i][1]);
    }
    for (i = 0; i + 1 < count; i++) {
        add_triangle(r, s, 2 * i, 2 * i + 1, 2 * i + 3);
        add_triangle(r, s, 2 * i, 2 * i + 3, 2 * i + 2);
    }
}

static void add_box(replay *r, const double low[3], const double high[3])
{
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    gx_surface *s = add_cut(r, 0, GX_SURFACE_SOLID);
    uint32_t i;
    for (i = 0; i < 8; i++) add_vertex(r, s, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
    for (i = 0; i < 6; i++) {
        add_triangle(r, s, quads[i][0], quads[i][1], quads[i][2]);
        add_triangle(r, s, quads[i][0], quads[i][2], quads[i][3]);
    }
}

/* ---- the catalogue ---- */

static void through_node(trial *t)
{
    const double c[3] = {0.5, 0.5, 0.5}, n[3] = {4, 1, 2};
    add_plane(&t->scene, 0, c, n);
}

static void along_edge(trial *t)
{
    const double p[3] = {-0.5, 0, -1}, u[3] = {2, 1, 0}, v[3] = {0, 0, 3};     /* through x = y = 1/2, where edges are */
    add_quad(&t->scene, 0, p, u, v);
}

static void in_facets(trial *t) { add_level(&t->scene, 0, 0.5, 0, 0); }

static void tangent_face(trial *t)
{
    add_level(&t->scene, 0, 1, 0, 0);
    t->pieces = 1;
}

static void tangent_corner(trial *t)
{
    add_level(&t->scene, 0, 2, -1, -1);     /* x + y + z = 3 */
    t->pieces = 1;
}

static void three_in_a_line(trial *t)
{
    const double c[3] = {0.5625, 0.4375, 0.5}, n[3][3] = {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    int i;
    for (i = 0; i < 3; i++) add_plane(&t->scene, (size_t)i, c, n[i]);
    t->pieces = 6;
}

static void four_through_a_point(trial *t)
{
    const double c[3] = {0.4375, 0.5625, 0.53125}, n[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, 4}};
    int i;
    for (i = 0; i < 4; i++) add_plane(&t->scene, (size_t)i, c, n[i]);
    t->pieces = 14;
}

static void apart_1e15(trial *t)
{
    add_level(&t->scene, 0, 0.3, 0, 0);
    add_level(&t->scene, 1, 0.3 + 1e-15, 0, 0);
    t->pieces = 3;
}

static void missing_by_a_rounding(trial *t)
{
    const double middle = 0.3, next = 0.3 + 5.6e-17;     /* one unit in the last place */
    const double p[3] = {-1, -1, 0.4}, u[3] = {1 + middle, 0, 0}, q[3] = {next, -1, 0.4}, w[3] = {2, 0, 0}, v[3] = {0, 3, 0};
    add_quad(&t->scene, 0, p, u, v);
    add_quad(&t->scene, 1, q, w, v);
    t->scene.sever_below = 1e-9;
}

static void same_cut_twice(trial *t)
{
    add_level(&t->scene, 0, 0.37, 0.1, 0.2);
    add_level(&t->scene, 1, 0.37, 0.1, 0.2);
}

static void slab(trial *t, double thickness)
{
    const double low[3] = {-1, -1, 0.375}, high[3] = {2, 2, 0.375 + thickness};
    add_box(&t->scene, low, high);
    t->removed = high[2] - low[2];
}

static void slab_1e12(trial *t) { slab(t, 1e-12); }
static void sliver_1e3(trial *t) { add_level(&t->scene, 0, 1 - 1e-3, 0, 0); }
static void sliver_1e8(trial *t) { add_level(&t->scene, 0, 1 - 1e-8, 0, 0); }
static void sliver_1e15(trial *t) { add_level(&t->scene, 0, 1 - 1e-15, 0, 0); }
static void corner_1e9(trial *t) { add_level(&t->scene, 0, 2 - 1e-3, -1, -1); }
static void corner_1e15(trial *t) { add_level(&t->scene, 0, 2 - 1e-5, -1, -1); }

static void fold(trial *t)
{
    static const double at[4][2] = {{-0.2, 0.3}, {0.7, 0.35}, {0.4, 0.5}, {1.2, 0.55}};
    add_strip(&t->scene, at, 4);
}

static void self_crossing(trial *t)
{
    static const double at[5][2] = {{-0.2, 0.3}, {0.8, 0.35}, {0.6, 0.7}, {0.4, 0.1}, {1.2, 0.2}};
    add_strip(&t->scene, at, 5);
    t->pieces = 3;      /* above, below, and a loop */
}

static void hole(trial *t)
{
    gx_surface *s = add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    uint32_t i;
    for (i = 0; i < 4; i++) add_vertex(&t->scene, s, i == 1 || i == 2 ? 2 : -1, i >= 2 ? 2 : -1, 0.4);
    for (i = 0; i < 4; i++) add_vertex(&t->scene, s, i == 1 || i == 2 ? 0.7 : 0.3, i >= 2 ? 0.7 : 0.3, 0.4);
    for (i = 0; i < 4; i++) {
        add_triangle(&t->scene, s, i, (i + 1) % 4, 4 + (i + 1) % 4);
        add_triangle(&t->scene, s, i, 4 + (i + 1) % 4, 4 + i);
    }
    t->pieces = 1;
}

/* A vertex in the middle of an edge of its neighbour */
static void t_junction(trial *t)
{
    gx_surface *s = add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    add_vertex(&t->scene, s, -1, -1, 0.375);
    add_vertex(&t->scene, s, 2, -1, 0.375);
    add_vertex(&t->scene, s, 2, 2, 0.375);
    add_vertex(&t->scene, s, -1, 2, 0.375);
    add_vertex(&t->scene, s, 0.5, 0.5, 0.375);
    add_triangle(&t->scene, s, 0, 1, 2);
    add_triangle(&t->scene, s, 0, 4, 3);
    add_triangle(&t->scene, s, 4, 2, 3);
}

static void ends_on_another(trial *t)
{
    const double p[3] = {0.5625, -1, 0.4375}, u[3] = {0, 3, 0}, v[3] = {0, 0, 2};
    add_level(&t->scene, 0, 0.4375, 0, 0);
    add_quad(&t->scene, 1, p, u, v);
    t->pieces = 3;
}

static void duplicate_triangle(trial *t)
{
    gx_surface *s;
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    s = &t->scene.cuts[0].path;
    add_triangle(&t->scene, s, 0, 1, 2);
}

static void flat_triangle(trial *t)
{
    gx_surface *s;
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    s = &t->scene.cuts[0].path;
    add_triangle(&t->scene, s, 0, 1, 1);
    add_vertex(&t->scene, s, 0.5, 0.5, 0.4);
}

static void open_end(trial *t)
{
    const double p[3] = {-1, -1, 0.4}, u[3] = {1.6, 0, 0.05}, v[3] = {0, 3, 0.03};
    add_quad(&t->scene, 0, p, u, v);
    t->pieces = 1;
}

static void thousand_parallel(trial *t)
{
    gx_surface *s = add_cut(&t->scene, 0, GX_SURFACE_SHEET);
    uint32_t i;
    for (i = 0; i < 1000; i++) {
        const double z = (i + 0.5) / 1001;
        add_vertex(&t->scene, s, -1, -1, z);
        add_vertex(&t->scene, s, 3, -1, z);
        add_vertex(&t->scene, s, -1, 3, z);
        add_triangle(&t->scene, s, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    t->pieces = 1001;
    t->tolerance = 0.3;
}

/* Of a corner of space: boxes between planes, those that reach into x + y + z < 1 */
static void crossing_3_20(trial *t)
{
    double at[22];
    int i, j, k;
    for (i = 0; i < 20; i++) at[i + 1] = (i + 0.53) / 20.5;
    at[0] = 0;
    for (i = 0; i < 3; i++)
        for (j = 1; j <= 20; j++) {
            double c[3] = {0, 0, 0}, n[3] = {0, 0, 0};
            c[i] = at[j];
            n[i] = 1;
            add_plane(&t->scene, 0, c, n);
        }
    t->pieces = 0;
    for (i = 0; i <= 20; i++) for (j = 0; j <= 20; j++) for (k = 0; k <= 20; k++) t->pieces += at[i] + at[j] + at[k] < 1;
    t->tolerance = 0.05;
}

static void scale(trial *t, const double factor[3], double offset)
{
    size_t i, c;
    for (c = 0; c <= t->scene.cut_count; c++) {
        double *x = c < t->scene.cut_count ? (double *)(uintptr_t)t->scene.cuts[c].path.vertices : t->scene.positions;
        const size_t count = c < t->scene.cut_count ? t->scene.cuts[c].path.vertex_count : t->scene.node_count;
        for (i = 0; i < 3 * count; i++) x[i] = x[i] * factor[i % 3] + offset;
    }
    t->scene.thickness *= fmin(factor[0], fmin(factor[1], factor[2]));
}

static void aspect_1e4(trial *t)
{
    const double factor[3] = {1, 1, 1e-4};
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    scale(t, factor, 0);
}

static void size_1e6(trial *t)
{
    const double factor[3] = {1e-6, 1e-6, 1e-6};
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    scale(t, factor, 0);
}

static void offset_1e8(trial *t)
{
    const double factor[3] = {1e6, 1e6, 1e6};
    add_level(&t->scene, 0, 0.4, 0.125, 0.25);
    scale(t, factor, 1e8);
}

static void shaken(trial *t)
{
    uint32_t random = 1;
    size_t i;
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    for (i = 0; i < 3 * t->scene.node_count; i++) {
        random = random * 1664525u + 1013904223u;
        t->scene.displacement[i] = 0.5 * ((random >> 8) / 8388608.0 - 1.0);
    }
}

static void collapsed(trial *t)
{
    size_t i;
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    for (i = 0; i < 3 * t->scene.node_count; i++) t->scene.displacement[i] = 0.5 - t->scene.positions[i];
}

static void one_second(trial *t)
{
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    t->scene.dt = 1;
}

static void incompressible(trial *t)
{
    add_level(&t->scene, 0, 0.4, 0.1, 0.2);
    t->scene.poisson = 0.4999;
}

/* The upper half hangs on the lower one by a bridge of 1e-3 */
static void bridge(trial *t)
{
    const double p[3] = {-1, -1, 0.4}, u[3] = {1.3, 0, 0}, q[3] = {0.301, -1, 0.4}, w[3] = {2, 0, 0}, v[3] = {0, 3, 0};
    add_quad(&t->scene, 0, p, u, v);
    add_quad(&t->scene, 1, q, w, v);
    t->pieces = 1;
}

typedef struct catalogue_row {
    const char *name;
    void (*make)(trial *t);
    int tetrahedron;        /* 1: of one tetrahedron; 0: of the cube */
} catalogue_row;

static const catalogue_row catalogue[] = {
    {"through a node", through_node, 0}, {"along an edge", along_edge, 0}, {"in facets", in_facets, 0},
    {"tangent to a face", tangent_face, 0}, {"tangent to a corner", tangent_corner, 0},
    {"three through a line", three_in_a_line, 0}, {"four through a point", four_through_a_point, 0},
    {"two 1e-15 apart", apart_1e15, 0}, {"two sheets miss by a rounding", missing_by_a_rounding, 0}, {"the same cut twice", same_cut_twice, 0},
    {"solid 1e-12 thick", slab_1e12, 0}, {"slice of 1e-3", sliver_1e3, 0}, {"slice of 1e-8", sliver_1e8, 0}, {"slice of 1e-15", sliver_1e15, 0},
    {"corner of 1e-9", corner_1e9, 0}, {"corner of 1e-15", corner_1e15, 0}, {"fold", fold, 0}, {"self-crossing", self_crossing, 0}, {"hole", hole, 0},
    {"T-junction", t_junction, 0}, {"ends on another", ends_on_another, 0}, {"duplicate triangle", duplicate_triangle, 0},
    {"triangle without area", flat_triangle, 0}, {"ends inside", open_end, 0}, {"1000 parallel in one element", thousand_parallel, 1},
    {"3 x 20 crossing in one element", crossing_3_20, 1}, {"aspect ratio 1e4", aspect_1e4, 0}, {"size of 1e-6", size_1e6, 0},
    {"size of 1e6 at 1e8", offset_1e8, 0}, {"starts shaken by an edge length", shaken, 0}, {"starts in one point", collapsed, 0},
    {"steps of 1 s", one_second, 0}, {"Poisson's ratio 0.4999", incompressible, 0}, {"hangs by 1e-3 of a face", bridge, 0}};

enum { CASES = sizeof catalogue / sizeof catalogue[0] };

static void trial_make(trial *t, const catalogue_row *row)
{
    static const gx_region foot = {2, -1, -1e30};       /* nothing */
    size_t e, k;
    memset(t, 0, sizeof *t);
    t->scene.name = row->name;
    t->scene.young = 1e6; t->scene.poisson = 0.4; t->scene.density = 1000;
    t->scene.dt = 0.033; t->scene.gravity[2] = -9.81; t->scene.newton_iterations = 1;
    t->scene.regions = (gx_region *)replay_array(&t->scene, NULL, 1, sizeof(gx_region));
    t->scene.regions[0] = foot;
    t->scene.region_count = 1;
    t->scene.thickness = REPLAY_THICKNESS;
    t->pieces = 2;
    t->tolerance = 2e-3;
    if (row->tetrahedron) make_tetrahedron(&t->scene);
    else make_cube(&t->scene);
    t->scene.displacement = (double *)calloc(3 * t->scene.node_count, sizeof(double));
    t->scene.velocity = (double *)calloc(3 * t->scene.node_count, sizeof(double));
    method_must(t->scene.displacement && t->scene.velocity ? GX_OK : GX_ERROR_MEMORY, "bench");
    row->make(t);
    for (e = 0; e < t->scene.element_count; e++) {
        double x[12];
        for (k = 0; k < 4; k++) memcpy(x + 3 * k, t->scene.positions + 3 * (size_t)t->scene.elements[4 * e + k], 3 * sizeof(double));
        t->volume += gxi_tet_volume(x);
    }
}

/* ---- judgement ---- */

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Sets of parts that share copies */
static size_t count_pieces(const gxs_model *m)
{
    uint32_t *parent = (uint32_t *)method_memory(NULL, m->copy_count, sizeof *parent), i;
    uint8_t *used = (uint8_t *)method_memory(NULL, m->copy_count, 1);
    size_t e, count = 0;
    int k;
    memset(used, 0, m->copy_count);
    for (i = 0; i < m->copy_count; i++) parent[i] = i;
    for (e = 0; e < m->element_count; e++)
        for (k = 0; k < 4; k++) {
            used[m->elements[e].copy[k]] = 1;
            parent[root_of(parent, m->elements[e].copy[k])] = root_of(parent, m->elements[e].copy[0]);
        }
    for (i = 0; i < m->copy_count; i++) count += used[i] && root_of(parent, i) == i;
    free(parent);
    free(used);
    return count;
}

static double model_volume(const gxs_model *m)
{
    double sum = 0;
    size_t e;
    for (e = 0; e < m->element_count; e++) sum += m->elements[e].weight;
    return sum;
}

static const char *play(const trial *t, const method *m, void *state)
{
    const char *why = NULL;
    size_t frame, next = 0;
    for (frame = 0; frame < STEPS && !why; frame++) {
        method_times times;
        memset(&times, 0, sizeof times);
        for (; next < t->scene.cut_count && t->scene.cuts[next].frame == frame && !why; next++) why = m->cut(state, &t->scene.cuts[next], &times);
        if (!why) why = m->step(state, &times);
    }
    return why;
}

/* What became of it: one line */
static void judge(const trial *t, const method *m, char text[TEXT])
{
    const double fall = 9.81 * t->scene.dt * t->scene.dt * STEPS * STEPS + 4;
    void *state = m->create(&t->scene);
    const char *why = play(t, m, state);
    const double *u;
    gxs_model model;
    size_t pieces, i;
    double volume;
    if (why) {
        snprintf(text, TEXT, "refused: %s", why);
        return;
    }
    m->look(state, &model, &u);
    pieces = count_pieces(&model);
    volume = (model_volume(&model) + t->removed - t->volume) / t->volume;
    for (i = 0; i < 3 * model.copy_count; i++) if (!(fabs(u[i]) < 10 * fall)) break;
    if (i < 3 * model.copy_count) snprintf(text, TEXT, "wrong: flies apart");
    else if (pieces != t->pieces) snprintf(text, TEXT, "wrong: %lu pieces of %lu", (unsigned long)pieces, (unsigned long)t->pieces);
    else if (fabs(volume) > t->tolerance) snprintf(text, TEXT, "wrong: volume %+.0f %%", 100 * volume);
    else snprintf(text, TEXT, "right%s", fabs(volume) > 1e-9 ? " but for volume" : "");
    m->destroy(state);
}

static void give_up(int signal_number) { (void)signal_number; _exit(3); }

/* The same in a process of its own */
static void judge_apart(const catalogue_row *row, const method *m, char text[TEXT])
{
    int pipes[2], status = 0;
    ssize_t length;
    pid_t child;
    method_must(pipe(pipes) == 0 ? GX_OK : GX_ERROR_LIMIT, "pipe");
    fflush(NULL);
    child = fork();
    method_must(child >= 0 ? GX_OK : GX_ERROR_MEMORY, "fork");
    if (child == 0) {
        trial t;
        signal(SIGALRM, give_up);
        alarm(MOST_SECONDS);
        trial_make(&t, row);
        judge(&t, m, text);
        _exit(write(pipes[1], text, strlen(text)) < 0);
    }
    close(pipes[1]);
    length = read(pipes[0], text, TEXT - 1);
    text[length > 0 ? length : 0] = 0;
    close(pipes[0]);
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) snprintf(text, TEXT, "crashed: signal %d", WTERMSIG(status));
    else if (WEXITSTATUS(status) == 3) snprintf(text, TEXT, "busy after %d s", MOST_SECONDS);
    else if (WEXITSTATUS(status) != 0) snprintf(text, TEXT, "crashed: exit %d", WEXITSTATUS(status));
}

int main(int argc, char **argv)
{
    int c, m, wrong = 0;
    csv_open(argc, argv, "case,method,verdict");
    for (c = 0; c < CASES; c++)
        for (m = 0; m < METHOD_COUNT; m++) {
            char text[TEXT];
            judge_apart(&catalogue[c], &methods[m], text);
            csv_row("%s,%s,%s", catalogue[c].name, methods[m].name, text);
            wrong += m == 0 && strcmp(text, "right") != 0;
        }
    return csv_close() | (wrong > 0);
}
