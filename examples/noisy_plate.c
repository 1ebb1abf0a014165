/* noisy_plate: a plate with objects on it is cut by a long bumpy surface (RXFEM, section 6, Fig. 1 left).

   159k tetrahedra of St. Venant-Kirchhoff material, steps of 5 ms. The plate is stretched by 10 % and held so at its
   two long sides. The cut winds through nearly all of the objects; its vertices are displaced by noise, so that it
   passes through many elements several times. Once it is through, the halves spring apart and bend down. RXFEM gives
   neither size nor stiffness: here 4 m and 2 MPa. */
#include "scene.h"

enum { WAYPOINTS = 12, SEGMENTS = WAYPOINTS - 3, COARSE = 5 };

typedef struct fineness {
    uint32_t columns, rows;
} fineness; /* of the cut; columns: of each segment of its way */

static const double stretch = 0.1, splinter = 1e-5; /* share of the volume */
static const double low = -0.25, high = 1.0;        /* of the cut, m */
/* m: amplitudes of the noise between every fifth vertex, and at each */
static const double bumps = 0.05, roughness = 0.015;

/* The way through the objects: a Catmull-Rom spline from the second point to the last but one; x, y in m */
static const double way[WAYPOINTS][2] = {{-3.0, 0.5},   {-2.3, 0.5},  {-1.5, 0.5}, {-0.8, -0.5},
                                         {-0.35, 0.35}, {0.2, -0.6},  {0.45, 0.5}, {1.0, -0.5},
                                         {1.15, 0.3},   {1.65, -0.1}, {2.3, 0.1},  {3.0, 0.1}};

/* Point and direction of the way at t from 0 to 1 on a segment */
static void follow(uint32_t segment, double t, double at[2], double direction[2]) {
    int i;
    for (i = 0; i < 2; i++) {
        const double p = way[segment][i], q = way[segment + 1][i], r = way[segment + 2][i], s = way[segment + 3][i];
        const double b = 0.5 * (r - p), c = p - 2.5 * q + 2.0 * r - 0.5 * s, d = 1.5 * (q - r) + 0.5 * (s - p);
        at[i] = q + t * (b + t * (c + t * d));
        direction[i] = b + t * (2.0 * c + 3.0 * t * d);
    }
}

/* Noise at every COARSE-th vertex, bilinear between them */
static double bump(uint32_t i, uint32_t j) {
    const uint32_t p = i / COARSE, q = j / COARSE;
    const double s = (double)(i % COARSE) / COARSE, t = (double)(j % COARSE) / COARSE;
    return (1.0 - t) * ((1.0 - s) * scene_noise(p, q) + s * scene_noise(p + 1, q)) +
           t * ((1.0 - s) * scene_noise(p, q + 1) + s * scene_noise(p + 1, q + 1));
}

static void blade_point(const void *user, double a, double b, double *x) {
    const fineness *fine = (const fineness *)user;
    const uint32_t i = (uint32_t)(a * SEGMENTS * fine->columns + 0.5), j = (uint32_t)(b * fine->rows + 0.5);
    const uint32_t segment = i / fine->columns < SEGMENTS ? i / fine->columns : SEGMENTS - 1;
    const double noise = bumps * bump(i, j) + roughness * scene_noise(i + 1000, j);
    double direction[2], length;
    follow(segment, (double)i / fine->columns - segment, x, direction);
    length = sqrt(direction[0] * direction[0] + direction[1] * direction[1]);
    x[0] -= noise * direction[1] / length;
    x[1] += noise * direction[0] / length;
    x[2] = low + b * (high - low);
}

static void pull(scene *s) {
    size_t copy;
    for (copy = 0; copy < s->view.copy_count; copy++)
        s->view.displacement[3 * copy + 1] = stretch * s->mesh.positions[3 * (size_t)s->view.copy_node[copy] + 1];
}

/* Cells of the elements that the cut has divided */
static unsigned long pieces(const scene *s) {
    return (unsigned long)(s->view.cell_count - s->mesh.element_count + scene_divided_elements(s));
}

int main(int argc, char **argv) {
    const scene_desc desc = {.name = "noisy_plate",
                             .about = "A plate with objects on it is cut by a long bumpy surface.",
                             .mesh = "objects",
                             .small_mesh = "objects:0.1",
                             .any_mesh = 1,
                             .frames = 240,
                             .small_frames = 40,
                             .least_frames = 40};
    const gx_region sides[2] = {gx_region_half_space(1, -1, -0.95), gx_region_half_space(1, 1, 0.95)};
    const gx_material material = {{GXS_ST_VENANT_KIRCHHOFF, 2e6, 0.4, 0.0, NULL, NULL}, 1000.0};
    const fineness full = {45, 48}, coarse = {20, 21};
    scene s;
    const fineness *fine;
    scene_sheet blade;
    double stretched, largest, gap;
    unsigned long divided, halves;
    scene_open(&s, &desc, argc, argv);
    s.body_desc.materials = &material;
    s.body_desc.material_count = 1;
    s.step.dt = 0.005;
    scene_make(&s);
    pull(&s);
    scene_hold_all(&s, sides, 2);
    scene_settle(&s, 1e-4);
    stretched = scene_largest_stretch(&s);
    fine = s.small ? &coarse : &full;
    blade = scene_make_sheet(&s, SEGMENTS * fine->columns, fine->rows, blade_point, fine);
    for (; s.frame < s.frames; scene_step(&s)) scene_advance(&s, &blade, 0.02, 0.7);
    divided = (unsigned long)scene_divided_elements(&s);
    largest = scene_largest_stretch(&s);
    gap = scene_mean_gap(&s, splinter);
    halves = (unsigned long)scene_fragments_above(&s, splinter);
    scene_say(&s, "elements cut: %lu, into %lu cells; RXFEM: 47643 unknowns, 53326 after the cut, +12 %%", divided,
              pieces(&s));
    scene_check(&s, pieces(&s) > 2 * divided, "cells per element cut: %.3f (more than 2: many are cut several times)",
                (double)pieces(&s) / (double)divided);
    scene_check(&s, halves == 2, "fragments: %lu and %lu splinters below 1e-5 of the plate, where bumps cross (2)",
                halves, (unsigned long)s.view.fragment_count - halves);
    scene_check(&s, gap > 0.02, "faces of the cut apart: %.3f m on average (more than 0.02 m)", gap);
    scene_check(&s, largest < 2.5, "largest stretch: %.2f, %.2f before the cut (below 2.5: nothing drifts away)",
                largest, stretched);
    scene_check_body(&s);
    scene_drop_sheet(&blade);
    return scene_close(&s);
}
